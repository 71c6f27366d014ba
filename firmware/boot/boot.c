/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The boot program: drives off, then the application that is to be started, or else the update server on the main port.
 *
 * It lives in a memory of its own that the application cannot write, uses nothing of the application's, and keeps its data
 * and stack in the last 16 KiB of RAM, which the application has when it runs. The rules are in docs/boot.md.
 */
#include <stdint.h>

#include "boot/boot.h"
#include "boot/frame.h"
#include "boot/handover.h"
#include "boot/smp.h"
#include "boot/start.h"
#include "hal/buttons.h"
#include "hal/identity.h"
#include "hal/pwm.h"
#include "hal/watchdog.h"
#include "regs.h"

enum {
    RATE_BITS_PER_S = 115200, /* whatever the switches say: an update must find the port */
    START_MS = 2000,          /* an image from a slot has to kick the watchdog by then, and goes on to */
    DEBOUNCE_MS = 12,
};

static uint8_t *const application = (uint8_t *)(uintptr_t)IMAGE_RAM;

static void put(uint8_t byte)
{
    while (serial_status_tx_ready_get() == 0)
        ;
    serial_data_write(byte);
}

static void wait_sent(void)
{
    while (serial_status_tx_idle_get() == 0)
        ;
}

static void say(const char *text)
{
    while (*text != '\0')
        put((uint8_t)*text++);
}

/* Also what ran before a reset of the processor alone has driven. */
static void stop_drives(void)
{
    pwm_enable(0);
    pwm_set_steps((const int32_t[PWM_AXES]){0});
}

static void run_application(int slot)
{
    watchdog_set_scratch(handover_started(BOOT_VERSION, slot));
    boot_run(IMAGE_RAM + IMAGE_HEADER_BYTES);
}

/* Start what there is to start; returns when there is nothing. */
static void start(bool has_flash)
{
    const bool cold = watchdog_cold();
    struct image image;
    const int slot = has_flash ? start_load(application, &image) : SLOT_NONE;

    flash_lock();
    watchdog_set_warm();
    if (slot != SLOT_NONE) {
        watchdog_start(START_MS);
        run_application(slot);
    }
    /* What came with the bitstream is as good as this program, as long as nothing has run. */
    if (cold && image_is_application(application))
        run_application(SLOT_NONE);
}

static void serve(int running)
{
    static struct frame frame;
    static uint8_t response[FRAME_PACKET_BYTES];

    flash_lock();
    watchdog_set_warm();
    smp_init(application, running);
    while (!smp_reset_wanted()) {
        const uint32_t data = serial_data_read();
        const uint8_t *packet;
        size_t size = 0;

        if ((data & REG_SERIAL_DATA_VALID_MASK) != 0)
            size = frame_take(&frame, (uint8_t)(data & REG_SERIAL_DATA_BYTE_MASK), &packet);
        if (size != 0)
            size = smp_handle(packet, size, response, sizeof response);
        if (size != 0)
            frame_send(response, size, put);
    }
    wait_sent();
    watchdog_reset_processor();
}

/* @ held: its debounced level needs time only when the pin is pressed now. */
static bool button_held(void)
{
    const uint32_t begin = timer_count_read();

    while ((buttons_levels_pins_get() >> BUTTON_AT & 1u) != 0)
        if (timer_count_read() - begin > DEBOUNCE_MS * (CLOCK_HZ / 1000u))
            return buttons_pressed(BUTTON_AT);
    return false;
}

void boot_main(void)
{
    const uint32_t word = watchdog_scratch();
    bool has_flash;

    if (!identity_is_known()) {
        say("Abbe boot: unknown gateware\r\n");
        for (;;)
            ;
    }
    stop_drives();
    watchdog_set_scratch(0);
    serial_interrupt_enable_write(0);
    serial_divisor_write((CLOCK_HZ + RATE_BITS_PER_S / 2) / RATE_BITS_PER_S);
    has_flash = flash_present(); /* the update server needs it awake as well */
    if (!handover_is_update(word) && !(watchdog_cold() && button_held()))
        start(has_flash);
    serve(handover_is_update(word) ? handover_slot(word) : SLOT_NONE);
    for (;;)
        ;
}

void boot_trap(void)
{
    watchdog_reset_processor();
    for (;;)
        ;
}
