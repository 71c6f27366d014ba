/* SPDX-License-Identifier: BSD-2-Clause */
/* The tables of all modules together: what no single module can see. */
#include <ctype.h>
#include <stdlib.h>

#include "check.h"
#include "core/settings.h"
#include "modules/lookup.h"
#include "modules/modules.h"

#define EACH_MODULE(m) for (const struct module *const *m = firmware_modules; *m != NULL; m++)
#define EACH_COMMAND(m, row)                                                                       \
    for (const struct command *row = (*m)->commands; row != NULL && row->name != NULL; row++)
#define EACH_PARAMETER(m, row)                                                                     \
    for (const struct parameter *row = (*m)->parameters; row != NULL && row->command != NULL; row++)

static unsigned commands_named(const char *name)
{
    unsigned count = 0;

    EACH_MODULE(m)
    EACH_COMMAND(m, row)
    {
        count += strcmp(row->name, name) == 0;
        count += row->shortcut != NULL && strcmp(row->shortcut, name) == 0;
    }
    return count;
}

TEST(every_name_and_shortcut_belongs_to_one_command)
{
    EACH_MODULE(m)
    EACH_COMMAND(m, row)
    {
        if (commands_named(row->name) != 1)
            CHECK_FAIL("%s is there %u times", row->name, commands_named(row->name));
        if (row->shortcut != NULL && commands_named(row->shortcut) != 1)
            CHECK_FAIL("%s is there %u times", row->shortcut, commands_named(row->shortcut));
    }
}

TEST(names_can_be_typed)
{
    EACH_MODULE(m)
    EACH_COMMAND(m, row)
    {
        CHECK(strlen(row->name) <= VERB_MAX);
        for (const char *at = row->name; *at != '\0'; at++)
            CHECK(isupper(*at) || isdigit(*at));
    }
}

TEST(every_row_has_its_sentence)
{
    EACH_MODULE(m)
    {
        CHECK((*m)->name != NULL);
        EACH_COMMAND(m, row)
        if (row->summary == NULL || row->summary[strlen(row->summary) - 1] != '.')
            CHECK_FAIL("%s", row->name);
        EACH_PARAMETER(m, row)
        if (row->summary == NULL || row->summary[strlen(row->summary) - 1] != '.')
            CHECK_FAIL("%s %c", row->command, row->letter);
    }
}

TEST(every_parameter_belongs_to_a_command_that_exists)
{
    EACH_MODULE(m)
    EACH_PARAMETER(m, row)
    if (commands_named(row->command) != 1)
        CHECK_FAIL("%s %c", row->command, row->letter);
}

TEST(every_initial_value_is_one_that_may_be_set)
{
    EACH_MODULE(m)
    EACH_PARAMETER(m, row)
    {
        for (unsigned axis = 0; axis < parameter_values(row); axis++) {
            double initial = parameter_initial(row, axis);
            bool in_range = initial >= row->minimum && initial <= row->maximum;

            if (!row->read_only && row->value != NULL &&
                (!in_range || (row->check != NULL && row->check(axis, initial) != STATUS_OK)))
                CHECK_FAIL("%s %c", row->command, row->letter);
        }
    }
}

/* The numbers of `taken`: every one of them is taken; between two that no "..." joins nothing is. */
TEST(what_a_row_says_it_takes_is_what_its_check_takes)
{
    unsigned numbers = 0, gaps = 0;

    CHECK(command_init(firmware_modules));
    settings_load();
    EACH_MODULE(m)
    EACH_PARAMETER(m, row)
    {
        double last = 0;
        bool any = false, joined = false;

        for (const char *at = row->taken; at != NULL && *at != '\0';) {
            char *end;
            double number = strtod(at, &end);

            if (end == at) {
                joined |= strncmp(at, "...", 3) == 0;
                at += joined && *at == '.' ? 3 : 1;
                continue;
            }
            numbers++;
            if (row->check(0, number) != STATUS_OK)
                CHECK_FAIL("%s %c does not take %g", row->command, row->letter, number);
            gaps += any && !joined;
            if (any && !joined && row->check(0, (last + number) / 2) == STATUS_OK)
                CHECK_FAIL("%s %c takes %g", row->command, row->letter, (last + number) / 2);
            last = number;
            any = true;
            joined = false;
            at = end;
        }
        if (row->taken == NULL && row->check != NULL && row->type == PARAMETER_REAL)
            CHECK_FAIL("%s %c does not say it", row->command, row->letter);
    }
    CHECK(numbers > 20 && gaps > 5);
}

TEST(every_parameter_can_be_set_or_asked)
{
    EACH_MODULE(m)
    EACH_PARAMETER(m, row)
    if (row->value == NULL && row->get == NULL && row->set == NULL && row->sign == NULL)
        CHECK_FAIL("%s %c", row->command, row->letter);
}

TEST(no_two_rows_claim_one_letter_and_no_two_values_one_key)
{
    uint32_t keys[512];
    char names[512][24];
    unsigned count = 0;

    EACH_MODULE(m)
    EACH_PARAMETER(m, row)
    for (unsigned axis = 0; axis < parameter_values(row); axis++) {
        char letter = row->letter == PARAMETER_AXES ? axis_letter(axis) : row->letter;

        CHECK(count < 512);
        snprintf(names[count], sizeof names[count], "%.15s %c", row->command, letter);
        keys[count] = settings_key(row, axis);
        for (unsigned i = 0; i < count; i++)
            if (strcmp(names[i], names[count]) == 0 || keys[i] == keys[count])
                CHECK_FAIL("%s and %s", names[i], names[count]);
        count++;
    }
    CHECK(count > 0 && count <= SETTINGS_MAX);
}

TEST(every_row_is_found_by_its_name)
{
    CHECK(command_init(firmware_modules));
    EACH_MODULE(m)
    {
        EACH_COMMAND(m, row)
        {
            CHECK(command_find(row->name) == row);
            CHECK(row->shortcut == NULL || command_find(row->shortcut) == row);
        }
        EACH_PARAMETER(m, row)
        CHECK(row->letter == PARAMETER_AXES || row->letter != 'X' ||
              lookup_parameter(row->command, 0) == row);
    }
}

TEST_MAIN(RUN(every_name_and_shortcut_belongs_to_one_command); RUN(names_can_be_typed);
          RUN(every_row_is_found_by_its_name);
          RUN(every_row_has_its_sentence);
          RUN(every_parameter_belongs_to_a_command_that_exists);
          RUN(every_initial_value_is_one_that_may_be_set);
          RUN(what_a_row_says_it_takes_is_what_its_check_takes);
          RUN(every_parameter_can_be_set_or_asked);
          RUN(no_two_rows_claim_one_letter_and_no_two_values_one_key))
