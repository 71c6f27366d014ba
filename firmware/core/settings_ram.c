/* SPDX-License-Identifier: BSD-2-Clause */
/* Back end of the settings: RAM. All values are read and written in the order they were kept in. */
#include "core/settings.h"

static uint32_t keys[SETTINGS_MAX];
static double values[SETTINGS_MAX];
static unsigned used;

/* Number of a key's entry; `used`: there is none. Looked for from behind the last one found on. */
static unsigned find(uint32_t key)
{
    static unsigned next;

    for (unsigned tried = 0; tried < used; tried++) {
        unsigned n = next < used ? next : 0;

        next = n + 1;
        if (keys[n] == key)
            return n;
    }
    return used;
}

static bool ram_read(uint32_t key, double *value)
{
    const unsigned n = find(key);

    if (n == used)
        return false;
    *value = values[n];
    return true;
}

static bool ram_write(uint32_t key, double value)
{
    const unsigned n = find(key);

    if (n == SETTINGS_MAX)
        return false;
    keys[n] = key;
    values[n] = value;
    if (n == used)
        used++;
    return true;
}

static bool ram_commit(void)
{
    return true;
}

void settings_ram_clear(void)
{
    used = 0;
}

bool settings_ram_entry(unsigned n, uint32_t *key, double *value)
{
    if (n >= used)
        return false;
    *key = keys[n];
    *value = values[n];
    return true;
}

const struct settings_store settings_ram = {
    .read = ram_read, .write = ram_write, .commit = ram_commit,
};
