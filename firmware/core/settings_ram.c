/* SPDX-License-Identifier: BSD-2-Clause */
/* Back end of the settings: RAM. Entries are found by linear search; saving is not in a hurry. */
#include <stddef.h>

#include "core/settings.h"

struct entry {
    uint32_t key;
    double value;
};

static struct entry entries[SETTINGS_MAX];
static unsigned used;

static struct entry *find(uint32_t key)
{
    for (unsigned i = 0; i < used; i++)
        if (entries[i].key == key)
            return &entries[i];
    return NULL;
}

static bool ram_read(uint32_t key, double *value)
{
    const struct entry *entry = find(key);

    if (entry == NULL)
        return false;
    *value = entry->value;
    return true;
}

static bool ram_write(uint32_t key, double value)
{
    struct entry *entry = find(key);

    if (entry == NULL) {
        if (used == SETTINGS_MAX)
            return false;
        entry = &entries[used++];
        entry->key = key;
    }
    entry->value = value;
    return true;
}

static bool ram_commit(void)
{
    return true;
}

bool settings_ram_entry(unsigned n, uint32_t *key, double *value)
{
    if (n >= used)
        return false;
    *key = entries[n].key;
    *value = entries[n].value;
    return true;
}

const struct settings_store settings_ram = {ram_read, ram_write, ram_commit};
