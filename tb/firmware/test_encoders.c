/* SPDX-License-Identifier: BSD-2-Clause */
/* Encoders that cannot be believed, on the board: illegal transitions, broken wires, wrong polarity. */
#include "check.h"

#include <math.h>

#include "closed_loop.h"
#include "core/fault.h"
#include "modules/axis.h"
#include "modules/motion.h"
#include "rig.h"

#define DONE ":A \r\n"
#define SEND(line) CHECK_TEXT(closed_loop_send(line), DONE)

enum { X, Y };

static const double COUNTS_PER_MM = 45396;

static void start(void)
{
    closed_loop_start(NULL);
    fault_clear();
}

/* Both wires at once, as when a plug is loose. */
static void change_both_wires(unsigned axis)
{
    const struct board_pins *pins = board_pins(closed_loop_board());
    int a = pins->enc_a >> axis & 1, b = pins->enc_b >> axis & 1;

    board_stick_wire(closed_loop_board(), axis, BOARD_WIRE_A, !a);
    board_stick_wire(closed_loop_board(), axis, BOARD_WIRE_B, !b);
    closed_loop_tick();
    board_stick_wire(closed_loop_board(), axis, BOARD_WIRE_A, -1);
    board_stick_wire(closed_loop_board(), axis, BOARD_WIRE_B, -1);
}

static bool is_off(unsigned axis)
{
    struct axis_view view;

    axis_read(axis, &view);
    return view.off && view.duty_steps == 0 && view.mode == LOOP_FREE;
}

TEST(an_illegal_transition_stops_its_axis)
{
    double at;

    start();
    SEND("M X=40000 Y=40000");
    closed_loop_run(1500);
    CHECK_INT(fault_read(0), FAULT_NONE);
    change_both_wires(X);
    at = closed_loop_position(X);
    closed_loop_run(50); /* 10 ms */
    CHECK_INT(fault_read(0), FAULT_ENCODER);
    CHECK(is_off(X) && !motion_axis_busy(X) && motion_axis_busy(Y));
    CHECK_TEXT(closed_loop_send("MC X? Y?"), ":A 0 1\r\n");
    CHECK_TEXT(closed_loop_send("RS X-"), ":A D\r\n");
    CHECK(closed_loop_wait(5000) > 0);
    CHECK_INT(board_count(closed_loop_board(), Y), 181584);
    CHECK_TEXT(closed_loop_send("RS X Y"), ":A 8 10\r\n");
    /* From 4.6 mm/s it brakes by itself. */
    CHECK(closed_loop_position(X) - at < 0.1 * COUNTS_PER_MM);
    CHECK_INT(fault_read(1), FAULT_NONE);
    SEND("M X=0");
    CHECK_TEXT(closed_loop_send("/"), "N\r\n");
    SEND("MC X+");
    closed_loop_run(200);
    SEND("R X=1000");
    CHECK(closed_loop_wait(5000) > 0);
    CHECK_INT(fault_read(1), FAULT_NONE);
}

TEST(an_axis_at_rest_is_switched_off_too)
{
    start();
    change_both_wires(Y);
    closed_loop_run(20);
    CHECK_INT(fault_read(0), FAULT_ENCODER);
    CHECK_TEXT(closed_loop_send("RS X- Y-"), ":A  D\r\n");
    /* Once or twice: the wires change there and back, and the axis is looked at in its turn. */
    CHECK(strncmp(closed_loop_send("DU Y"), "24 ", 3) == 0);
}

TEST(what_was_before_the_start_is_no_fault)
{
    start();
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        board_stick_wire(closed_loop_board(), axis, BOARD_WIRE_A,
                         !(board_pins(closed_loop_board())->enc_a >> axis & 1));
        board_stick_wire(closed_loop_board(), axis, BOARD_WIRE_B,
                         !(board_pins(closed_loop_board())->enc_b >> axis & 1));
    }
    rig_start();
    closed_loop_run(200);
    CHECK_INT(fault_read(0), FAULT_NONE);
    SEND("M X=1000");
    CHECK(closed_loop_wait(5000) > 0);
}

