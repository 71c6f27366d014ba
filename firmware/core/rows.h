/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The rows of all modules by name: a hash table, filled once at the start. Finding a command and its
 * parameters then costs the same however many modules there are.
 */
#ifndef CORE_ROWS_H
#define CORE_ROWS_H

#include <stdbool.h>

struct command;
struct module;
struct parameter;

enum { ROWS_NAMES = 512, ROWS_PARAMETERS = 384 };

/** Parameters of one command, in the order of the modules and of their tables. */
struct rows_link {
    const struct parameter *row;
    struct rows_link *next; /* or NULL */
};

/** What a name or a shortcut stands for. */
struct rows_entry {
    const char *name;
    const struct command *command; /* the first of that name; NULL: parameters without one */
    struct rows_link *parameters;  /* or NULL */
};

/** Take the rows of a list of modules, ended by NULL. False: more of them than there is room for. */
bool rows_init(const struct module *const *modules);

/** The entry of a name, or NULL. */
const struct rows_entry *rows_find(const char *name);

#endif
