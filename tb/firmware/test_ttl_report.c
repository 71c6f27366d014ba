/* SPDX-License-Identifier: BSD-2-Clause */
/* TTL_REPORT_INT and TTL_OUT_REPORT: from records in the trigger's queue to bytes, over a model of both blocks. */
#include "check.h"

#include "core/fault.h"
#include "core/report.h"
#include "host/mmio.h"
#include "machine.h"
#include "modules/ttl_report.h"
#include "port.h"
#include "regs.h"

#define ACKNOWLEDGED ":A \r\n"
#define SEND(text, reply) CHECK_TEXT(machine_send(text), reply)

enum { QUEUE = 64, FIFO = 64, SENT = 4096, WORDS = 6 };

/* --- The blocks -------------------------------------------------------------------------------- */

static uint32_t queue[QUEUE][WORDS];
static unsigned waiting;
static uint8_t sent[SENT];
static unsigned sent_count, fifo_used;

static uint32_t read_trigger(void *context, uintptr_t address)
{
    (void)context;
    if (address == REG_TRIGGER_LEVEL)
        return waiting;
    return queue[0][(address - REG_TRIGGER_TIME_LOW) / 4];
}

static void write_trigger(void *context, uintptr_t address, uint32_t value)
{
    (void)context;
    if (address == REG_TRIGGER_NEXT && value == REG_TRIGGER_NEXT_TAKE_MASK && waiting > 0)
        memmove(queue[0], queue[1], --waiting * sizeof queue[0]);
}

static uint32_t read_port(void *context, uintptr_t address)
{
    (void)context;
    (void)address;
    return (fifo_used <= FIFO / 2 ? REG_REPORT_STATUS_TX_LOW_MASK : 0) |
           (fifo_used < FIFO ? REG_REPORT_STATUS_TX_READY_MASK : 0);
}

static void write_port(void *context, uintptr_t address, uint32_t value)
{
    (void)context;
    (void)address;
    if (fifo_used == FIFO)
        return; /* lost, as in the gateware */
    fifo_used++;
    sent[sent_count++ % SENT] = (uint8_t)value;
}

static void start(void)
{
    machine_start();
    waiting = sent_count = fifo_used = 0;
    mmio_model_set(REG_IDENTITY_CLOCK_HZ, CLOCK_HZ);
    mmio_model_hook((struct mmio_hook){.first = REG_TRIGGER_NEXT, .last = REG_TRIGGER_NEXT,
                                       .write = write_trigger});
    mmio_model_hook((struct mmio_hook){.first = REG_TRIGGER_LEVEL, .last = REG_TRIGGER_LEVEL,
                                       .read = read_trigger});
    mmio_model_hook((struct mmio_hook){.first = REG_TRIGGER_TIME_LOW, .last = REG_TRIGGER_COUNT3,
                                       .read = read_trigger});
    mmio_model_hook((struct mmio_hook){.first = REG_REPORT_STATUS, .last = REG_REPORT_STATUS,
                                       .read = read_port});
    mmio_model_hook((struct mmio_hook){.first = REG_REPORT_DATA, .last = REG_REPORT_DATA,
                                       .write = write_port});
}

static void pulse(uint64_t time_fast, int32_t x, int32_t y, int32_t z, int32_t f)
{
    const uint32_t record[WORDS] = {(uint32_t)time_fast, (uint32_t)(time_fast >> 32), (uint32_t)x,
                                    (uint32_t)y, (uint32_t)z, (uint32_t)f};

    memcpy(queue[waiting++], record, sizeof record);
}

/* Interrupts as long as a line asks for them; how many there were. */
static unsigned interrupts(void)
{
    unsigned count = 0;

    for (; count < 1000; count++) {
        const bool trigger = mmio_model_get(REG_TRIGGER_INTERRUPT_ENABLE) != 0 && waiting > 0;
        const bool port = mmio_model_get(REG_REPORT_INTERRUPT_ENABLE) != 0 && fifo_used <= FIFO / 2;

        if (!trigger && !port)
            break;
        (void)ttl_report_interrupt();
    }
    return count;
}

