/* SPDX-License-Identifier: BSD-2-Clause */
/* VB: what is said without being asked, and when. */
#include "check.h"

#include <math.h>

#include "core/action.h"
#include "core/events.h"
#include "core/fault.h"
#include "core/report.h"
#include "host/mmio.h"
#include "machine.h"
#include "panel.h"
#include "port.h"
#include "regs.h"

#define SEND(text, reply) CHECK_TEXT(machine_send(text), reply)

/* What comes by itself while ticks pass. */
static const char *hear(unsigned ticks)
{
    machine_run(ticks);
    return port_drain();
}

/* A move of a tenth of a millimetre, and all that is said until it is over. */
static const char *hear_a_move(void)
{
    (void)machine_send("R X=1000");
    return hear(5000);
}

TEST(says_nothing_by_default)
{
    machine_start();
    CHECK_TEXT(hear_a_move(), "");
    SEND("VB X?", ":A X=0\r\n");
}

TEST(says_n_when_a_move_has_ended)
{
    machine_start();
    SEND("VB X=1", ":A \r\n");
    CHECK_TEXT(hear_a_move(), "N\r\n");
    CHECK_TEXT(hear(5000), "");
}

TEST(says_the_positions_when_a_move_has_ended)
{
    double x, y, z, f;

    machine_start();
    SEND("VB X=33", ":A \r\n");
    CHECK_INT(sscanf(hear_a_move(), "N\r\n:A %lf %lf %lf %lf \r\n", &x, &y, &z, &f), 4);
    CHECK(fabs(x - 1000) < 10 && fabs(y) < 10 && fabs(f) < 10);
}

TEST(answers_moves_with_their_targets)
{
    machine_start();
    SEND("VB X=16", ":A \r\n");
    SEND("M X=1234.5 Z=20", ":A X=1234.5 Z=20.0\r\n");
    SEND("R Z=-10", ":A Z=10.1\r\n"); /* 91 - 45 counts */
    SEND("VB X=0", ":A \r\n");
    SEND("M X=0", ":A \r\n");
}

TEST(ends_lines_in_cr_alone)
{
    machine_start();
    SEND("VB X=8", ":A \r");
    SEND("W X", ":A 0.0 \r");
    SEND("FOO", ":N-1\r");
    SEND("VB X=9", ":A \r");
    CHECK_TEXT(hear_a_move(), "N\r");
    SEND("VB X=0", ":A \r\n");
}

TEST(says_the_edges_of_in1)
{
    machine_start();
    SEND("VB Y?", ":A Y=0\r\n");
    SEND("VB X=4", ":A \r\n");
    panel_start();
    panel_ttl(INPUTS_IN1, true, 0);
    CHECK_TEXT(hear(10), "H\r\n");
    CHECK_TEXT(hear(10), "");
    SEND("VB Y?", ":A Y=1\r\n");
    panel_ttl(INPUTS_IN1, false, 0);
    CHECK_TEXT(hear(10), "L\r\n");
    SEND("VB Y=1", ":N-4\r\n");
}

TEST(says_the_presses_of_the_joystick)
{
    machine_start();
    events_publish(EVENT_BUTTON, ACTION_JOYSTICK_SHORT, 0);
    CHECK_TEXT(hear(2), "");
    SEND("VB X=2", ":A \r\n");
    events_publish(EVENT_BUTTON, ACTION_JOYSTICK_SHORT, 0);
    events_publish(EVENT_BUTTON, ACTION_JOYSTICK_LONG, 0);
    events_publish(EVENT_BUTTON, ACTION_HOME_LONG, 0);
    CHECK_TEXT(hear(2), "p\r\nP\r\n");
}

TEST(never_speaks_inside_a_reply)
{
    const char *text;

    machine_start();
    SEND("VB X=4", ":A \r\n");
    panel_start();
    panel_ttl(INPUTS_IN1, true, 0); /* the edge is seen while the page is being sent */
    text = port_send("I X\rV");
    machine_run(2);
    CHECK(strncmp(text, "Axis Name", 9) == 0);
    CHECK(strstr(text, "\r\n:A Version") != NULL);
    CHECK(strchr(strstr(text, "\r\n") + 2, '\n') != NULL);
    CHECK_TEXT(port_drain(), "H\r\n");
}

TEST(what_finds_no_room_is_dropped_whole_and_logged)
{
    char line[101];

    machine_start();
    memset(line, 'x', sizeof line);
    report_line(line, 100);
    report_line(line, 101);
    report_line(line, 101);
    CHECK_INT(fault_read(0), FAULT_REPORT_OVERRUN);
    CHECK_INT(strlen(port_drain()), 100 + 2 + 101 + 2);
}

TEST(bits_that_mean_nothing_are_refused)
{
    machine_start();
    SEND("VB X=64", ":N-4\r\n");
    SEND("VB X=-1", ":N-4\r\n");
    SEND("VB T=5", ":N-2\r\n"); /* NO_CHANGE_SETTINGS is not built */
    SEND("VB Z=10", ":N-4\r\n");
    SEND("VB Z=3", ":A \r\n");
    SEND("W X Y", ":A 0.000 0.000 \r\n");
}

TEST_MAIN(RUN(says_nothing_by_default); RUN(says_n_when_a_move_has_ended);
          RUN(says_the_positions_when_a_move_has_ended); RUN(answers_moves_with_their_targets);
          RUN(ends_lines_in_cr_alone); RUN(says_the_edges_of_in1);
          RUN(says_the_presses_of_the_joystick); RUN(never_speaks_inside_a_reply);
          RUN(what_finds_no_room_is_dropped_whole_and_logged);
          RUN(bits_that_mean_nothing_are_refused))
