/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/inputs.h"

#include <stddef.h>

#include "hal/adc.h"
#include "hal/identity.h"
#include "hal/inputs.h"
#include "hal/serial.h"
#include "hal/snapshot.h"
#include "hal/timer.h"
#include "modules/axis.h"
#include "modules/coordinates.h"

/* `fast` clocks in one of the timer's. */
#define FAST_PER_CYCLE 4u

/* RDADC shows 8 bits of a channel. */
#define RDADC_SHIFT 4u

uint64_t inputs_time_fast(uint32_t at_cycles)
{
    const uint32_t age_cycles = timer_now_cycles() - at_cycles;
    struct snapshot now;

    snapshot_now(&now);
    return now.time_fast - (uint64_t)age_cycles * FAST_PER_CYCLE;
}

/* --- Edges ------------------------------------------------------------------------------------ */

static void publish(enum event_name name, enum inputs_ttl pin, void (*rose)(void))
{
    struct inputs_edges edges;
    uint64_t time_fast;

    if (!inputs_take_edges(pin, &edges, rose))
        return;
    time_fast = inputs_time_fast(edges.at_cycles);
    /* Both: a pulse that ended where it began. Its first edge is stamped like its last. */
    if (edges.rose && edges.fell)
        events_publish(name, !edges.level, time_fast);
    events_publish(name, edges.level, time_fast);
}

static void poll(void)
{
    publish(EVENT_TRIGGER_IN, INPUTS_IN0, axis_trigger_notice);
    publish(EVENT_IN1, INPUTS_IN1, NULL);
}

/* --- Analog inputs ---------------------------------------------------------------------------- */

static enum status rdadc(const struct request *request, struct reply *reply)
{
    static const char letters[] = "XYZF";

    reply_text(reply, ":A");
    for (unsigned channel = 0; letters[channel] != '\0'; channel++)
        if (request_argument(request, letters[channel]) != NULL) {
            reply_char(reply, ' ');
            reply_integer(reply, (int32_t)(adc_read(channel) >> RDADC_SHIFT));
        }
    return STATUS_OK;
}

/* --- DIP switches ----------------------------------------------------------------------------- */

enum { DIP_RATE = 3, DIP_Y_REVERSED = 4, DIP_X_REVERSED = 8, DIP_ALL = 15 };
enum { AXIS_X, AXIS_Y };

static double stop_bits; /* rtl/serial.py sends one */

/* What is used instead of the switches, or -1; before the settings are loaded, too. */
static double dip_setting = -1;

static unsigned dip(void)
{
    return dip_setting >= 0 ? (unsigned)dip_setting : inputs_dip();
}

/* Switches 4 and 5, off and on: off off, on off, off on, on on. The original calls off DOWN. */
uint32_t inputs_rate_bits_per_s(void)
{
    static const uint32_t rates[] = {115200, 28800, 19200, 9600};

    return rates[dip() & DIP_RATE];
}

static double get_dip(unsigned axis)
{
    (void)axis;
    return inputs_dip();
}

/* The directions at once, before anything is converted with them. */
static void set_dip(unsigned axis, double value)
{
    const unsigned switches = dip();

    (void)axis;
    (void)value;
    coordinates_reverse(AXIS_X, (switches & DIP_X_REVERSED) != 0);
    if (AXIS_COUNT > AXIS_Y)
        coordinates_reverse(AXIS_Y, (switches & DIP_Y_REVERSED) != 0);
}

static void init(void)
{
    struct inputs_edges edges;

    for (unsigned pin = 0; pin < INPUTS_TTL_COUNT; pin++)
        (void)inputs_take_edges((enum inputs_ttl)pin, &edges, NULL);
    adc_enable();
    serial_set_rate(identity_clock_rate_hz(), inputs_rate_bits_per_s());
}

static const struct command commands[] = {
    {.name = "RDADC", .shortcut = "RA", .summary = "Analog inputs, 0 to 255.", .run = rdadc,
     .accepts = ARGUMENT_BARE | ARGUMENT_QUERY, .letters = "XYZF",
     .flags = COMMAND_NEEDS_ARGUMENT},
    {.name = "STOPBITS", .shortcut = "SB", .form = FORM_P,
     .summary = "Stop bits of the serial port; it takes two as well as one."},
    {.name = "DIP", .form = FORM_P, .summary = "DIP switches, and what is used instead of them."},
    {0},
};

static const struct parameter parameters[] = {
    {
        .command = "DIP", .letter = 'X', .type = PARAMETER_INTEGER, .unit = "bits",
        .minimum = 0, .maximum = DIP_ALL, .read_only = true, .get = get_dip,
        .saved = SAVED_NEVER,
        .summary = "The switches that are on: 1 for switch 4, 2 for 5, 4 for 7, 8 for 8.",
    },
    {
        .command = "DIP", .letter = 'Y', .type = PARAMETER_INTEGER, .unit = "bits",
        .minimum = -1, .maximum = DIP_ALL, .initial = -1, .value = &dip_setting,
        .set = set_dip, .saved = SAVED_BY_SS,
        .summary = "Used instead of the switches, as X; -1: they are used. 4 reverses Y, 8 "
                   "reverses X; 1 and 2 set the rate of the serial port from the next start on: "
                   "none 115200, 1 28800, 2 19200, both 9600.",
    },
    {
        .command = "STOPBITS", .letter = 'X', .type = PARAMETER_INTEGER,
        .summary = "Stop bits sent: 1.", .minimum = 1, .maximum = 1, .initial = 1,
        .value = &stop_bits, .saved = SAVED_NEVER,
    },
    {0},
};

const struct module inputs_module = {
    .name = "inputs",
    .commands = commands,
    .parameters = parameters,
    .init = init,
    .poll = poll,
};