/* The port has sent everything, and the processor filled it again, until all is done. */
static void drain(void)
{
    do {
        fifo_used = 0;
        (void)interrupts();
    } while (fifo_used > 0);
}

static unsigned log_entries(uint16_t code)
{
    unsigned count = 0;

    for (unsigned entry = 0; entry < FAULT_LOG; entry++)
        count += fault_read(entry) == code;
    return count;
}

static const char *text_of(unsigned first, unsigned count)
{
    static char text[100];

    if (count >= sizeof text)
        return "longer than expected";
    memcpy(text, sent + first, count);
    text[count] = '\0';
    return text;
}

#define CONFIG(enable, output, falling)                                                            \
    ((enable) << REG_TRIGGER_CONFIG_ENABLE_SHIFT | (output) << REG_TRIGGER_CONFIG_OUTPUT_SHIFT |   \
     (falling) << REG_TRIGGER_CONFIG_FALLING_SHIFT | 20u << REG_TRIGGER_CONFIG_MINIMUM_SHIFT)

/* --- Tests ------------------------------------------------------------------------------------- */

TEST(a_pulse_sends_a_record)
{
    start();
    SEND("BU F=3", ACKNOWLEDGED);
    SEND("TTL X=1", ACKNOWLEDGED);
    CHECK_INT(mmio_model_get(REG_TRIGGER_CONFIG), CONFIG(1, 0, 0));
    CHECK_INT(mmio_model_get(REG_REPORT_DIVISOR), CLOCK_HZ / 115200);
    pulse(1000, 45391, 0, 10000, -1);
    CHECK(interrupts() > 0);
    CHECK_INT(sent_count, 21);
    CHECK(memcmp(sent, "\x18\x4f\xb1\0\0\x19\0\0\0\0\x1a\x10\x27\0\0\x1b\xff\xff\xff\xff\r", 21) == 0);
    CHECK_INT(interrupts(), 0);
}

TEST(numbers_of_axes_are_those_of_the_low_level_format)
{
    start();
    SEND("BU F=3", ACKNOWLEDGED);
    SEND("TTL X=6", ACKNOWLEDGED);
    SEND("LL Z=77", ACKNOWLEDGED);
    machine_run(1);
    pulse(1000, 0, 0, 0, 0);
    drain();
    CHECK_INT(sent[0], 24);
    CHECK_INT(sent[10], 77);
}

TEST(in_other_profiles_and_switched_off_nothing_is_sent)
{
    start();
    SEND("TTL X=1", ACKNOWLEDGED);
    CHECK_INT(mmio_model_get(REG_TRIGGER_CONFIG), 0);
    SEND("BU F=3", ACKNOWLEDGED); /* the mode is kept: it is one of any */
    CHECK_INT(mmio_model_get(REG_TRIGGER_CONFIG), CONFIG(1, 0, 0));
    pulse(1000, 1, 2, 3, 4);
    SEND("TTL X=0", ACKNOWLEDGED);
    CHECK_INT(mmio_model_get(REG_TRIGGER_CONFIG), CONFIG(0, 0, 0));
    CHECK_INT(waiting, 0);
    drain();
    CHECK_INT(sent_count, 0);
    CHECK_INT(mmio_model_get(REG_TRIGGER_INTERRUPT_ENABLE), 0);
    CHECK_INT(mmio_model_get(REG_REPORT_INTERRUPT_ENABLE), 0);
}

TEST(records_follow_each_other_as_the_port_takes_them)
{
    start();
    SEND("BU F=3", ACKNOWLEDGED);
    SEND("TTL M=1 X=1", ACKNOWLEDGED);
    for (int n = 0; n < 40; n++)
        pulse(1000, n, -n, 1000 * n, n);
    CHECK(interrupts() < 5);
    CHECK_INT(fifo_used, FIFO); /* what fits, no more */
    drain();
    CHECK_INT(waiting, 0);
    CHECK_TEXT(text_of(0, 34), "X=0 Y=0 Z=0 F=0\r\nX=1 Y=-1 Z=1000 F");
    CHECK_TEXT(text_of(sent_count - 25, 25), "X=39 Y=-39 Z=39000 F=39\r\n");
}

