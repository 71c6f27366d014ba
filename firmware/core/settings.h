/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Settings: the values of all parameter rows, and where they are kept.
 *
 * Each value is kept under a key made of its command, letter and axis, so that a store survives a
 * firmware with other rows. SS Z keeps the class SAVED_BY_SS, and from then on they are the values
 * at a start. SS X lets the next starts use initial values instead, what is kept being left alone;
 * SS Y takes that back and loads what is kept; an SS Z keeps anew. The class SAVED_AT_ONCE is kept
 * whenever it is set, is loaded at every start, and SS has nothing to do with it. A row of that class
 * without a `value` is kept and loaded by its module, which keeps another form of it (places).
 *
 * What is written is seen by reads at once and kept by the next settings_poll, all of it together: by
 * then it is all old or all new, whenever the power goes. A store may take long (a sector of flash takes
 * up to 400 ms to erase) and let the main loop go on meanwhile; what is then written is kept after that.
 *
 * The back end here is RAM: it outlives a software reset, not the power.
 */
#ifndef CORE_SETTINGS_H
#define CORE_SETTINGS_H

#include <stdbool.h>
#include <stdint.h>

struct parameter;

enum { SETTINGS_MAX = 256 }; /* values the RAM back end keeps */

/** Where settings are kept. Keys are unique; `write` replaces. */
struct settings_store {
    bool (*read)(uint32_t key, double *value); /* false: no such key */
    bool (*write)(uint32_t key, double value); /* false: full */
    bool (*commit)(void);                      /* all writes so far, together; false: all as before */
    bool (*damaged)(void);                     /* some of what was kept cannot be read; or NULL */
};

extern const struct settings_store settings_ram;

/** The n-th value in RAM; false: there are fewer. For back ends that keep an image of it. */
bool settings_ram_entry(unsigned n, uint32_t *key, double *value);

/** Nothing is in RAM: as after power-up. */
void settings_ram_clear(void);

/** Choose the store; before settings_load. Without it, settings_ram. */
void settings_init(const struct settings_store *store);

/** Keep one value now: parameters of class SAVED_AT_ONCE, called by the dispatcher. */
void settings_keep(const struct parameter *parameter, unsigned axis);

/**
 * Give every parameter its initial value, then what is kept. Start-up and RESET. Logs 55 when some of
 * that cannot be read, or may not be the value of its parameter.
 */
void settings_load(void);
/**
 * settings_load is at work: values are set one after the other, and each module's init comes after
 * them. What follows from many of them is made there, once.
 */
bool settings_loading(void);

/** SS Z. False: the store is full. */
bool settings_save(void);
/** SS Y: the kept values now, and again at the next start after an SS X. False: the store is full. */
bool settings_restore(void);
/** SS X: initial values at the next start. */
bool settings_factory_next(void);

/** Key of one value of a parameter. */
uint32_t settings_key(const struct parameter *parameter, unsigned axis);
/** Key of something that is no parameter: of "NAME.L". */
uint32_t settings_key_of(const char *name, char letter);

/** Read, write or forget (NAN) a value that is no parameter. False: there is none; the store is full. */
bool settings_read(uint32_t key, double *value);
bool settings_write(uint32_t key, double value);

/**
 * Keep what has been written since, if anything. Of the main loop, which the store may let run inside
 * this call; does nothing when called from there.
 */
void settings_poll(void);

/** Something is written that is not kept yet, nor given up. */
bool settings_pending(void);

/** All that was written is kept. False: not yet, or the store failed; the next write tries again. */
bool settings_kept(void);

#endif
