/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/lookup.h"

#include <stddef.h>
#include <string.h>

#include "core/module.h"

const struct parameter *lookup_parameter(const char *command, unsigned axis)
{
    for (const struct module *const *module = command_modules(); *module != NULL; module++) {
        const struct parameter *row = (*module)->parameters;

        for (; row != NULL && row->command != NULL; row++)
            if (strcmp(row->command, command) == 0 &&
                (row->letter == PARAMETER_AXES || row->letter == axis_letter(axis)))
                return row;
    }
    return NULL;
}

double lookup_value(const char *command, unsigned axis, double absent)
{
    const struct parameter *row = lookup_parameter(command, axis);

    if (row == NULL)
        return absent;
    return parameter_value(row, row->letter == PARAMETER_AXES ? axis : 0);
}
