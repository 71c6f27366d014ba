/* SPDX-License-Identifier: BSD-2-Clause */
#include "core/settings.h"

#include <stddef.h>

#include "core/command.h"
#include "core/module.h"

/* Kept under this key: non-zero after SS X. No parameter's hash is 0 (settings_key). */
enum { KEY_FACTORY = 0 };

static const struct settings_store *store = &settings_ram;

void settings_init(const struct settings_store *use)
{
    store = use;
}

/* 32-bit FNV-1a (Fowler, Noll, Vo) of "COMMAND.L", L being the letter or the axis letter. */
uint32_t settings_key(const struct parameter *parameter, unsigned axis)
{
    uint32_t hash = 2166136261u;
    char letter = parameter->letter == PARAMETER_AXES ? axis_letter(axis) : parameter->letter;

    for (const char *name = parameter->command; *name != '\0'; name++)
        hash = (hash ^ (uint8_t)*name) * 16777619u;
    hash = (hash ^ (uint8_t)'.') * 16777619u;
    hash = (hash ^ (uint8_t)letter) * 16777619u;
    return hash != KEY_FACTORY ? hash : 1;
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

static bool is_kept(const struct parameter *row)
{
    return row->saved != SAVED_NEVER && row->value != NULL && !row->read_only;
}

static bool set_initial(const struct parameter *row, unsigned axis)
{
    if (row->value != NULL && !row->read_only)
        parameter_store(row, axis, row->initial);
    return true;
}

static bool set_saved(const struct parameter *row, unsigned axis)
{
    double value;

    /* A value out of the row's range was saved by a firmware with another range. */
    if (is_kept(row) && store->read(settings_key(row, axis), &value) && value >= row->minimum &&
        value <= row->maximum)
        parameter_store(row, axis, value);
    return true;
}

static bool save(const struct parameter *row, unsigned axis)
{
    return !is_kept(row) || store->write(settings_key(row, axis), row->value[axis]);
}

void settings_load(void)
{
    double factory;

    (void)for_each(set_initial);
    if (!store->read(KEY_FACTORY, &factory) || factory == 0)
        (void)for_each(set_saved);
}

void settings_keep(const struct parameter *parameter, unsigned axis)
{
    (void)save(parameter, axis);
}

bool settings_save(void)
{
    return for_each(save) && store->write(KEY_FACTORY, 0);
}

void settings_restore(void)
{
    (void)store->write(KEY_FACTORY, 0);
    (void)for_each(set_saved);
}

void settings_factory_next(void)
{
    (void)store->write(KEY_FACTORY, 1);
}
