/* SPDX-License-Identifier: BSD-2-Clause */
/** A console on two rings, for tests: send text, get the reply as it would leave the port. */
#ifndef TB_FIRMWARE_PORT_H
#define TB_FIRMWARE_PORT_H

#include <stddef.h>

#include "core/console.h"

struct module;

/** Start the core afresh over these modules: settings at their initial values, empty queues. */
void port_start(const struct module *const *modules);

/** Bytes in, one turn of the main loop after each; returns what came out, zero-ended. */
const char *port_bytes(const void *bytes, size_t length);

/** A line, CR added (dialect.h); returns everything that came out until the console was idle again. */
const char *port_send(const char *line);

/** The same for text that is sent as it is. */
const char *port_text(const char *text);

/** Turns of the main loop until idle; what came out. */
const char *port_drain(void);

/** Put bytes into the receive ring without a turn of the main loop. */
void port_queue(const char *text);

/** From now on the port takes bytes only in port_take. Ends with port_start. */
void port_hold(void);
/** One turn of the main loop, then take up to `count` bytes from the port. */
const char *port_take(size_t count);

extern struct console port_console;

#endif
