/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The whole firmware on the host, all modules, over memory for registers and a frictionless stage:
 * enough for what the language says. How well it moves is tested on the board model, not here.
 */
#ifndef TB_FIRMWARE_MACHINE_H
#define TB_FIRMWARE_MACHINE_H

#include <stdbool.h>
#include <stddef.h>

/** Power up: registers 0, stage at 0, settings at their initial values. */
void machine_start(void);

/** Send a line, CR added, and run until its reply is complete. */
const char *machine_send(const char *line);

/** The same for any bytes; what came out. */
const char *machine_bytes(const void *bytes, size_t length);

/** Let time pass, in steps of 200 us: servo ticks, then a turn of the main loop. */
void machine_run(unsigned ticks);

/** Run until STATUS says N. False: not within ten seconds. */
bool machine_wait(void);

/** Where an axis is told to be, user units: the answer to MOVE's query. */
double machine_target(char axis);

/** To be used with check.h and math.h. */
#define CHECK_TARGET(axis, user)                                                                   \
    do {                                                                                           \
        double check_t = machine_target(axis);                                                     \
        if (fabs(check_t - (user)) > 2)                                                            \
            CHECK_FAIL("%c goes to %g, not %g", axis, check_t, (double)(user));                    \
    } while (0)

#endif
