/* SPDX-License-Identifier: BSD-2-Clause */
/* LED DIMMER through the language, down to the registers of the modulation and of the router. */
#include "check.h"

#include <stdint.h>
#include <stdlib.h>

#include "core/settings.h"
#include "host/mmio.h"
#include "machine.h"
#include "regs.h"

#define DONE ":A \r\n"
#define SEND(line) CHECK_TEXT(machine_send(line), DONE)

enum { LOW, HIGH, LAMP = 5, INVERTED = REG_ROUTER_OUT0_INVERT_MASK, MS = 5 };

/* What has been loaded: On is seen with the write of Control. */
static struct {
    uint32_t period, on;
    int32_t route; /* of OUT0 at that time */
} loads[64];
static unsigned count;

static uint32_t out0(void)
{
    return mmio_model_get(REG_ROUTER_OUT0);
}

static void load(void *context, uintptr_t address, uint32_t value)
{
    (void)context;
    (void)address;
    if ((value & REG_LED_CONTROL_LOAD_MASK) != 0 && count < 64) {
        loads[count].period = mmio_model_get(REG_LED_PERIOD);
        loads[count].on = mmio_model_get(REG_LED_ON);
        loads[count++].route = (int32_t)out0();
    }
}

static void power_up(void)
{
    machine_start();
    count = 0;
    mmio_model_hook((struct mmio_hook){
        .first = REG_LED_CONTROL, .last = REG_LED_CONTROL, .write = load});
    machine_run(20 * MS);
}

static void start(void)
{
    settings_ram_clear();
    power_up();
}

#define CHECK_LAST(wanted_period, wanted_on, wanted_route)                                         \
    do {                                                                                           \
        machine_run(1);                                                                            \
        CHECK(count > 0);                                                                          \
        CHECK_INT(loads[count - 1].period, wanted_period);                                         \
        CHECK_INT(loads[count - 1].on, wanted_on);                                                 \
        CHECK_INT(out0(), wanted_route);                                                           \
    } while (0)

TEST(the_share_of_a_period_is_exact_at_both_ends)
{
    static const struct {
        const char *line;
        uint32_t on;
    } shares[] = {{"LED X=0", 0}, {"LED X=100", 153846}, {"LED X=50", 76923}, {"LED X=25", 38462},
                  {"LED X=0.1", 154}, {"LED X=99.9", 153692}, {"LED X", 0}, {"LED X=1e2", 153846}};

    start();
    SEND("TTL Y=9");
    for (unsigned n = 0; n < sizeof shares / sizeof *shares; n++) {
        SEND(shares[n].line);
        CHECK_LAST(153846, shares[n].on, LAMP);
    }
}

TEST(the_rate_is_what_is_asked_to_the_nearest_clock)
{
    start();
    SEND("LED X=10");
    SEND("TTL Y=9");
    SEND("LED R=200000");
    CHECK_LAST(1000, 100, LAMP);
    SEND("LED R=100");
    CHECK_LAST(2000000, 200000, LAMP);
    SEND("LED R=7777.7");
    CHECK_LAST(25715, 2572, LAMP);
    CHECK_TEXT(machine_send("LED R? X?"), "X=10 R=7777.7 :A\r\n");
}

TEST(share_and_rate_of_a_line_are_loaded_together)
{
    start();
    SEND("LED X=10");
    SEND("TTL Y=9");
    machine_run(1);
    count = 0;
    SEND("LED R=10000 X=75");
    CHECK_LAST(20000, 15000, LAMP);
    CHECK_INT(count, 1);
}

TEST(queries_answer_as_hosts_expect)
{
    start();
    CHECK_TEXT(machine_send("LED X?"), "X=0 :A\r\n");
    SEND("LED X=40");
    CHECK_TEXT(machine_send("LED X?"), "X=40 :A\r\n");
    SEND("LED X=12.5");
    CHECK_TEXT(machine_send("LED X?"), "X=12.5 :A\r\n");
    CHECK_TEXT(machine_send("LED R?"), "R=1300 :A\r\n");
    CHECK(strstr(machine_send("BU X"), "\rLED DIMMER\r") != NULL);
}

