/* SPDX-License-Identifier: BSD-2-Clause */
#include "check.h"
#include "core/module.h"
#include "core/rows.h"

static const struct parameter early[] = {
    {.command = "SPEED", .letter = 'X'},
    {.command = "LATER", .letter = 'Q'},
    {.command = "SPEED", .letter = 'Y'},
    {0},
};

static const struct command commands[] = {
    {.name = "SPEED", .shortcut = "S"},
    {.name = "LATER", .shortcut = "L"},
    {0},
};

static const struct parameter late[] = {
    {.command = "SPEED", .letter = 'Z'},
    {0},
};

static const struct command again[] = {
    {.name = "S", .shortcut = "SPEED"},
    {0},
};

static const struct module first = {.commands = commands, .parameters = early};
static const struct module second = {.commands = again, .parameters = late};
static const struct module *const both[] = {&first, &second, NULL};

static void check_letters(const char *name, const char *letters)
{
    const struct rows_entry *entry = rows_find(name);

    CHECK(entry != NULL);
    for (const struct rows_link *link = entry->parameters; link != NULL; link = link->next)
        CHECK(link->row->letter == *letters++);
    CHECK(*letters == '\0');
}

TEST(the_first_command_of_a_name_counts)
{
    CHECK(rows_init(both));
    CHECK(rows_find("SPEED")->command == &commands[0]);
    CHECK(rows_find("S")->command == &commands[0]);
    CHECK(rows_find("L")->command == &commands[1]);
}

TEST(a_name_and_its_shortcut_have_all_parameters_in_order)
{
    CHECK(rows_init(both));
    check_letters("SPEED", "XYZ");
    check_letters("S", "XYZ");
    check_letters("L", "Q");
}

TEST(other_names_are_not_found)
{
    CHECK(rows_init(both));
    CHECK(rows_find("SPEE") == NULL);
    CHECK(rows_find("SPEEDY") == NULL);
    CHECK(rows_find("") == NULL);
}

/* Whether as many names find a place, and are found there: A0, A1 ... */
static bool names_fit(unsigned count)
{
    static char names[ROWS_NAMES + 1][12];
    static struct command rows[ROWS_NAMES + 1];
    static const struct module many = {.commands = rows};
    const struct module *const list[] = {&many, NULL};

    memset(rows, 0, sizeof rows);
    for (unsigned n = 0; n < count; n++) {
        snprintf(names[n], sizeof names[n], "A%u", n);
        rows[n].name = names[n];
    }
    bool fit = rows_init(list);

    for (unsigned n = 0; fit && n < count; n++)
        fit = rows_find(names[n])->command == &rows[n];
    return fit;
}

static bool parameters_fit(unsigned count)
{
    static struct parameter rows[ROWS_PARAMETERS + 2];
    static const struct module many = {.parameters = rows};
    const struct module *const list[] = {&many, NULL};

    memset(rows, 0, sizeof rows);
    for (unsigned n = 0; n < count; n++)
        rows[n] = (struct parameter){.command = "A", .letter = 'X'};
    return rows_init(list);
}

TEST(more_rows_than_there_is_room_for_are_told)
{
    CHECK(names_fit(ROWS_NAMES - 1));
    CHECK(!names_fit(ROWS_NAMES));
    CHECK(parameters_fit(ROWS_PARAMETERS));
    CHECK(!parameters_fit(ROWS_PARAMETERS + 1));
}

TEST_MAIN(RUN(the_first_command_of_a_name_counts);
          RUN(a_name_and_its_shortcut_have_all_parameters_in_order); RUN(other_names_are_not_found);
          RUN(more_rows_than_there_is_room_for_are_told);)
