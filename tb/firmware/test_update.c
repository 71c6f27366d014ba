/* SPDX-License-Identifier: BSD-2-Clause */
/* modules/update: the request for an update, and when an image confirms itself. */
#include "modules/update.h"

#include "boot/handover.h"
#include "boot/slot.h"
#include "check.h"
#include "host/mmio.h"
#include "nor_flash.h"
#include "regs.h"

#define SECOND 50000000u

/* Started from slot 1, at time 0. */
static void start(uint32_t scratch)
{
    mmio_model_reset();
    mmio_model_set(REG_IDENTITY_CLOCK_HZ, SECOND);
    mmio_model_set(REG_WATCHDOG_SCRATCH, scratch);
    update_module.init();
}

static void turn_at(uint64_t cycles)
{
    mmio_model_set(REG_TIMER_LATCHED_LOW, (uint32_t)cycles);
    mmio_model_set(REG_TIMER_LATCHED_HIGH, (uint32_t)(cycles >> 32));
    update_module.poll();
}

TEST(confirms_itself_after_ten_seconds)
{
    nor_flash_reset();
    slot_select(0, true);
    slot_select(1, false);
    slot_mark_tried(1);
    start(handover_started(1, 1));
    turn_at(10ull * SECOND - 1);
    CHECK_INT(slot_read(1).state, SLOT_TRIED);
    update_module.init(); /* RESET */
    turn_at(10ull * SECOND);
    CHECK_INT(slot_read(1).state, SLOT_CONFIRMED);
}

/* A slot that was tried before, and is not the one that runs, stays what it is. */
TEST(confirms_no_other)
{
    nor_flash_reset();
    slot_select(0, true);
    slot_select(1, false);
    slot_mark_tried(1);
    start(handover_started(1, 0));
    turn_at(11ull * SECOND);
    CHECK_INT(slot_read(1).state, SLOT_TRIED);
    start(handover_started(1, SLOT_NONE));
    turn_at(11ull * SECOND);
    start(0);
    turn_at(11ull * SECOND);
    CHECK_INT(slot_read(1).state, SLOT_TRIED);
}

TEST(kicks_the_watchdog_each_turn)
{
    start(0);
    CHECK_INT(mmio_model_get(REG_WATCHDOG_KICK), 0);
    turn_at(0);
    CHECK_INT(mmio_model_get(REG_WATCHDOG_KICK), WATCHDOG_KICK_WORD);
}

TEST(asks_for_an_update_and_says_which_slot_ran)
{
    const struct parameter *row = update_module.parameters;

    start(handover_started(3, 1));
    CHECK_INT(update_boot_version(), 3);
    CHECK(!update_is_wanted());
    row->set(0, 1);
    CHECK(update_is_wanted());
    update_enter();
    CHECK(!update_is_wanted());
    CHECK_INT(mmio_model_get(REG_WATCHDOG_RESET), WATCHDOG_RESET_WORD);
    CHECK(handover_is_update(mmio_model_get(REG_WATCHDOG_SCRATCH)));
    CHECK_INT(handover_slot(mmio_model_get(REG_WATCHDOG_SCRATCH)), 1);
    CHECK_INT(update_boot_version(), 0);
}

TEST_MAIN(RUN(confirms_itself_after_ten_seconds); RUN(confirms_no_other); RUN(kicks_the_watchdog_each_turn);
          RUN(asks_for_an_update_and_says_which_slot_ran))
