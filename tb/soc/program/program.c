/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * What the SoC does, told over the serial port as lines "name value ..." (hexadecimal).  tb/soc/test_soc.py
 * knows what they should say; this program judges nothing.
 */
#include "regs.h"

enum { CAUSE_INTERRUPT = 0x8000000b, CAUSE_INSTRUCTION_FAULT = 1 };

static volatile uint32_t trap_cause, trap_value, traps;
static volatile uint32_t lines_seen, handled_at, handled;

void program(void);
extern const uint32_t trap_entry;
uint32_t trap(uint32_t cause, uint32_t epc, uint32_t value, uint32_t at, uint32_t ra);

static uint32_t pending_lines(void)
{
    uint32_t lines;
    __asm__ volatile("csrr %0, 0xfc0" : "=r"(lines));
    return lines;
}

static void enable_lines(uint32_t lines)
{
    __asm__ volatile("csrw 0xbc0, %0" : : "r"(lines));
}

static void allow_interrupts(void)
{
    __asm__ volatile("csrs mie, %0\n csrsi mstatus, 8" : : "r"(1 << 11) : "memory");
}

static void forbid_interrupts(void)
{
    __asm__ volatile("csrci mstatus, 8" : : : "memory");
}

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
    for (int digit = 8; digit >= 1; digit--, value >>= 4)
        text[digit] = "0123456789abcdef"[value & 15];
    print(text);
}

static void line1(const char *name, uint32_t a)
{
    print(name), number(a), print("\n");
}

static void line2(const char *name, uint32_t a, uint32_t b)
{
    print(name), number(a), number(b), print("\n");
}

/* Every interrupt: note which line and when, then silence its cause.  A fault: note it and go on behind it. */
uint32_t trap(uint32_t cause, uint32_t epc, uint32_t value, uint32_t at, uint32_t ra)
{
    if (cause != CAUSE_INTERRUPT) {
        trap_cause = cause;
        trap_value = value;
        traps++;
        return cause == CAUSE_INSTRUCTION_FAULT ? ra : epc + 4;
    }
    uint32_t lines = pending_lines();
    lines_seen |= lines;
    handled_at = at;
    if (lines & 1u << INTERRUPT_TICK)
        pwm_interrupt_write(REG_PWM_INTERRUPT_TICK_MASK);
    if (lines & 1u << INTERRUPT_SERIAL)
        serial_interrupt_enable_write(0);
    if (lines & 1u << INTERRUPT_TIMER)
        timer_interrupt_write(1);
#ifdef INTERRUPT_LINE
    if (lines & 1u << INTERRUPT_LINE)
        compare_interrupt_write(REG_COMPARE_INTERRUPT_LATE_MASK | REG_COMPARE_INTERRUPT_STARTED_MASK
                                | REG_COMPARE_INTERRUPT_FINISHED_MASK);
#endif
    if (lines & 1u << INTERRUPT_BUS)
        bus_fault_write(1);
    handled++;
    return epc;
}

static void report_fault(const char *name)
{
    print(name), number(traps), number(trap_cause), number(trap_value), print("\n");
    traps = trap_cause = trap_value = 0;
}

static void identity(void)
{
    line1("magic", identity_magic_read());
    line2("version", identity_map_version_read(), identity_build_id_read());
    line2("clocks", identity_clock_hz_read(), identity_fast_clock_hz_read());
}

static void faults(void)
{
    static const uint32_t loads[] = {0x00008000, 0x00060000, 0x00400000, 0x90000000, 0xfffff7fc, 0xffffe000};
    for (unsigned n = 0; n < sizeof loads / sizeof *loads; n++) {
        (void)mmio_read32(loads[n]);
        report_fault("load");
    }
    (void)*(volatile uint8_t *)REG_IDENTITY_MAGIC;
    report_fault("load byte");
    (void)*(volatile uint16_t *)REG_IDENTITY_MAGIC;
    report_fault("load half");
    ((void (*)(void))0x00400000)();
    report_fault("jump");

    static const uint32_t stores[] = {0x00000000, 0x00400000, 0xfffff7fc};
    enable_lines(1u << INTERRUPT_BUS);
    allow_interrupts();
    for (unsigned n = 0; n < 4; n++) {
        if (n < 3)
            mmio_write32(stores[n], 0xdeadbeef);
        else
            *(volatile uint8_t *)REG_PWM_DUTY0 = 1;
        uint32_t value = mmio_read32(REG_IDENTITY_MAGIC);
        uint32_t address = bus_address_read();
        print("store"), number(handled), number(lines_seen), number(address), number(value), print("\n");
        handled = lines_seen = 0;
    }
    forbid_interrupts();
    line2("boot", mmio_read32(0), pwm_duty_read(0) == 0);
    report_fault("store");
}

