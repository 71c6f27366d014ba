/* SPDX-License-Identifier: BSD-2-Clause */
#include "core/rows.h"

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "core/module.h"

/* One slot is always empty and ends a search. */
static struct rows_entry entries[ROWS_NAMES];
static struct rows_link links[ROWS_PARAMETERS];
static unsigned entries_used, links_used;

/* The slot a name is in, or the empty one it would be put into. */
static struct rows_entry *slot(const char *name)
{
    uint32_t hash = 0;

    for (const char *at = name; *at != '\0'; at++)
        hash = hash * 31 + (uint8_t)*at;
    while (entries[hash % ROWS_NAMES].name != NULL &&
           strcmp(entries[hash % ROWS_NAMES].name, name) != 0)
        hash++;
    return &entries[hash % ROWS_NAMES];
}

/* The entry of a name, which gets one if it has none; NULL: no room. */
static struct rows_entry *entry_of(const char *name)
{
    struct rows_entry *entry = slot(name);

    if (entry->name == NULL) {
        if (entries_used == ROWS_NAMES - 1)
            return NULL;
        entries_used++;
        entry->name = name;
    }
    return entry;
}

/* Where the next parameter of an entry is hung. */
static struct rows_link **end_of(struct rows_entry *entry)
{
    struct rows_link **end = &entry->parameters;

    while (*end != NULL)
        end = &(*end)->next;
    return end;
}

static bool add_parameters(const struct parameter *row)
{
    struct rows_link **end = NULL;

    for (const char *of = NULL; row != NULL && row->command != NULL; of = row++->command) {
        struct rows_link *link = &links[links_used];

        if (row->command != of) {
            struct rows_entry *entry = entry_of(row->command);

            if (entry == NULL)
                return false;
            end = end_of(entry);
        }
        if (links_used == ROWS_PARAMETERS)
            return false;
        links_used++;
        *link = (struct rows_link){row, NULL};
        *end = link;
        end = &link->next;
    }
    return true;
}

static bool add_name(const char *name, const struct command *command)
{
    struct rows_entry *entry = entry_of(name);

    if (entry != NULL && entry->command == NULL) {
        entry->command = command;
        entry->parameters = slot(command->name)->parameters;
    }
    return entry != NULL;
}

static bool add_commands(const struct command *row)
{
    for (; row != NULL && row->name != NULL; row++)
        if (!add_name(row->name, row) || (row->shortcut != NULL && !add_name(row->shortcut, row)))
            return false;
    return true;
}

bool rows_init(const struct module *const *modules)
{
    memset(entries, 0, sizeof entries);
    entries_used = 0;
    links_used = 0;
    /* Parameters first: what a shortcut stands for is copied. */
    for (const struct module *const *module = modules; *module != NULL; module++)
        if (!add_parameters((*module)->parameters))
            return false;
    for (const struct module *const *module = modules; *module != NULL; module++)
        if (!add_commands((*module)->commands))
            return false;
    return true;
}

const struct rows_entry *rows_find(const char *name)
{
    const struct rows_entry *entry = slot(name);

    return entry->name != NULL ? entry : NULL;
}