TEST(each_interrupt_makes_one_record_at_most)
{
    start();
    SEND("BU F=3", ACKNOWLEDGED);
    SEND("TTL X=1", ACKNOWLEDGED);
    for (int n = 0; n < 3; n++)
        pulse(1000, n, n, n, n);
    (void)ttl_report_interrupt();
    CHECK_INT(waiting, 2);
    CHECK_INT(sent_count, 21);
}

TEST(the_offset_is_that_of_the_latch)
{
    start();
    SEND("BU F=3", ACKNOWLEDGED);
    SEND("TTL M=1 X=1", ACKNOWLEDGED);
    mmio_model_set(REG_SNAPSHOT_SAMPLE_TIME_LOW, 5000);
    mmio_model_set(REG_SNAPSHOT_SAMPLE_TIME_HIGH, 1);
    pulse((UINT64_C(1) << 32) + 4999, 100, 100, 100, 100);
    SEND("H X=1000 Y=0", ACKNOWLEDGED); /* 0.1 mm: 4540 counts; nothing of it in the first record */
    mmio_model_set(REG_SNAPSHOT_SAMPLE_TIME_LOW, 6000);
    pulse((UINT64_C(1) << 32) + 5000, 100, 100, 100, 100);
    SEND("Z", ACKNOWLEDGED);
    pulse((UINT64_C(1) << 32) + 6000, 100, 100, 100, 100);
    drain();
    CHECK_TEXT(text_of(0, sent_count), "X=100 Y=100 Z=100 F=100\r\n"
                                       "X=4640 Y=100 Z=100 F=100\r\n"
                                       "X=100 Y=100 Z=100 F=100\r\n");
}

TEST(many_changes_of_the_offset_are_remembered)
{
    char line[24], wanted[64];
    unsigned at = 0;

    start();
    SEND("BU F=3", ACKNOWLEDGED);
    SEND("TTL M=1 X=1", ACKNOWLEDGED);
    for (int n = 0; n < 60; n++) {
        mmio_model_set(REG_SNAPSHOT_SAMPLE_TIME_LOW, (uint32_t)(1000 * n + 1));
        snprintf(line, sizeof line, "H X=%d", 100 * n);
        SEND(line, ACKNOWLEDGED);
        pulse((uint64_t)(1000 * n + 500), 0, 0, 0, 0);
    }
    drain();
    for (int n = 0; n < 60; n++) {
        snprintf(wanted, sizeof wanted, "X=%d Y=0 Z=0 F=0\r\n", (int)(100 * n * 4.5396 + 0.5));
        CHECK_TEXT(text_of(at, (unsigned)strlen(wanted)), wanted);
        at += (unsigned)strlen(wanted);
    }
}

TEST(losses_are_counted_and_logged_once_in_a_while)
{
    start();
    mmio_model_set(REG_TRIGGER_MISSED, 7); /* of before */
    SEND("BU F=3", ACKNOWLEDGED);
    SEND("TTL X=1", ACKNOWLEDGED);
    SEND("TREP R?", ":A R=0\r\n");
    for (uint32_t lost = 1; lost <= 5; lost++) {
        mmio_model_set(REG_TRIGGER_MISSED, 7 + lost);
        machine_run(50); /* 10 ms */
    }
    SEND("TREP R?", ":A R=5\r\n");
    CHECK_INT(log_entries(FAULT_REPORT_OVERRUN), 1);
    machine_run(600);
    mmio_model_set(REG_TRIGGER_MISSED, 13);
    machine_run(10);
    CHECK_INT(log_entries(FAULT_REPORT_OVERRUN), 2);
    SEND("TREP R?", ":A R=6\r\n");
}

TEST(on_the_main_port_records_come_whole_and_between_replies)
{
    const char *text;

    start();
    SEND("BU F=3", ACKNOWLEDGED);
    SEND("TREP X=1", ACKNOWLEDGED);
    SEND("TTL M=1 X=1", ACKNOWLEDGED);
    pulse(1000, 1, 2, 3, 4);
    CHECK(ttl_report_interrupt()); /* it is for the main loop */
    CHECK_INT(interrupts(), 0);
    text = machine_send("W X");
    CHECK_TEXT(text, "X=1 Y=2 Z=3 F=4\r\n:A 0.0 \r\n");
    CHECK_INT(sent_count, 0);
    CHECK_INT(mmio_model_get(REG_TRIGGER_INTERRUPT_ENABLE), 1);
    /* A reply in parts is not broken into. */
    for (int n = 0; n < 3; n++)
        pulse(1000, n, n, n, n);
    text = machine_send("BU X");
    CHECK(strncmp(text, "X=0 Y=0 Z=0 F=0\r\nX=1 Y=1 Z=1 F=1\r\nX=2 Y=2 Z=2 F=2\r\nABBE_XYZF\r", 61) == 0);
}

