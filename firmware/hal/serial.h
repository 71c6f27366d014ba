/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The main serial port, behind two byte rings.
 *
 * The interrupt is the one producer of the receive ring and the one consumer of the transmit ring;
 * the main loop is the other side of both.
 */
#ifndef HAL_SERIAL_H
#define HAL_SERIAL_H

#include <stdbool.h>
#include <stdint.h>

#include "core/ring.h"

enum { SERIAL_RECEIVE_BYTES = 1024, SERIAL_TRANSMIT_BYTES = 1024 };

struct ring *serial_receive_ring(void);
struct ring *serial_transmit_ring(void);

/** Set the bit rate (8N1) and let the receiver interrupt. */
void serial_init(uint32_t clock_rate_hz, uint32_t rate_bits_per_s);

/** Change the bit rate, while nothing is being sent. */
void serial_set_rate(uint32_t clock_rate_hz, uint32_t rate_bits_per_s);

/** Call after bytes were put into the transmit ring. */
void serial_kick(void);

/** The serial interrupt: moves bytes between the port and the rings. */
void serial_interrupt(void);

/** Received bytes that were lost since the start, in the port or for want of room in the ring. */
uint32_t serial_lost(void);

/** Everything sent has left the pin, stop bit included. */
bool serial_is_quiet(void);

/** Send a text without interrupts and rings, waiting for it. Start-up and fatal errors only. */
void serial_say(const char *text);

#endif
