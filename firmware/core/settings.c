/* SPDX-License-Identifier: BSD-2-Clause */
#include "core/settings.h"

#include <stddef.h>
#include <string.h>

#include "core/command.h"
#include "core/fault.h"
#include "core/module.h"

/* Kept under this key: non-zero after SS X. No parameter's hash is 0 (settings_key). */
enum { KEY_FACTORY = 0 };

static const struct settings_store *store = &settings_ram;
static bool loading;
static bool passed_over; /* a value that was kept has not been loaded */
static bool written;     /* since the last commit began */
static bool committing;
static bool stale;       /* the store does not hold what was last committed */

void settings_init(const struct settings_store *use)
{
    store = use;
}

/* 32-bit FNV-1a (Fowler, Noll, Vo) of "NAME.L". */
uint32_t settings_key_of(const char *name, char letter)
{
    uint32_t hash = 2166136261u;

    for (; *name != '\0'; name++)
        hash = (hash ^ (uint8_t)*name) * 16777619u;
    hash = (hash ^ (uint8_t)'.') * 16777619u;
    hash = (hash ^ (uint8_t)letter) * 16777619u;
    return hash != KEY_FACTORY ? hash : 1;
}

/* By the hardware channel, not by the letter of the day (Z2B). */
uint32_t settings_key(const struct parameter *parameter, unsigned axis)
{
    return settings_key_of(parameter->command, parameter->letter == PARAMETER_AXES
                                                   ? AXIS_LETTERS[axis]
                                                   : parameter->letter);
}

/* Calls `each` for every value of every parameter; stops at the first false. */
static bool for_each(bool (*each)(const struct parameter *row, unsigned axis))
{
    for (const struct module *const *module = command_modules(); *module != NULL; module++) {
        const struct parameter *row = (*module)->parameters;

        for (; row != NULL && row->command != NULL; row++)
            for (unsigned axis = 0; axis < parameter_values(row); axis++)
                if (!each(row, axis))
                    return false;
    }
    return true;
}

static bool is_kept(const struct parameter *row, enum parameter_saved class)
{
    return row->saved == class && row->value != NULL && !row->read_only;
}

static bool set_initial(const struct parameter *row, unsigned axis)
{
    if (row->value != NULL && !row->read_only)
        parameter_store(row, axis, parameter_initial(row, axis));
    return true;
}

/* A value that may not be set now was kept by a firmware with other rows. */
static void load(const struct parameter *row, unsigned axis)
{
    double value;

    if (!store->read(settings_key(row, axis), &value))
        return;
    if (value >= row->minimum && value <= row->maximum &&
        (row->check == NULL || row->check(axis, value) == STATUS_OK))
        parameter_store(row, axis, value);
    else
        passed_over = true;
}

static bool load_saved(const struct parameter *row, unsigned axis)
{
    if (is_kept(row, SAVED_BY_SS))
        load(row, axis);
    return true;
}

static bool load_kept_at_once(const struct parameter *row, unsigned axis)
{
    if (is_kept(row, SAVED_AT_ONCE))
        load(row, axis);
    return true;
}

static bool save(const struct parameter *row, unsigned axis)
{
    return !is_kept(row, SAVED_BY_SS) || settings_write(settings_key(row, axis), row->value[axis]);
}

static void log_passed_over(void)
{
    if (passed_over)
        log_error(FAULT_NOT_LOADED);
}

void settings_load(void)
{
    double factory;

    loading = true;
    stale = store->damaged != NULL && store->damaged();
    passed_over = stale;
    (void)for_each(set_initial);
    if (!store->read(KEY_FACTORY, &factory) || factory == 0)
        (void)for_each(load_saved);
    (void)for_each(load_kept_at_once);
    loading = false;
    log_passed_over();
}

bool settings_loading(void)
{
    return loading;
}

void settings_keep(const struct parameter *parameter, unsigned axis)
{
    if (is_kept(parameter, SAVED_AT_ONCE))
        (void)settings_write(settings_key(parameter, axis), parameter->value[axis]);
}

bool settings_save(void)
{
    return for_each(save) && settings_write(KEY_FACTORY, 0);
}

bool settings_restore(void)
{
    passed_over = false;
    (void)for_each(load_saved);
    log_passed_over();
    return settings_write(KEY_FACTORY, 0);
}

bool settings_factory_next(void)
{
    return settings_write(KEY_FACTORY, 1);
}

bool settings_read(uint32_t key, double *value)
{
    return store->read(key, value) && *value == *value;
}

/* What is there already costs the store nothing, unless it may have been lost there. */
bool settings_write(uint32_t key, double value)
{
    double kept;
    const bool there = store->read(key, &kept);

    if (there ? memcmp(&kept, &value, sizeof value) == 0 : value != value) {
        written |= stale;
        return true;
    }
    written = true;
    return store->write(key, value);
}

void settings_poll(void)
{
    if (committing || !written)
        return;
    committing = true;
    written = false;
    stale = !store->commit();
    committing = false;
}

bool settings_pending(void)
{
    return written || committing;
}

bool settings_kept(void)
{
    return !stale && !settings_pending();
}
