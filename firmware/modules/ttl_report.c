/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/ttl_report.h"

#include <stddef.h>

#include "core/fault.h"
#include "core/report.h"
#include "hal/identity.h"
#include "hal/report_port.h"
#include "hal/serial.h"
#include "hal/trigger.h"
#include "modules/inputs.h"
#include "modules/low_level.h"
#include "modules/origin_history.h"
#include "modules/record_format.h"
#include "modules/z_stack.h"

/*
 * On the report port all is done by the interrupts: one record is made at a time, and the next when
 * it has gone into the port's FIFO. Either the trigger interrupts, when a record waits, or the port,
 * when it has room for more of this one. On the main port it is the main loop that sends, between
 * replies.
 */

enum port { PORT_REPORT, PORT_MAIN, PORTS };
enum packets { PACKETS_OFF, PACKETS_HIGH_FIRST, PACKETS_LOW_FIRST, PACKETS_CHOICES };

/* Clocks of 5 ns that a pulse and the pause after it must last: 100 ns. */
enum { PULSE_FAST = 20 };

/* Bytes that may wait in the main port before more records go there: what leaves in half a turn of
 * the main loop at the port's fastest, and replies do not wait long for. */
enum { MAIN_PORT_BYTES = 64 };

/* Losses less than this apart are one entry in the log. */
#define SAME_LOSS_FAST (EVENTS_FAST_PER_S / 10)

/* A record then takes the line four times as long as the interrupt, or longer. */
#define RATE_MAX 2000000.0

static double format, port, rate_bits_per_s, falling, packets;
static bool selected; /* as the mode of IN0 */

/* What holds, of the settings, in a form that costs an interrupt nothing. */
static volatile bool active;
static bool on_main;
static enum record_format present_format;
static enum packets present_packets;

static struct record record;

/* The record that is on its way to the report port. */
static uint8_t bytes[RECORD_BYTES_MAX];
static size_t length, sent;

static uint32_t missed_before, missed_seen; /* as records began; as of the last look */
static uint64_t lost_fast;                  /* when some were lost last */
static bool any_lost;

/* --- Records ----------------------------------------------------------------------------------- */

/* Take the next one and write it. False: none waits. */
static bool next_record(void)
{
    struct trigger_record taken;
    const int32_t *origin;

    if (!active || !trigger_take(&taken))
        return false;
    origin = origin_history_at(taken.time_fast);
    record.time_fast = taken.time_fast;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        record.counts[axis] =
            (int32_t)((uint32_t)taken.position_counts[axis] - (uint32_t)origin[axis]);
    sent = 0;
    if (present_packets != PACKETS_OFF) {
        /* There is no array; its places are 0. */
        const uint16_t place[3] = {0, 0, (uint16_t)z_stack_slice()};

        length = record_write_packet(bytes, present_packets == PACKETS_LOW_FIRST, place, &record);
    } else {
        length = record_write(bytes, present_format, &record);
    }
    record.number++;
    return true;
}

bool ttl_report_interrupt(void)
{
    if (sent == length && (on_main || !next_record())) {
        report_port_interrupt(false);
        trigger_interrupt(active && !on_main);
        return on_main;
    }
    for (unsigned room = 0; sent < length; room--) {
        if (room == 0 && (room = report_port_room()) == 0)
            break;
        report_port_send(bytes[sent++]);
    }
    report_port_interrupt(sent < length);
    trigger_interrupt(sent == length && active);
    return false;
}

/* --- Start and end ----------------------------------------------------------------------------- */

static bool wanted(void)
{
    return selected || packets != PACKETS_OFF;
}

static void refresh_addresses(void)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        record.address[axis] = low_level_address(axis);
}

static uint32_t rate(void)
{
    return rate_bits_per_s == 0 ? inputs_rate_bits_per_s() : (uint32_t)rate_bits_per_s;
}

/* As the settings say. What waited is forgotten; a record that has begun to leave does so whole. */
static void restart(void)
{
    if (!active && !wanted())
        return;
    active = false; /* from here on the interrupt takes no record */
    trigger_interrupt(false);
    trigger_disable();
    trigger_clear();
    on_main = port == PORT_MAIN;
    present_format = (enum record_format)format;
    present_packets = (enum packets)packets;
    if (!wanted())
        return;
    report_port_set_rate(identity_clock_rate_hz(), rate());
    origin_history_start();
    refresh_addresses();
    record.number = 0;
    missed_before = missed_seen = trigger_missed();
    any_lost = false;
    active = true;
    trigger_enable(present_packets != PACKETS_OFF ? TRIGGER_OUT0 : TRIGGER_IN0, falling != 0, PULSE_FAST);
    trigger_interrupt(true);
}

void ttl_report_begin(void)
{
    selected = true;
    restart();
}