/* More records than the port carries: a line gets its reply all the same. */
TEST(on_the_main_port_replies_are_not_starved)
{
    unsigned turns = 0;

    start();
    SEND("BU F=3", ACKNOWLEDGED);
    SEND("TREP X=1", ACKNOWLEDGED);
    SEND("TTL M=1 X=1", ACKNOWLEDGED);
    port_hold();
    for (; turns < 500; turns++) {
        while (waiting < QUEUE)
            pulse(1000, 1, 1, 1, 1);
        if (turns == 100)
            port_queue("W X\r");
        machine_run(1);
        if (strchr(port_take(20), ':') != NULL)
            break;
    }
    CHECK(turns > 100);
    CHECK(turns < 160); /* what was in the rings before, and the reply */
}

TEST(pulses_at_out0_send_packets)
{
    start();
    SEND("TREP F=1", ACKNOWLEDGED);
    CHECK_INT(mmio_model_get(REG_TRIGGER_CONFIG), CONFIG(1, 1, 0));
    pulse(1000, 1, 2, 3, 4);
    drain();
    CHECK_INT(sent_count, 24);
    CHECK(memcmp(sent, "\0\0\0\0\0\0\0\0\0\1\0\0\0\2\0\0\0\3\0\0\0\4\xff\xf5", 24) == 0);
    SEND("TREP F=2 Z=1", ACKNOWLEDGED);
    CHECK_INT(mmio_model_get(REG_TRIGGER_CONFIG), CONFIG(1, 1, 1));
    SEND("TREP F=0", ACKNOWLEDGED);
    CHECK_INT(mmio_model_get(REG_TRIGGER_CONFIG), CONFIG(0, 1, 1));
}

TEST(the_port_may_have_a_rate_of_its_own)
{
    start();
    SEND("BU F=3", ACKNOWLEDGED);
    SEND("TTL X=1", ACKNOWLEDGED);
    SEND("TREP Y=1000000", ACKNOWLEDGED);
    CHECK_INT(mmio_model_get(REG_REPORT_DIVISOR), 50);
    SEND("TREP Y=100", ":N-4\r\n");
    SEND("TREP Y=0", ACKNOWLEDGED);
    CHECK_INT(mmio_model_get(REG_REPORT_DIVISOR), 434);
}

TEST(build_names_what_there_is)
{
    start();
    CHECK(strstr(machine_send("BU X"), "\rSERIAL OUT\rBINARY_OUTPUT\rTTL_OUT_REPORT") != NULL);
    SEND("TTL M=1", ACKNOWLEDGED);
    SEND("TREP X=1", ACKNOWLEDGED);
    CHECK(strstr(machine_send("BU X"), "SERIAL OUT") == NULL);
    CHECK(strstr(machine_send("BU X"), "BINARY_OUTPUT") == NULL);
}

TEST_MAIN(RUN(a_pulse_sends_a_record); RUN(numbers_of_axes_are_those_of_the_low_level_format);
          RUN(in_other_profiles_and_switched_off_nothing_is_sent);
          RUN(records_follow_each_other_as_the_port_takes_them);
          RUN(each_interrupt_makes_one_record_at_most); RUN(the_offset_is_that_of_the_latch);
          RUN(many_changes_of_the_offset_are_remembered);
          RUN(losses_are_counted_and_logged_once_in_a_while);
          RUN(on_the_main_port_records_come_whole_and_between_replies);
          RUN(on_the_main_port_replies_are_not_starved); RUN(pulses_at_out0_send_packets);
          RUN(the_port_may_have_a_rate_of_its_own); RUN(build_names_what_there_is))
