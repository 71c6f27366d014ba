/* SPDX-License-Identifier: BSD-2-Clause */
/** What a module gives to the rest of the firmware. Each file in modules/ ends in one of these. */
#ifndef CORE_MODULE_H
#define CORE_MODULE_H

#include "core/command.h"
#include "core/events.h"

struct module {
    const char *name;
    const struct command *commands;            /* ended by { 0 }, or NULL */
    const struct parameter *parameters;        /* ended by { 0 }, or NULL */
    const struct subscription *subscriptions;  /* ended by { 0 }, or NULL */
    const char *const *build_lines;            /* its lines of BUILD X, ended by NULL, or NULL */
    bool (*frame)(const uint8_t *frame, struct reply *reply); /* of command_frame, or NULL */
    void (*init)(void);                        /* once, after all parameters have their values */
    void (*poll)(void);                        /* each turn of the main loop; returns soon */
};

#endif