static void memory(void)
{
    volatile uint32_t *ram = (uint32_t *)0x00022340;
    volatile uint8_t *bytes = (uint8_t *)ram;
    ram[0] = 0x11223344;
    bytes[1] = 0xaa;
    ((volatile uint16_t *)ram)[1] = 0xbbcc;
    line1("bytes", ram[0]);

    /* Every word of RAM below the stack is its own: write all, then sum what differs. */
    uint32_t differ = 0;
    for (uint32_t a = 0x00028000; a < 0x0005c000; a += 1020)
        mmio_write32(a, a * 2654435761u);
    for (uint32_t a = 0x00028000; a < 0x0005c000; a += 1020)
        differ |= mmio_read32(a) ^ a * 2654435761u;
    line1("ram", differ);

    /* A function copied to RAM runs there: add a0, a0, a0; ret. */
    ram[0] = 0x00a50533;
    ram[1] = 0x00008067;
    __asm__ volatile("fence.i" : : : "memory");
    line1("run", ((uint32_t (*)(uint32_t))ram)(0x1234));
}

static void bus_times(void)
{
    /* 16 loads, then 16 stores, in a row; the second pass runs from the cache. */
    uint32_t start = 0, loaded = 0, stored = 0;
    for (int pass = 0; pass < 2; pass++)
        __asm__ volatile(
            "lui a5, 0xfffff\n lw %0, 0x100(a5)\n"
            ".rept 16\n lw a4, -0x800+0x80(x0)\n .endr\n lw %1, 0x100(a5)\n"
            ".rept 16\n sw x0, -0x800+0x80(x0)\n .endr\n lw %2, 0x100(a5)\n"
            : "=&r"(start), "=&r"(loaded), "=&r"(stored) : : "a4", "a5");
    line2("bus", loaded - start, stored - loaded);
}

/* One alarm after `wait` clocks of `work`; returns clocks from the alarm to the first load of the handler. */
static uint32_t latency(uint32_t wait, void (*work)(uint32_t before))
{
    uint32_t before = handled;
    uint32_t alarm = timer_count_read() + wait;
    timer_alarm_write(alarm);
    timer_control_write(REG_TIMER_CONTROL_ARM_MASK);
    while (handled == before)
        work(before);
    return handled_at - alarm;
}

/*
 * Sleep until `handled` is no longer `before`.  Judged with interrupts forbidden: none can slip in before wfi.
 * The division is still under way when wfi is reached: a clock stopped too early would leave it for later.
 */
static void sleep_while(uint32_t before)
{
    uint32_t dividend = 0x80000001u, divisor = 3;
    while (handled == before) {
        forbid_interrupts();
        if (handled == before)
            __asm__ volatile("divu %0, %0, %1\n wfi" : "+r"(dividend) : "r"(divisor));
        allow_interrupts();
    }
}


static void dividing(uint32_t before)
{
    (void)before;
    uint32_t a = handled | 0x80000001u, b = 3;
    __asm__ volatile("div %0, %0, %1\n div %0, %0, %1\n div %0, %0, %1" : "+r"(a) : "r"(b));
}

/*
 * Addresses that lie a multiple of both caches' size apart share their lines: a return that shares the first line of
 * the handler throws it out with every call, and so do two loads with each other.
 */
static void missing(uint32_t before)
{
    (void)before;
    uint32_t shared = 0x00028000 + (uint32_t)&trap_entry;
    ((void (*)(void))shared)();
    (void)mmio_read32(0x00030000);
    (void)mmio_read32(0x00034000);
}

