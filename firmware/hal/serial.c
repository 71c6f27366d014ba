/* SPDX-License-Identifier: BSD-2-Clause */
#include "hal/serial.h"

#include "regs.h"

RING_DEFINE(receive, SERIAL_RECEIVE_BYTES);
RING_DEFINE(transmit, SERIAL_TRANSMIT_BYTES);

/* Bytes lost: written by the interrupt only. */
static uint32_t lost;

struct ring *serial_receive_ring(void)
{
    return &receive;
}

struct ring *serial_transmit_ring(void)
{
    return &transmit;
}

void serial_init(uint32_t clock_rate_hz, uint32_t rate_bits_per_s)
{
    ring_clear(&receive);
    ring_clear(&transmit);
    serial_set_rate(clock_rate_hz, rate_bits_per_s);
    serial_interrupt_enable_write(REG_SERIAL_INTERRUPT_ENABLE_RX_READY_MASK);
}

void serial_set_rate(uint32_t clock_rate_hz, uint32_t rate_bits_per_s)
{
    serial_divisor_write((clock_rate_hz + rate_bits_per_s / 2) / rate_bits_per_s);
}

void serial_kick(void)
{
    /* Both sides write whole values, so it does not matter where the interrupt comes in between. */
    serial_interrupt_enable_write(REG_SERIAL_INTERRUPT_ENABLE_RX_READY_MASK |
                                  REG_SERIAL_INTERRUPT_ENABLE_TX_LOW_MASK);
}

static void take_received(void)
{
    uint32_t data = serial_data_read();

    while ((data & REG_SERIAL_DATA_VALID_MASK) != 0) {
        if (!ring_put(&receive, (uint8_t)(data & REG_SERIAL_DATA_BYTE_MASK)))
            lost++;
        data = serial_data_read();
    }
    if ((serial_errors_read() & REG_SERIAL_ERRORS_RX_OVERRUN_MASK) != 0) {
        serial_errors_write(REG_SERIAL_ERRORS_RX_OVERRUN_MASK);
        lost++;
    }
}

static void feed_transmitter(void)
{
    uint8_t byte;

    while (serial_status_tx_ready_get() != 0) {
        if (!ring_take(&transmit, &byte)) {
            serial_interrupt_enable_write(REG_SERIAL_INTERRUPT_ENABLE_RX_READY_MASK);
            return;
        }
        serial_data_write(byte);
    }
}

void serial_interrupt(void)
{
    take_received();
    feed_transmitter();
}

uint32_t serial_lost(void)
{
    return lost;
}

bool serial_is_quiet(void)
{
    return ring_used(&transmit) == 0 && serial_status_tx_idle_get() != 0;
}

void serial_say(const char *text)
{
    while (*text != '\0') {
        if (serial_status_tx_ready_get() != 0)
            serial_data_write((uint8_t)*text++);
    }
    while (serial_status_tx_idle_get() == 0)
        ;
}
