/* SPDX-License-Identifier: BSD-2-Clause */
/** The report port: sends only; its user keeps the bytes, and asks for room. */
#ifndef HAL_REPORT_PORT_H
#define HAL_REPORT_PORT_H

#include <stdbool.h>
#include <stdint.h>

/** Change the bit rate (8N1), while nothing is being sent. */
void report_port_set_rate(uint32_t clock_rate_hz, uint32_t rate_bits_per_s);

/** Bytes that can be sent now, at least; 0: none. */
unsigned report_port_room(void);

/** Send a byte, for which there is room. */
void report_port_send(uint8_t byte);

/** Interrupt while half of the port's FIFO is free. */
void report_port_interrupt(bool enable);

#endif