/* A broken wire, at either level: the drive is off within milliseconds, and the axis is dead. */
static const char *break_wire(enum board_wire wire, int level, int when)
{
    double at;

    start();
    if (when == 0)
        board_stick_wire(closed_loop_board(), X, wire, level);
    if (strcmp(closed_loop_send("M X=60000 Y=60000"), DONE) != 0)
        return "refused";
    closed_loop_run((unsigned)when);
    at = closed_loop_position(X);
    board_stick_wire(closed_loop_board(), X, wire, level);
    for (int n = 0; n < 2000 && motion_axis_busy(X); n++)
        closed_loop_tick();
    closed_loop_run(50);
    if (fault_read(0) != FAULT_AXIS_DEAD + X || fault_read(1) != FAULT_NONE)
        return "not logged as dead axis";
    if (!is_off(X) || motion_enabled(X) || strcmp(closed_loop_send("RS X X-"), ":A D\r\n") != 0)
        return "not off";
    if (fabs(closed_loop_position(X) - at) > 0.06 * COUNTS_PER_MM)
        return "too far";
    if (closed_loop_wait(10000) < 0 || board_count(closed_loop_board(), Y) != 272376)
        return "the other axis does not arrive";
    return "";
}

TEST(a_broken_wire_ends_as_a_dead_axis)
{
    for (int wire = BOARD_WIRE_A; wire <= BOARD_WIRE_B; wire++)
        for (int level = 0; level <= 1; level++)
            for (int when = 0; when <= 1000; when += 500)
                CHECK_TEXT(break_wire((enum board_wire)wire, level, when), "");
}

/* Pulses near the target end, too. */
TEST(a_small_move_with_a_broken_wire_is_given_up)
{
    start();
    board_stick_wire(closed_loop_board(), X, BOARD_WIRE_A, 0);
    SEND("R X=1");
    CHECK(closed_loop_wait(5000) > 0);
    CHECK_INT(fault_read(0), FAULT_ADJUST_MOVE + X);
}

TEST(a_broken_wire_ends_the_tuner)
{
    start();
    board_stick_wire(closed_loop_board(), X, BOARD_WIRE_B, 1);
    CHECK_TEXT(closed_loop_ask("AZ X", 2000), ":N-5\r\n");
    CHECK_INT(fault_read(0), FAULT_AXIS_DEAD + X);
}

/* Motor wires the other way round, and the encoder's said to be as well. */
TEST(the_polarity_of_an_encoder_is_a_setting)
{
    start();
    CHECK_TEXT(closed_loop_send("EP X? Y?"), ":A X=1 Y=1\r\n");
    CHECK_TEXT(closed_loop_send("EP X=0"), ":N-4\r\n");
    CHECK_TEXT(closed_loop_send("EP X=2"), ":N-4\r\n");
    closed_loop_reverse(X, true);
    SEND("EP X=-1");
    SEND("M X=1000 Y=1000");
    CHECK(closed_loop_wait(5000) > 0);
    CHECK_TEXT(closed_loop_send("W X Y"), ":A 1000.1 1000.1 \r\n");
    CHECK_INT(board_count(closed_loop_board(), X), -4540);
    CHECK_INT(board_count(closed_loop_board(), Y), 4540);
    CHECK_INT(fault_read(0), FAULT_NONE);
    closed_loop_reverse(X, false);
}

TEST_MAIN(RUN(an_illegal_transition_stops_its_axis); RUN(an_axis_at_rest_is_switched_off_too);
          RUN(what_was_before_the_start_is_no_fault); RUN(a_broken_wire_ends_as_a_dead_axis);
          RUN(a_small_move_with_a_broken_wire_is_given_up); RUN(a_broken_wire_ends_the_tuner);
          RUN(the_polarity_of_an_encoder_is_a_setting))
