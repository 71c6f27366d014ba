/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/application.h"

#include <stddef.h>

#include "core/action.h"
#include "core/console.h"
#include "core/events.h"
#include "core/fault.h"
#include "core/settings.h"
#include "hal/flash.h"
#include "hal/identity.h"
#include "hal/interrupts.h"
#include "hal/serial.h"
#include "hal/timer.h"
#include "hal/watchdog.h"
#include "modules/axis.h"
#include "modules/coordinates.h"
#include "modules/inputs.h"
#include "modules/modules.h"
#include "modules/save_positions.h"
#include "modules/ttl_report.h"
#include "modules/update.h"
#include "store/settings_flash.h"

static const uint32_t RECORD_LINES = INTERRUPTS_REPORT | INTERRUPTS_TRIGGER;
static const uint32_t LINES = INTERRUPTS_TICK | INTERRUPTS_SERIAL | INTERRUPTS_TIMER |
                              INTERRUPTS_BUS | RECORD_LINES;

/* Ticks between two turns of the main loop that nothing else asks for: a millisecond. */
#define TICKS_PER_TURN (1000u / AXIS_TICK_US)

/* The interrupt kicks the watchdog every tick, as long as the main loop comes round; a hung interrupt leaves a
 * drive on for as long as the first, a hung main loop has one that regulates. */
#define WATCHDOG_MS 50u
#define TURN_TICKS_MOST (1000000u / AXIS_TICK_US)

static struct console console;
static bool reset_wanted;
static uint32_t lost_seen; /* bytes that came in and found no room */

/* Another turn of the main loop is due. Set by the interrupts, cleared by the main loop. */
static volatile bool turn_due;

/* Ticks since the main loop came round. Cleared by the main loop. */
static volatile uint32_t turn_ticks;

/* Of the interrupt. */
static uint32_t ticks_to_turn;

/* Put everything in its state after power-up: axes at rest at 0, saved settings. */
static void start(bool power_up)
{
    axis_init();
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        struct axis_view view;

        axis_read(axis, &view);
        coordinates_set_origin(axis, view.position_counts);
    }
    if (power_up)
        save_positions_restore();
    settings_load();
    /* A RESET moves the 0 and may bring back another scale, but none of the places. */
    if (!power_up)
        (void)save_positions_keep_places();
    for (const struct module *const *module = firmware_modules; *module != NULL; module++)
        if ((*module)->init != NULL)
            (*module)->init();
    reset_wanted = false;
    application_alive();
    interrupts_enable(LINES);
}

/*
 * A turn of the main loop while the flash is busy, for up to 400 ms: nothing waits for it but what is being kept.
 * Ends with the next interrupt.
 */
static void turn_while_flash_is_busy(void)
{
    application_alive();
    if (application_busy())
        application_poll();
    interrupts_sleep_unless(application_busy);
}

void application_alive(void)
{
    turn_ticks = 0;
}

bool application_init(void)
{
    if (!identity_is_known()) {
        serial_say("Abbe: unknown gateware, not started\r\n");
        return false;
    }
    events_set_clock(axis_time_fast);
    action_init(firmware_claims);
    if (!command_init(firmware_modules) || !events_init(firmware_modules)) {
        serial_say("Abbe: too many rows or event hooks, not started\r\n");
        return false;
    }
    if (flash_present())
        settings_init(settings_flash());
    serial_init(identity_clock_rate_hz(), inputs_rate_bits_per_s());
    console_init(&console, serial_receive_ring(), serial_transmit_ring(), serial_kick);
    watchdog_start(WATCHDOG_MS);
    start(true);
    flash_on_wait(turn_while_flash_is_busy);
    return true;
}

static void serve_port(void)
{
    if (save_positions_is_down())
        (void)console_finish(&console);
    else if (!reset_wanted && !update_is_wanted())
        console_poll(&console);
}

void application_poll(void)
{
    turn_due = false;
    application_alive();
    if (serial_lost() != lost_seen) {
        lost_seen = serial_lost();
        log_error(FAULT_OVERTIME);
    }
    serve_port();
    fault_poll();
    events_poll();
    for (const struct module *const *module = firmware_modules; *module != NULL; module++) {
        if ((*module)->poll == NULL)
            continue;
        (*module)->poll();
        /* The port does not wait for all of them. */
        if (console_due(&console))
            serve_port();
    }

    /* The acknowledge leaves first. Lines behind it are carried out after the reset. */
    if (reset_wanted && !settings_pending() && console_finish(&console) && serial_is_quiet()) {
        interrupts_enable(0);
        start(false);
    }
    settings_poll();
    if (update_is_wanted() && console_finish(&console) && serial_is_quiet())
        update_enter();
}

bool application_busy(void)
{
    return turn_due || !console_idle(&console);
}

void application_interrupt(void)
{
    uint32_t lines = interrupts_pending();

    /* The tick first: the duty it computes is taken at the next PWM period. */
    if ((lines & INTERRUPTS_TICK) != 0) {
        axis_tick();
        if (turn_ticks < TURN_TICKS_MOST) {
            turn_ticks = turn_ticks + 1;
            watchdog_kick();
        }
        if (ticks_to_turn-- == 0) {
            ticks_to_turn = TICKS_PER_TURN - 1;
            turn_due = true;
        }
    }
    if ((lines & RECORD_LINES) != 0 && ttl_report_interrupt())
        turn_due = true;
    if ((lines & ~(INTERRUPTS_TICK | RECORD_LINES)) == 0)
        return;
    turn_due = true;
    if ((lines & INTERRUPTS_SERIAL) != 0)
        serial_interrupt();
    if ((lines & INTERRUPTS_TIMER) != 0)
        timer_acknowledge();
}

static enum status reset(const struct request *request, struct reply *reply)
{
    (void)request;
    (void)reply;
    reset_wanted = true;
    return STATUS_OK;
}

static void reset_asked(const struct event *event)
{
    (void)event;
    reset_wanted = true;
}

static const struct command commands[] = {
    {
        .name = "RESET", .shortcut = "~", .summary = "Saved settings, and all positions 0.",
        .run = reset, .accepts = ARGUMENT_BARE, .letters = LETTERS_ALL,
    },
    {0},
};

static const struct subscription subscriptions[] = {
    {EVENT_RESET, EVENT_IN_MAIN, reset_asked},
    {0},
};

const struct module application_module = {
    .name = "application",
    .commands = commands,
    .subscriptions = subscriptions,
};
