/* SPDX-License-Identifier: BSD-2-Clause */
/* Prints the rows of all modules as JSON, for the command page and the fuzzer's dictionary. */
#include <stdio.h>

#include "modules/modules.h"

static void text(const char *name, const char *value, const char *end)
{
    printf("\"%s\": \"", name);
    for (; value != NULL && *value != '\0'; value++)
        printf(*value == '"' || *value == '\\' ? "\\%c" : "%c", *value);
    printf("\"%s", end);
}

static void command(const struct command *row)
{
    printf("{");
    text("name", row->name, ", ");
    text("shortcut", row->shortcut, ", ");
    text("summary", row->summary, ", ");
    text("letters", row->letters, ", ");
    printf("\"form\": %d, \"flags\": %d, \"accepts\": %d, \"own_letters\": %s, \"runs\": %s}",
           (int)row->form, row->flags, row->accepts, row->letters != NULL ? "true" : "false",
           row->run != NULL ? "true" : "false");
}

static void parameter(const struct parameter *row)
{
    char letter[] = {row->letter, '\0'};

    printf("{");
    text("command", row->command, ", ");
    text("letter", letter, ", ");
    text("unit", row->unit, ", ");
    text("summary", row->summary, ", ");
    printf("\"integer\": %s, \"decimals\": %u, \"decimals_max\": %u, \"minimum\": %.17g, "
           "\"maximum\": %.17g, \"below\": %d, \"above\": %d, \"saved\": %d, \"read_only\": %s, "
           "\"asked\": %s, \"signs\": %s, \"initial\": [",
           row->type == PARAMETER_INTEGER ? "true" : "false", row->decimals, row->decimals_max,
           row->minimum, row->maximum, (int)row->below, (int)row->above, (int)row->saved,
           row->read_only ? "true" : "false",
           row->value != NULL || row->get != NULL ? "true" : "false",
           row->sign != NULL ? "true" : "false");
    for (unsigned axis = 0; axis < parameter_values(row); axis++)
        printf("%s%.17g", axis > 0 ? ", " : "", parameter_initial(row, axis));
    printf("]}");
}

int main(void)
{
    printf("[");
    for (unsigned m = 0; firmware_modules[m] != NULL; m++) {
        const struct module *module = firmware_modules[m];
        const char *comma = "";

        printf("%s\n {", m > 0 ? "," : "");
        text("name", module->name, ", ");
        printf("\"commands\": [");
        for (const struct command *row = module->commands; row != NULL && row->name != NULL; row++) {
            printf("%s\n  ", comma);
            command(row);
            comma = ",";
        }
        comma = "";
        printf("], \"parameters\": [");
        for (const struct parameter *row = module->parameters; row != NULL && row->command != NULL;
             row++) {
            printf("%s\n  ", comma);
            parameter(row);
            comma = ",";
        }
        printf("]}");
    }
    printf("\n]\n");
    return 0;
}
