/* SPDX-License-Identifier: BSD-2-Clause */
#include "hal/report_port.h"

#include "regs.h"

void report_port_set_rate(uint32_t clock_rate_hz, uint32_t rate_bits_per_s)
{
    report_divisor_write((clock_rate_hz + rate_bits_per_s / 2) / rate_bits_per_s);
}

unsigned report_port_room(void)
{
    const uint32_t status = report_status_read();

    if ((status & REG_REPORT_STATUS_TX_LOW_MASK) != 0)
        return SERIAL_FIFO_BYTES / 2;
    return (status & REG_REPORT_STATUS_TX_READY_MASK) != 0 ? 1 : 0;
}

void report_port_send(uint8_t byte)
{
    report_data_write(byte);
}

void report_port_interrupt(bool enable)
{
    report_interrupt_enable_write(enable ? REG_REPORT_INTERRUPT_ENABLE_TX_LOW_MASK : 0);
}