static void prepare_missing(void)
{
    mmio_write32(0x00028000 + (uint32_t)&trap_entry, 0x00008067); /* ret */
    __asm__ volatile("fence.i" : : : "memory");
}

static void spinning(uint32_t before)
{
    (void)before;
}

static void latencies(void)
{
    static const struct { const char *name; void (*work)(uint32_t before); } works[] = {
        {"latency sleeping", sleep_while}, {"latency spinning", spinning},
        {"latency dividing", dividing}, {"latency missing", missing},
    };
    prepare_missing();
    enable_lines(1u << INTERRUPT_TIMER);
    allow_interrupts();
    for (unsigned n = 0; n < sizeof works / sizeof *works; n++) {
        uint32_t least = UINT32_MAX, most = 0;
        for (uint32_t trial = 0; trial < 50; trial++) {
            uint32_t clocks = latency(300 + 7 * trial, works[n].work);
            least = clocks < least ? clocks : least;
            most = clocks > most ? clocks : most;
        }
        line2(works[n].name, least, most);
    }
    forbid_interrupts();
}

static void each_line(void)
{
    static const uint32_t lines[] = {
        INTERRUPT_TICK, INTERRUPT_SERIAL, INTERRUPT_TIMER,
#ifdef INTERRUPT_LINE
        INTERRUPT_LINE,
#endif
        INTERRUPT_BUS,
    };
    for (unsigned n = 0; n < sizeof lines / sizeof *lines; n++) {
        handled = lines_seen = 0;
        enable_lines(1u << lines[n]);
        allow_interrupts();
        switch (lines[n]) {
        case INTERRUPT_TICK: pwm_tick_divider_write(1); break;
        case INTERRUPT_SERIAL: serial_interrupt_enable_write(REG_SERIAL_INTERRUPT_ENABLE_TX_LOW_MASK); break;
        case INTERRUPT_TIMER: (void)latency(100, spinning); break;
#ifdef INTERRUPT_LINE
        case INTERRUPT_LINE:
            /* Armed on the edge it stands at: late. */
            compare_reference_write(0);
            divider_whole_write(24), divider_pixels_write(1), divider_width_write(2);
            divider_interval_min_write(1000);
            compare_control_write(REG_COMPARE_CONTROL_ARM_MASK);
            break;
#endif
        default: mmio_write32(0, 0); break;
        }
        uint32_t start = timer_count_read();
        while (!handled && timer_count_read() - start < 20000)
            ;
        forbid_interrupts();
        line2("line", lines[n], lines_seen);
    }
    pwm_tick_divider_write(4);
}

/* The serial line is looped back by the bench while its own byte is on it. */
static void echo(void)
{
    while (!serial_status_tx_idle_get())
        ;
    while (serial_status_rx_ready_get())
        (void)serial_data_read();
    print("U");
    while (!serial_status_rx_ready_get())
        ;
    uint32_t first = serial_data_read(), second = serial_data_read();
    line2("echo", first, second);
}

/* Sleep from tick to tick; when each handler ran is a fact that must not depend on how the clock is driven. */
static void ticks(void)
{
    uint32_t last = 0, sum = 0, least = UINT32_MAX, most = 0;
    pwm_interrupt_write(REG_PWM_INTERRUPT_TICK_MASK | REG_PWM_INTERRUPT_OVERRUN_MASK);
    enable_lines(1u << INTERRUPT_TICK);
    allow_interrupts();
    for (uint32_t n = 0; n < 64; n++) {
        uint32_t before = handled;
        sleep_while(before);
        uint32_t period = handled_at - last;
        last = handled_at;
        if (n > 1) { /* the first finds its lines of the caches not loaded */
            least = period < least ? period : least;
            most = period > most ? period : most;
        }
        sum = (sum << 1 | sum >> 31) + handled_at;
        /* Work of varying length between the ticks. */
        for (uint32_t work = 0; work < (n & 7) * 8; work++)
            dividing(before);
    }
    forbid_interrupts();
    line2("ticks", least, most);
    line2("overrun", pwm_interrupt_overrun_get(), sum);
}

void program(void)
{
    serial_divisor_write(8);
    identity();
    faults();
    memory();
    bus_times();
    latencies();
    each_line();
    echo();
    ticks();
    enable_lines(0);
    print("end\n");
}
