/* SPDX-License-Identifier: BSD-2-Clause */
/* The target's; empty in the host build. CSRs 0xbc0 (mask) and 0xfc0 (pending, in the header) are VexRiscv's. */
#include "hal/interrupts.h"

#include "regs.h"

_Static_assert(INTERRUPTS_TICK == 1 << INTERRUPT_TICK && INTERRUPTS_SERIAL == 1 << INTERRUPT_SERIAL &&
                   INTERRUPTS_TIMER == 1 << INTERRUPT_TIMER &&
                   INTERRUPTS_LINE == 1 << INTERRUPT_LINE && INTERRUPTS_BUS == 1 << INTERRUPT_BUS &&
                   INTERRUPTS_REPORT == 1 << INTERRUPT_REPORT &&
                   INTERRUPTS_TRIGGER == 1 << INTERRUPT_TRIGGER,
               "interrupt lines");

#ifdef __riscv

#define MSTATUS_MIE 8u
#define MIE_MEIE 0x800u

void interrupts_enable(uint32_t lines)
{
    __asm__ volatile("csrw 0xbc0, %0" : : "r"(lines) : "memory");
    __asm__ volatile("csrs mie, %0" : : "r"(MIE_MEIE) : "memory");
    __asm__ volatile("csrs mstatus, %0" : : "r"(MSTATUS_MIE) : "memory");
}

void interrupts_sleep_unless(bool (*busy)(void))
{
    /* wfi wakes on an enabled line whatever mstatus says (execute_CsrPlugin_wfiWake in the netlist
     * looks at mip and mie only), so an interrupt between here and wfi is not slept through. */
    __asm__ volatile("csrc mstatus, %0" : : "r"(MSTATUS_MIE) : "memory");
    if (!busy())
        __asm__ volatile("wfi" : : : "memory");
    __asm__ volatile("csrs mstatus, %0" : : "r"(MSTATUS_MIE) : "memory");
}

#endif
