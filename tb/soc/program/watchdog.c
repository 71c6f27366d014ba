/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Hangs in several ways, each time that the watchdog lets it start anew; Scratch counts the starts. Says over the
 * serial port what it finds (hexadecimal); tb/soc/test_watchdog.py knows what it should be.
 */
#include "regs.h"

enum { MARK = 0x0123 };

void program(void);
uint32_t trap(uint32_t cause, uint32_t epc, uint32_t value, uint32_t at, uint32_t ra);

static void print(const char *text)
{
    for (; *text; text++) {
        while (!serial_status_tx_ready_get())
            ;
        serial_data_write((uint8_t)*text);
    }
}

static void number(uint32_t value)
{
    char text[] = " 00000000";
    for (int n = 0; n < 8; n++)
        text[8 - n] = "0123456789abcdef"[value >> 4 * n & 15];
    print(text);
}

uint32_t trap(uint32_t cause, uint32_t epc, uint32_t value, uint32_t at, uint32_t ra)
{
    (void)value, (void)at, (void)ra;
    print("trap"), number(cause), number(epc), print("\n");
    return epc;
}

/* Everything on both buses, without end: lines of both caches are fetched and registers stored and loaded. */
static void traffic(void)
{
    static const uint32_t ret = 0x00008067;
    mmio_write32(0x00028000, ret);
    mmio_write32(0x00030000, ret);
    __asm__ volatile("fence.i" : : : "memory");
    for (uint32_t n = 0;; n++) {
        ((void (*)(void))0x00028000)();
        ((void (*)(void))0x00030000)();
        (void)mmio_read32(0x00038000 + 32 * (n & 1023));
        pwm_duty_write(1, (int32_t)(n & 1023));
        (void)timer_count_read();
        mmio_write32(0x00040000 + 16 * (n & 1023), n);
    }
}

static void hang(uint32_t way)
{
    switch (way) {
    case 1:
        for (;;)
            ;
    case 2: /* asleep, and nothing is to wake it */
        for (;;)
            __asm__ volatile("wfi");
    case 3: /* traps in its trap, for ever */
        __asm__ volatile("csrw mtvec, %0\n .word 0" : : "r"(0x00400000));
        break;
    case 4: watchdog_reset_write(WATCHDOG_RESET_WORD); break;
    default: traffic();
    }
    for (;;)
        ;
}

void program(void)
{
    serial_divisor_write(8);
    const uint32_t starts = watchdog_scratch_read();
    print("start"), number(starts), number(watchdog_status_read()), number((uint32_t)pwm_duty_read(0));
    number(watchdog_timeout_read()), number(interlock_faults_read()), print("\n");
    while (!serial_status_tx_idle_get())
        ;
    watchdog_scratch_write(starts + 1);
    watchdog_status_write(REG_WATCHDOG_STATUS_COLD_MASK);
    pwm_duty_write(0, MARK);
    pwm_control_write(1);
    interlock_clear_write(~0u);
    /* The moment at which it hits the traffic is another each time. */
    watchdog_timeout_write(3000 + 37 * starts);
    watchdog_control_write(REG_WATCHDOG_CONTROL_ENABLE_MASK);
    for (unsigned n = 0; n < 20; n++) {
        const uint32_t now = timer_count_read();
        watchdog_kick_write(WATCHDOG_KICK_WORD);
        while (timer_count_read() - now < 1000)
            ;
    }
    hang(starts + 1);
}
