/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/led_dimmer.h"

#include <math.h>
#include <stddef.h>

#include "core/events.h"
#include "hal/led.h"
#include "modules/pins.h"

#define TTL_MODE 9
#define RATE_MIN_HZ 100
#define RATE_MAX_HZ 200000

/* What is loaded now is in force after so long: a period, and what events_now is behind. */
#define IN_FORCE_FAST (EVENTS_FAST_PER_S / RATE_MIN_HZ + EVENTS_FAST_PER_MS)

static double percent, rate_hz;
static bool selected;         /* TTL Y=9 */
static bool due;              /* modulation or route are not yet as these say */
static bool lit;              /* the modulation, shown or not */
static uint64_t dark_at_fast; /* from then on it is not, if `lit` is false */

static void modulate(double share)
{
    const long period_fast = lround((double)EVENTS_FAST_PER_S / rate_hz);

    led_set((uint32_t)period_fast, (uint32_t)lround(share / 100 * (double)period_fast));
    if (lit && share == 0)
        dark_at_fast = events_now() + IN_FORCE_FAST;
    lit = share > 0;
}

/* Light is shown from its beginning: what another mode cut short has to be over. */
static bool is_dark(void)
{
    if (lit)
        modulate(0);
    return events_now() >= dark_at_fast;
}

/* After the whole line: no light begins with a brightness that was not meant. Another mode takes OUT0
 * away itself, now or in its own poll. */
static void poll(void)
{
    if (!due || !(pins_out0_is_lamp() ? selected : is_dark() || !selected))
        return;
    due = false;
    if (!selected)
        return;
    pins_out0_lamp(percent > 0);
    modulate(percent);
}

void led_dimmer_on(void)
{
    selected = true;
    due = true;
}

void led_dimmer_off(void)
{
    selected = false;
    due = true;
}

static void changed(unsigned axis, double value)
{
    (void)axis;
    (void)value;
    due = true;
}

static void set_percent(unsigned axis, double value)
{
    percent = value;
    changed(axis, value);
}

enum status led_dimmer_check(const struct request *request)
{
    const struct argument *mode = request_argument(request, 'Y');

    if (request_argument(request, LETTER_NUMBER) == NULL)
        return STATUS_OK;
    return mode != NULL && mode->kind == ARGUMENT_VALUE && (int)mode->value == TTL_MODE
               ? STATUS_OK
               : STATUS_UNKNOWN_AXIS;
}

/* What was shown before a RESET may still be under way. */
static void init(void)
{
    lit = true;
    due = true;
}

static const struct command commands[] = {
    {.name = "LED", .form = FORM_L, .summary = "Brightness of a lamp gated by OUT0 (TTL Y=9)."},
    {0},
};

static const struct parameter parameters[] = {
    {
        .command = "LED", .letter = 'X', .type = PARAMETER_REAL, .decimals_max = 3, .unit = "%",
        .minimum = 0, .maximum = 100, .initial = 0, .value = &percent, .set = changed,
        .saved = SAVED_BY_SS,
        .summary = "Share of each period that is light; 0 is dark and 100 without a gap.",
    },
    {
        .command = "LED", .letter = 'R', .type = PARAMETER_REAL, .decimals_max = 3, .unit = "Hz",
        .minimum = RATE_MIN_HZ, .maximum = RATE_MAX_HZ, .initial = 1300, .value = &rate_hz,
        .set = changed, .saved = SAVED_BY_SS,
        .summary = "Frequency of the modulation, to the nearest whole period of 5 ns.",
    },
    /* A number without a letter, in a line with Y=9. */
    {
        .command = "TTL", .letter = LETTER_NUMBER, .type = PARAMETER_REAL, .unit = "%",
        .minimum = 0, .maximum = 100, .set = set_percent, .saved = SAVED_NEVER,
        .summary = "LED X.",
    },
    {0},
};

static const char *const build_lines[] = {"LED DIMMER", NULL};

const struct module led_dimmer_module = {
    .name = "led dimmer", .commands = commands, .parameters = parameters,
    .build_lines = build_lines, .init = init, .poll = poll,
};
