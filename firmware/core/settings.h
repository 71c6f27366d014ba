/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Settings: the values of all parameter rows, and where they are kept.
 *
 * Each value is kept under a key made of its command, letter and axis, so that a store survives a
 * firmware with other rows. SS Z keeps all but the class SAVED_NEVER. The back end here is RAM: it
 * outlives a software reset of the parameters, not the power.
 */
#ifndef CORE_SETTINGS_H
#define CORE_SETTINGS_H

#include <stdbool.h>
#include <stdint.h>

struct parameter;

enum { SETTINGS_MAX = 192 }; /* values the RAM back end keeps */

/** Where settings are kept. Keys are unique; `write` replaces. */
struct settings_store {
    bool (*read)(uint32_t key, double *value); /* false: no such key */
    bool (*write)(uint32_t key, double value); /* false: full */
};

extern const struct settings_store settings_ram;

/** Choose the store; before settings_load. */
void settings_init(const struct settings_store *store);

/** Keep one value now: parameters of class SAVED_AT_ONCE, called by the dispatcher. */
void settings_keep(const struct parameter *parameter, unsigned axis);

/** Give every parameter its initial value, then what is saved. Start-up and RESET. */
void settings_load(void);
/** SS Z. False: the store is full. */
bool settings_save(void);
/** SS Y: the saved values now, and again at the next start after an SS X. */
void settings_restore(void);
/** SS X: factory values at the next start. */
void settings_factory_next(void);

/** Key of one value of a parameter. */
uint32_t settings_key(const struct parameter *parameter, unsigned axis);

#endif
