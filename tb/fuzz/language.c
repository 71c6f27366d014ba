/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Fuzz target: bytes from the serial line through line, parser, rows and replies of the whole
 * firmware, and the binary format, while axes move. Linked with libFuzzer, or with replay.c.
 *
 * Each input starts from power-up with nothing kept. Bytes in it that are not for the line: PAUSE lets
 * 2 ms pass, HAND has the next byte done to the inputs (hand), POWER takes the power away for a moment.
 * Claims, beside what the
 * sanitizers see: the console never gets stuck, HALT ends what lasts, and afterwards a good line
 * gets its one right answer.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/console.h"
#include "core/events.h"
#include "core/fault.h"
#include "core/report.h"
#include "core/settings.h"
#include "machine.h"
#include "panel.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum {
    PAUSE = 0x16,
    HAND = 0x17,
    POWER = 0x14,
    PAUSE_TICKS = 10,
    TURNS_PER_TICK = 10, /* a turn takes 20 us */
    TURNS_MAX = 4000, /* without rest: 80 ms; then HALT */
    HALTS_MAX = 64,   /* commands of an input that last, and parts of long replies */
    INPUT_MAX = 4096,
    OUTPUT = 1024,
};

RING_DEFINE(receive, 256);
RING_DEFINE(transmit, 256);

static struct console console;
static unsigned turns;

/* What came out first since it was last forgotten; enough for the answer that is looked at. */
static char output[OUTPUT];
static size_t output_length;

static void turn(void)
{
    uint8_t byte;

    console_poll(&console);
    fault_poll();
    events_poll();
    settings_poll();
    while (ring_take(&transmit, &byte))
        if (output_length < OUTPUT - 1)
            output[output_length++] = (char)byte;
    if (++turns % TURNS_PER_TICK == 0)
        machine_run(1);
}

static void put(const char *text)
{
    while (*text != '\0')
        ring_put(&receive, (uint8_t)*text++);
}

static bool comes_to_rest(void)
{
    for (unsigned n = 0; n < TURNS_MAX; n++) {
        turn();
        if (console_idle(&console) && ring_used(&receive) == 0)
            return true;
    }
    return false;
}

/* Ends what is half typed or half a frame, and is itself no more than an empty line. */
static const char line_end[] = "\r\r\r\r\r\r\r\r\377A\r";

static void settle(void)
{
    /* AZERO takes seconds, and more of them may wait. */
    for (unsigned halts = 0; halts < HALTS_MAX; halts++) {
        if (comes_to_rest())
            return;
        put(line_end);
        put("\\");
    }
    fprintf(stderr, "the console does not come to rest\n");
    abort();
}

static void expect(const char *line, const char *reply)
{
    put(line_end);
    settle();
    /* Of a line of the input that had no CR, or that said something by itself. */
    report_clear();
    output_length = 0;
    put(line);
    settle();
    output[output_length] = '\0';
    if (strstr(output, reply) == NULL) {
        fprintf(stderr, "%.*s gives \"%s\"\n", (int)strlen(line) - 1, line, output);
        abort();
    }
}

static void power_up(void)
{
    machine_start();
    panel_start();
    ring_clear(&receive);
    ring_clear(&transmit);
    console_init(&console, &receive, &transmit, NULL);
}

static void pause(void)
{
    for (unsigned n = 0; n < PAUSE_TICKS; n++) {
        machine_run(1);
        turn();
    }
}

/* Bits 7 and 6 say what it does; the others to which input, and how. */
static void hand(uint8_t how)
{
    switch (how >> 6) {
    case 0:
        panel_press((enum button)(how & 3), (enum button_length)((how >> 2 & 3) % 3), 0);
        break;
    case 1:
        panel_analog(how & 7, (how >> 3 & 7) / 7.0);
        break;
    case 2:
        panel_ttl((enum inputs_ttl)(how & 1), (how & 2) != 0, 0);
        break;
    default:
        panel_turn(how & 3, (how >> 2 & 15) - 8);
        break;
    }
}

static bool is_for_the_line(uint8_t byte)
{
    return byte != PAUSE && byte != HAND && byte != POWER;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size > INPUT_MAX)
        return 0;
    settings_ram_clear();
    power_up();
    turns = 0;
    for (size_t at = 0; at < size;) {
        while (at < size && is_for_the_line(data[at]) && ring_put(&receive, data[at]))
            at++;
        turn();
        for (; at < size && !is_for_the_line(data[at]) && ring_used(&receive) == 0; at++) {
            if (data[at] == PAUSE)
                pause();
            else if (data[at] == POWER)
                power_up();
            else if (at + 1 < size)
                hand(data[++at]);
        }
    }
    settle();
    expect("CD\r", "20");
    expect("FOO\r", ":N-1\r");
    return 0;
}
