/* SPDX-License-Identifier: BSD-2-Clause */
/** Things a controller does to its flash, for powercut.c. Each function is run in a process of its own, on a chip (chip.h). */
#ifndef TB_POWERCUT_SCENARIO_H
#define TB_POWERCUT_SCENARIO_H

#include <stdbool.h>
#include <stddef.h>

#include "hal/flash_map.h"

enum {
    SCENARIO_STATE_MAX = 2048,
    SCENARIO_FIRST = FLASH_MAP_COUNTER, /* what may be touched: the counter, the slots, the settings */
    SCENARIO_END = FLASH_MAP_SETTINGS + FLASH_MAP_SETTINGS_SECTORS * FLASH_SECTOR,
};

struct scenario {
    const char *name;
    bool (*prepare)(void);     /* what was before, from a chip as delivered on */
    bool (*act)(void);         /* power up and do it; false: not done */
    void (*tell)(char *state); /* power up and tell in words what is kept and runs */
    bool (*first)(void);       /* or NULL: what `act` does first after it has been done, whose state is then right too */
    const char *before, *after; /* what the states say, among other things */
    unsigned erases;           /* that `act` takes at least, or the scenario is not what its name says */
};

/** Lists, each ended by a row without a name. */
extern const struct scenario scenario_settings[], scenario_update[];

#endif
