/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Bare commands and buttons that several modules want: one priority list says who gets each.
 *
 * The list (modules/modules.c) names claims in order. action_perform asks each claim of the action
 * in turn; the first that takes it ends the search.
 */
#ifndef CORE_ACTION_H
#define CORE_ACTION_H

#include <stdbool.h>

enum action {
    ACTION_NONE, /* ends a list */
    ACTION_AT_SHORT,
    ACTION_AT_LONG,
    ACTION_AT_EXTRA_LONG,
    ACTION_HOME_SHORT,
    ACTION_HOME_LONG,
    ACTION_HOME_EXTRA_LONG,
    ACTION_ZERO_SHORT,
    ACTION_ZERO_LONG,
    ACTION_ZERO_EXTRA_LONG,
    ACTION_JOYSTICK_SHORT,
    ACTION_JOYSTICK_LONG,
    ACTION_JOYSTICK_EXTRA_LONG,
    ACTION_LOCK,      /* bare LK */
    ACTION_RING_NEXT, /* bare RM */
};

struct claim {
    enum action action;
    bool (*take)(void); /* true: done; false: not now, ask the next */
};

void action_init(const struct claim *claims);

/** True when somebody took the action. */
bool action_perform(enum action action);

#endif
