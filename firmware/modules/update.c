/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/update.h"

#include <stddef.h>
#include <stdint.h>

#include "boot/handover.h"
#include "boot/slot.h"
#include "hal/identity.h"
#include "hal/timer.h"
#include "hal/watchdog.h"

static bool wanted;
static double wanted_value;

/* An image of a slot that waits for its confirmation, and when that is due. */
static bool unconfirmed;
static uint64_t confirm_at_cycles;

static void ask(unsigned axis, double value)
{
    (void)axis;
    wanted = value != 0;
}

bool update_is_wanted(void)
{
    return wanted;
}

void update_enter(void)
{
    wanted = false;
    wanted_value = 0;
    watchdog_set_scratch(handover_update(watchdog_scratch()));
    watchdog_reset_processor();
}

unsigned update_boot_version(void)
{
    const uint32_t word = watchdog_scratch();

    return handover_is_started(word) ? handover_boot_version(word) : 0;
}

static void init(void)
{
    const uint32_t word = watchdog_scratch();

    /* A RESET does not make it older. */
    if (unconfirmed)
        return;
    unconfirmed = handover_is_started(word) && handover_slot(word) >= 0 && handover_slot(word) < SLOT_COUNT &&
                  slot_read(handover_slot(word)).state == SLOT_TRIED;
    confirm_at_cycles = timer_time_cycles() + (uint64_t)UPDATE_CONFIRM_S * identity_clock_rate_hz();
}

static void poll(void)
{
    watchdog_kick();
    if (!unconfirmed || timer_time_cycles() < confirm_at_cycles)
        return;
    unconfirmed = false;
    /* If it cannot be written the next start reverts, which is the safe side. */
    (void)slot_confirm(handover_slot(watchdog_scratch()));
}

static const struct parameter parameters[] = {
    {
        .command = "BUILD", .letter = 'R', .type = PARAMETER_INTEGER, .unit = "", .minimum = 0, .maximum = 1,
        .initial = 0, .value = &wanted_value, .set = ask, .saved = SAVED_NEVER,
        .summary = "1: drives off, and the boot loader takes updates by SMP on this port, at 115200 bits per second.",
    },
    {0},
};

const struct module update_module = {
    .name = "update", .parameters = parameters, .init = init, .poll = poll,
};