void ttl_report_end(void)
{
    selected = false;
    restart();
}

/* --- Main loop --------------------------------------------------------------------------------- */

static void log_losses(void)
{
    const uint32_t missed = trigger_missed();

    if (missed == missed_seen)
        return;
    missed_seen = missed;
    if (!any_lost || events_now() - lost_fast > SAME_LOSS_FAST)
        log_error(FAULT_REPORT_OVERRUN);
    any_lost = true;
    lost_fast = events_now();
}

/* Whole records, and between two lots of them a reply. */
static void send_on_main(void)
{
    if (!report_is_empty() || ring_used(serial_transmit_ring()) >= MAIN_PORT_BYTES)
        return;
    while (report_free() >= RECORD_BYTES_MAX) {
        if (!next_record()) {
            trigger_interrupt(true);
            return;
        }
        report_bytes(bytes, length);
        sent = length;
    }
}

static void poll(void)
{
    if (!active)
        return;
    log_losses();
    refresh_addresses();
    if (on_main && sent == length)
        send_on_main();
}

static void origin_moved(const struct event *event)
{
    if (active)
        origin_history_note(event->argument);
}

/* --- Rows -------------------------------------------------------------------------------------- */

/* The lines of BUILD X. */
static const char *build_lines[4];

static void name_modules(void)
{
    unsigned n = 0;

    if (port == PORT_REPORT)
        build_lines[n++] = "SERIAL OUT";
    if (format == RECORD_BINARY)
        build_lines[n++] = "BINARY_OUTPUT";
    build_lines[n++] = "TTL_OUT_REPORT";
    build_lines[n] = NULL;
}

static void changed(unsigned axis, double value)
{
    (void)axis;
    (void)value;
    name_modules();
    restart();
}

static enum status check_rate(unsigned axis, double value)
{
    (void)axis;
    return value == 0 || value >= 9600 ? STATUS_OK : STATUS_RANGE;
}

static double get_lost(unsigned axis)
{
    (void)axis;
    return trigger_missed() - missed_before;
}

static const struct command commands[] = {
    {
        .name = "TTLREPORT", .shortcut = "TREP", .form = FORM_P,
        .summary = "Records of positions at pulses: where they go, and of which pulses.",
    },
    {0},
};

static const struct parameter parameters[] = {
    {
        .command = "TTL", .letter = 'M', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = RECORD_FORMATS - 1, .initial = RECORD_BINARY, .value = &format,
        .set = changed, .saved = SAVED_BY_SS,
        .summary = "Records of TTL_REPORT_INT: 0 binary as the original's; 1 a line of text; 2 "
                   "binary with number, time and CRC.",
    },
    {
        .command = "TTLREPORT", .letter = 'X', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = PORTS - 1, .initial = PORT_REPORT, .value = &port,
        .set = changed, .saved = SAVED_BY_SS,
        .summary = "Records go to 0 the report port, 1 the main port, between replies.",
    },
    {
        .command = "TTLREPORT", .letter = 'Y', .type = PARAMETER_INTEGER, .unit = "bit/s",
        .minimum = 0, .maximum = RATE_MAX, .initial = 0, .value = &rate_bits_per_s,
        .check = check_rate, .taken = "0, 9600 ... 2000000", .set = changed, .saved = SAVED_BY_SS,
        .summary = "Rate of the report port; 0: as the main port.",
    },
    {
        .command = "TTLREPORT", .letter = 'Z', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 1, .initial = 0, .value = &falling, .set = changed,
        .saved = SAVED_BY_SS, .summary = "A pulse begins with 0 a rising, 1 a falling edge.",
    },
    {
        .command = "TTLREPORT", .letter = 'F', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = PACKETS_CHOICES - 1, .initial = PACKETS_OFF, .value = &packets,
        .set = changed, .saved = SAVED_BY_SS,
        .summary = "TTL_OUT_REPORT: pulses at OUT0, instead of IN0, send packets of 16-bit words "
                   "with 1 the upper, 2 the lower byte first; 0 off.",
    },
    {
        .command = "TTLREPORT", .letter = 'R', .type = PARAMETER_INTEGER, .unit = "records",
        .minimum = 0, .maximum = UINT32_MAX, .read_only = true, .get = get_lost,
        .saved = SAVED_NEVER,
        .summary = "Records lost for want of room since these settings were made (error 87).",
    },
    {0},
};

static const struct subscription subscriptions[] = {
    {EVENT_ORIGIN_MOVED, EVENT_IN_INTERRUPT, origin_moved},
    {0},
};

const struct module ttl_report_module = {
    .name = "ttl report", .commands = commands, .parameters = parameters,
    .subscriptions = subscriptions, .build_lines = build_lines, .poll = poll,
};
