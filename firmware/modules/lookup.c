/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/lookup.h"

#include <stddef.h>

#include "core/rows.h"

const struct parameter *lookup_parameter(const char *command, unsigned axis)
{
    const struct rows_entry *entry = rows_find(command);
    const struct rows_link *link = entry != NULL ? entry->parameters : NULL;

    while (link != NULL && link->row->letter != PARAMETER_AXES &&
           link->row->letter != axis_letter(axis))
        link = link->next;
    return link != NULL ? link->row : NULL;
}

double lookup_value(const char *command, unsigned axis, double absent)
{
    const struct parameter *row = lookup_parameter(command, axis);

    if (row == NULL)
        return absent;
    return parameter_value(row, row->letter == PARAMETER_AXES ? axis : 0);
}
