/* SPDX-License-Identifier: BSD-2-Clause */
#include "core/action.h"

#include <stddef.h>

static const struct claim *claims;

void action_init(const struct claim *list)
{
    claims = list;
}

bool action_perform(enum action action)
{
    for (const struct claim *row = claims; row != NULL && row->action != ACTION_NONE; row++)
        if (row->action == action && row->take())
            return true;
    return false;
}
