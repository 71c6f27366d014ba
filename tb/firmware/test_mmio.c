/* SPDX-License-Identifier: BSD-2-Clause */
/* The host's stand-in for registers and interrupts. */
#include "host/interrupts.h"
#include "host/mmio.h"

#include "check.h"
#include "hal/interrupts.h"
#include "hal/mmio.h"

static uintptr_t last_address;
static uint32_t last_value;

static uint32_t read_hook(void *context, uintptr_t address)
{
    last_address = address;
    return *(uint32_t *)context;
}

static void write_hook(void *context, uintptr_t address, uint32_t value)
{
    (void)context;
    last_address = address;
    last_value = value;
}

TEST(registers_without_a_hook_are_memory)
{
    mmio_model_reset();
    CHECK_INT(mmio_read32(0xFFFFF000u), 0);
    mmio_write32(0xFFFFF000u, 5);
    mmio_write32(0xFFFFFFFCu, 6);
    CHECK_INT(mmio_read32(0xFFFFF000u), 5);
    CHECK_INT(mmio_model_get(0xFFFFFFFCu), 6);
}

TEST(hooks_see_accesses_in_their_range)
{
    uint32_t answer = 77;

    mmio_model_reset();
    mmio_model_hook((struct mmio_hook){0xFFFFF100u, 0xFFFFF104u, read_hook, write_hook, &answer});
    CHECK_INT(mmio_read32(0xFFFFF104u), 77);
    CHECK_INT(last_address, 0xFFFFF104u);
    mmio_write32(0xFFFFF100u, 9);
    CHECK_INT(last_value, 9);
    CHECK_INT(mmio_model_get(0xFFFFF100u), 0);
    CHECK_INT(mmio_read32(0xFFFFF108u), 0);
    mmio_model_hook((struct mmio_hook){0xFFFFF104u, 0xFFFFF104u, NULL, write_hook, NULL});
    CHECK_INT(mmio_read32(0xFFFFF104u), 0); /* the later hook wins, and leaves reads alone */
}

static unsigned served, slept;

static void dispatch(void)
{
    served |= interrupts_pending();
    host_interrupts_set(0);
}

static void wait(void)
{
    slept++;
    host_interrupts_set(6);
}

static bool busy(void)
{
    return true;
}

static bool idle(void)
{
    return false;
}

TEST(enabled_interrupts_are_served_while_sleeping)
{
    host_interrupts_dispatch(dispatch);
    host_interrupts_on_sleep(wait);
    interrupts_enable(2);
    interrupts_sleep_unless(busy);
    CHECK_INT(slept, 0);
    CHECK_INT(served, 0);
    interrupts_sleep_unless(idle);
    CHECK_INT(slept, 1);
    CHECK_INT(served, 2);
}

TEST_MAIN(RUN(registers_without_a_hook_are_memory); RUN(hooks_see_accesses_in_their_range);
          RUN(enabled_interrupts_are_served_while_sleeping))
