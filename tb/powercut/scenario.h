/* SPDX-License-Identifier: BSD-2-Clause */
/** Things a controller does to its flash, for powercut.c. Each function is run in a process of its own, on a chip (chip.h). */
#ifndef TB_POWERCUT_SCENARIO_H
#define TB_POWERCUT_SCENARIO_H

#include <stdbool.h>
#include <stddef.h>

enum {
    SCENARIO_STATE_MAX = 2048,
    SCENARIO_FIRST = 0x400000, SCENARIO_END = 0x540000, /* what may be touched: slots and settings */
};

struct scenario {
    const char *name;
    bool (*prepare)(void);     /* what was before, from a chip as delivered on */
    bool (*act)(void);         /* power up and do it; false: not done */
    void (*tell)(char *state); /* power up and tell in words what is kept and runs */
    bool (*first)(void);       /* or NULL: what `act` does first after it has been done, whose state is then right too */
    unsigned erases;           /* that `act` takes, or the scenario is not what its name says */
};

/** Lists, each ended by a row without a name. */
extern const struct scenario scenario_settings[];

#endif
