/* SPDX-License-Identifier: BSD-2-Clause */
/* Prints the rows of all modules as JSON, as they are after a start with nothing kept, for the command page and the fuzzer's dictionary. */
#include <stdio.h>
#include <stdlib.h>

#include "core/settings.h"
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

/* What the check of an integer takes: "0, 2, 5 ... 9"; "" if nothing. */
static void print_taken(const struct parameter *row)
{
    const char *comma = "";
    long first = 0, length = 0;

    for (long value = (long)row->minimum; value <= (long)row->maximum + 1; value++) {
        if (value <= (long)row->maximum && row->check(0, (double)value) == STATUS_OK) {
            first = length++ == 0 ? value : first;
            continue;
        }
        if (length > 2)
            printf("%s%ld ... %ld", comma, first, value - 1);
        else if (length > 0)
            printf(length == 2 ? "%s%ld, %ld" : "%s%ld", comma, first, value - 1);
        comma = length > 0 ? ", " : comma;
        length = 0;
    }
}

static void taken(const struct parameter *row)
{
    printf("\"taken\": ");
    if (row->check == NULL) {
        printf("null, ");
        return;
    }
    printf("\"");
    if (row->taken != NULL) {
        printf("%s", row->taken);
    } else if (row->type == PARAMETER_INTEGER) {
        print_taken(row);
    } else {
        fprintf(stderr, "%s %c has a check, and does not say what that takes\n", row->command,
                row->letter);
        exit(1);
    }
    printf("\", ");
}

static void parameter(const struct parameter *row)
{
    char letter[] = {row->letter, '\0'};

    printf("{");
    text("command", row->command, ", ");
    text("letter", letter, ", ");
    text("unit", row->unit, ", ");
    text("summary", row->summary, ", ");
    taken(row);
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
    if (!command_init(firmware_modules))
        return 1;
    settings_load();
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