TEST(what_cannot_be_is_refused_and_changes_nothing)
{
    static const char *const lines[][2] = {
        {"LED", ":N-3\r\n"}, {"LED X=", ":N-3\r\n"}, {"LED Y=5", ":N-2\r\n"}, {"LED 5", ":N-2\r\n"},
        {"LED X=100.1", ":N-4\r\n"}, {"LED X=-0.1", ":N-4\r\n"}, {"LED X+", ":N-4\r\n"},
        {"LED R=99.9", ":N-4\r\n"}, {"LED R=200001", ":N-4\r\n"}, {"LED X=10 R=0", ":N-4\r\n"},
        {"TTL 40", ":N-2\r\n"}, {"TTL Y=1 40", ":N-2\r\n"}, {"TTL X=0 40", ":N-2\r\n"},
        {"TTL Y? 40", ":N-2\r\n"}, {"TTL Y=9 101", ":N-4\r\n"}, {"TTL Y=9 -1", ":N-4\r\n"}};

    start();
    SEND("LED X=30");
    SEND("TTL Y=9");
    machine_run(1);
    count = 0;
    for (unsigned n = 0; n < sizeof lines / sizeof *lines; n++)
        CHECK_TEXT(machine_send(lines[n][0]), lines[n][1]);
    CHECK_TEXT(machine_send("LED X? R?"), "X=30 R=1300 :A\r\n");
    CHECK_TEXT(machine_send("TTL Y?"), ":A Y=9\r\n");
    CHECK_INT(count, 0);
}

/* What a client sends to open and close a shutter. */
TEST(a_number_behind_mode_nine_is_the_brightness)
{
    start();
    SEND("TTL Y=0");
    SEND("LED X=80");
    machine_run(1);
    count = 0;
    SEND("TTL Y=9 40");
    CHECK_LAST(153846, 61538, LAMP);
    CHECK_INT(count, 1); /* no light of 80 before */
    CHECK_TEXT(machine_send("LED X?"), "X=40 :A\r\n");
    SEND("TTL Y=9 60");
    CHECK_LAST(153846, 92308, LAMP);
    CHECK_INT(count, 2); /* no gap between */
    SEND("TTL Y=9");
    CHECK_LAST(153846, 92308, LAMP);
    CHECK_TEXT(machine_send("TTL"), ":A 1\r\n");
    SEND("TTL Y=9 0");
    CHECK_LAST(153846, 0, LAMP);
    CHECK_TEXT(machine_send("TTL"), ":A 0\r\n");
}

TEST(it_is_dark_at_once_and_light_from_the_beginning_of_a_period)
{
    start();
    SEND("LED X=80");
    machine_run(1);
    CHECK_INT(count, 0); /* not while another mode has OUT0 */
    SEND("TTL Y=9");
    CHECK_LAST(153846, 123077, LAMP);
    CHECK_TEXT(machine_send("TTL Y=0"), DONE);
    CHECK_INT(out0(), LOW);
    CHECK_LAST(153846, 0, LOW);
    /* The last period may take 10 ms. */
    count = 0;
    SEND("TTL Y=9");
    machine_run(9 * MS);
    CHECK_INT(count, 0);
    CHECK_INT(out0(), LOW);
    machine_run(4 * MS);
    CHECK_LAST(153846, 123077, LAMP);
    CHECK_INT(count, 1);
    CHECK_INT(loads[0].route, LAMP);
    /* Also of a mode that has its level from the main loop. */
    SEND("TTL Y=3");
    machine_run(2);
    CHECK_LAST(153846, 0, LOW);
    SEND("TTL Y=1");
    CHECK_LAST(153846, 0, HIGH);
}

TEST(polarity_is_that_of_out0)
{
    start();
    SEND("TTL Y=9 50");
    SEND("TTL F=-1");
    CHECK_LAST(153846, 76923, LAMP | INVERTED);
    SEND("TTL F=1");
    CHECK_LAST(153846, 76923, LAMP);
}

TEST(it_is_saved_with_the_other_settings)
{
    start();
    SEND("TTL Y=9 33");
    SEND("LED R=500");
    CHECK_TEXT(machine_send("SS Z"), DONE);
    SEND("TTL Y=9 44");
    power_up();
    CHECK_TEXT(machine_send("LED X? R?"), "X=33 R=500 :A\r\n");
    CHECK_LAST(400000, 132000, LAMP);
}

TEST_MAIN(RUN(the_share_of_a_period_is_exact_at_both_ends);
          RUN(the_rate_is_what_is_asked_to_the_nearest_clock);
          RUN(share_and_rate_of_a_line_are_loaded_together); RUN(queries_answer_as_hosts_expect);
          RUN(what_cannot_be_is_refused_and_changes_nothing);
          RUN(a_number_behind_mode_nine_is_the_brightness);
          RUN(it_is_dark_at_once_and_light_from_the_beginning_of_a_period);
          RUN(polarity_is_that_of_out0); RUN(it_is_saved_with_the_other_settings))
