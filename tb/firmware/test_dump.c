/* SPDX-License-Identifier: BSD-2-Clause */
/* DUMP: the record of motions, the error log. */
#include "check.h"

#include <stdlib.h>

#include "core/events.h"
#include "core/fault.h"
#include "machine.h"
#include "modules/dump.h"
#include "modules/motion.h"
#include "port.h"

#define SEND(text, reply) CHECK_TEXT(machine_send(text), reply)
#define DONE ":A \r\n"

static void start(void)
{
    machine_start();
    machine_run(200);
    (void)machine_send("DU X");
}

/* Lines of a reply, the last ended by CR LF, the others by CR. */
static unsigned lines(const char *text)
{
    unsigned count = 0;

    for (; *text != '\0'; text++)
        count += *text == '\r';
    return count;
}

TEST(records_a_line_for_each_turn_of_a_motion)
{
    int tick, axis, target, position, error, duty, last = 0;

    start();
    SEND("DU", DONE); /* nothing moved yet */
    SEND("M Y=20", DONE);
    machine_run(30);
    const char *text = machine_send("DU");
    unsigned count = lines(text);

    CHECK(count >= 7 && count <= 16); /* 0.5 ms each */
    for (unsigned n = 0; n < count; n++) {
        CHECK_INT(sscanf(text, "%d %d %d %d %d %d", &tick, &axis, &target, &position, &error,
                         &duty), 6);
        CHECK_INT(tick, n);
        CHECK_INT(axis, 1);
        CHECK_INT(error, target - position);
        CHECK(target >= last && target <= 91);
        last = target;
        text = strchr(text, '\r') + 1;
    }
    CHECK(last > 0);
    CHECK_TEXT(text, "\n");
}

TEST(ends_when_full_until_it_is_cleared)
{
    start();
    SEND("M X=10000 Y=10000", DONE);
    machine_run(400);
    const char *text = machine_send("DU");

    CHECK_INT(lines(text), DUMP_STEPS);
    CHECK(strncmp(text, "0 0 ", 4) == 0);
    char *begin = strdup(text);
    machine_run(100);
    text = machine_send("DU");
    bool same = strcmp(text, begin) == 0;
    free(begin);
    CHECK(same);
    SEND("DU X", DONE);
    machine_run(10);
    CHECK(lines(machine_send("DU")) < 50);
}

TEST(goes_on_over_the_oldest_when_told)
{
    int tick, axis, target;

    start();
    SEND("DU R=1", DONE);
    SEND("M X=10000", DONE);
    machine_run(800);
    const char *text = machine_send("DU");

    CHECK_INT(lines(text), DUMP_STEPS);
    CHECK_INT(sscanf(text, "%d %d %d", &tick, &axis, &target), 3);
    CHECK_INT(tick, 0);
    CHECK(target > 100);
    SEND("DU R=2", ":N-4\r\n");
    SEND("DU R?", ":A R=1\r\n");
}

TEST(leaves_out_turns_when_told)
{
    int first, second;

    start();
    SEND("DU T=10", DONE);
    SEND("M X=100", DONE);
    machine_run(100);
    const char *text = machine_send("DU");

    CHECK_INT(sscanf(text, "%d", &first), 1);
    CHECK_INT(sscanf(strchr(text, '\r') + 1, "%d", &second), 1);
    CHECK_INT(first, 0);
    CHECK_INT(second, 10);
    SEND("DU T=0", ":N-4\r\n");
}

TEST(halt_does_not_wait_for_it)
{
    start();
    SEND("M X=10000", DONE);
    machine_run(400);
    port_hold();
    port_queue("DU\r");
    (void)port_take(100);
    port_queue("\\");
    (void)port_take(100);
    machine_run(1500);
    char *all = calloc(1, 20000); /* the reply still comes whole, and HALT's behind it */
    size_t length = 0;
    for (int n = 0; n < 2000; n++) {
        const char *part = port_take(100);
        strcpy(all + length, part);
        length += strlen(part);
    }
    bool good = length > 9 && strcmp(all + length - 9, "\r\n:N-21\r\n") == 0 && length < 19999;
    free(all);
    CHECK(good);
    CHECK(!motion_busy());
}

TEST(prints_the_error_log_newest_first)
{
    start();
    log_error(34);
    log_error(302);
    log_error(90);
    const char *text = machine_send("DU Y");

    CHECK(strncmp(text, "90 302 34 0 0 0 0 0 0 0 0 0 0 0 0 0\r0 0 ", 40) == 0);
    CHECK_INT(lines(text), 4);
    SEND("DU X", DONE);
    CHECK(strncmp(machine_send("DU Y"), "0 0 0 0", 7) == 0);
}

TEST(the_error_log_holds_sixty_four)
{
    int code, count = 0, read;

    start();
    for (uint16_t n = 1; n <= 100; n++) {
        log_error(n);
        machine_run(1); /* each is an event; they are taken a few at a time */
    }
    for (const char *text = machine_send("DU Y"); sscanf(text, "%d%n", &code, &read) == 1;
         text += read) {
        CHECK_INT(code, 100 - count);
        count++;
    }
    CHECK_INT(count, 64);
}

static uint64_t now_fast;

static uint64_t clock_fast(void)
{
    return now_fast;
}

TEST(marks_ten_minutes_once)
{
    start();
    events_set_clock(clock_fast);
    now_fast = 0;
    port_start(command_modules());
    now_fast = UINT64_C(601) * 200000000;
    machine_run(1);
    CHECK_INT(fault_read(0), 0); /* nothing to mark */
    log_error(34);
    now_fast *= 2;
    machine_run(1);
    CHECK_INT(fault_read(0), FAULT_TEN_MINUTES);
    CHECK_INT(fault_read(1), 34);
    now_fast = UINT64_C(1900) * 200000000;
    machine_run(1);
    CHECK_INT(fault_read(1), 34);
}

TEST_MAIN(RUN(records_a_line_for_each_turn_of_a_motion); RUN(ends_when_full_until_it_is_cleared);
          RUN(goes_on_over_the_oldest_when_told); RUN(leaves_out_turns_when_told);
          RUN(halt_does_not_wait_for_it); RUN(prints_the_error_log_newest_first);
          RUN(the_error_log_holds_sixty_four); RUN(marks_ten_minutes_once))
