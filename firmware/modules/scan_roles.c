/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/scan_roles.h"

#include <stddef.h>

#include "core/axis.h"

enum { X, Y, Z, LETTERS };

/* The words X, Y and Z of a line; those that are only asked for are as if not there. */
struct words {
    const struct argument *given[LETTERS];
    int value[LETTERS];
    bool two, nine; /* one of them has this value */
};

static enum status read_words(const struct request *request, struct words *words)
{
    *words = (struct words){.two = false};
    for (int n = 0; n < LETTERS; n++) {
        const struct argument *given = request_argument(request, "XYZ"[n]);

        if (given == NULL || given->kind == ARGUMENT_QUERY)
            continue;
        if (!(given->value >= 0 && given->value <= 99))
            return STATUS_RANGE;
        words->given[n] = given;
        words->value[n] = (int)given->value;
        words->two |= words->value[n] == 2;
        words->nine |= words->value[n] == SCAN_ROLES_NONE;
    }
    return STATUS_OK;
}

static bool is_axis_or_none(int number)
{
    return number < AXIS_COUNT || number == SCAN_ROLES_NONE;
}

static enum status take_numbers(const struct words *words, struct scan_wish *wish)
{
    if (words->given[Y] != NULL)
        wish->fast = words->value[Y];
    if (words->given[Z] != NULL)
        wish->slow = words->value[Z];
    if (!is_axis_or_none(wish->fast) || !is_axis_or_none(wish->slow) ||
        (wish->fast == wish->slow && wish->fast != SCAN_ROLES_NONE))
        return STATUS_RANGE;
    return STATUS_OK;
}

static enum status take_roles(const struct words *words, struct scan_wish *wish)
{
    int named[] = {SCAN_ROLES_NONE, SCAN_ROLES_NONE, SCAN_ROLES_NONE}; /* axis of each role */

    for (int n = 0; n < LETTERS; n++) {
        const int role = words->value[n];

        if (words->given[n] == NULL)
            continue;
        if (role > 2 || (role > 0 && (n >= AXIS_COUNT || named[role] != SCAN_ROLES_NONE)))
            return STATUS_RANGE;
        if (wish->fast == n)
            wish->fast = SCAN_ROLES_NONE;
        if (wish->slow == n)
            wish->slow = SCAN_ROLES_NONE;
        named[role] = n;
    }
    if (named[1] != SCAN_ROLES_NONE)
        wish->fast = named[1];
    if (named[2] != SCAN_ROLES_NONE)
        wish->slow = named[2];
    return STATUS_OK;
}

/* An axis parameter as the line sets it, or as it is. */
static int axis_set(const struct request *request, char letter, int present)
{
    const struct argument *argument = request_argument(request, letter);

    return argument != NULL && argument->kind != ARGUMENT_QUERY ? (int)argument->value : present;
}

static enum status take_letters(const struct request *request, struct scan_wish *wish)
{
    for (size_t n = 0; n < request->count; n++) {
        const struct argument *argument = &request->arguments[n];

        if (argument->letter != 'S' && argument->letter != 'P')
            continue;
        if (argument->kind != ARGUMENT_BARE)
            return STATUS_RANGE;
        wish->action = argument->letter == 'S' ? SCAN_BEGIN : SCAN_END;
    }
    return STATUS_OK;
}

enum status scan_roles_read(const struct request *request, bool roles_only, struct scan_wish *wish)
{
    struct words words;
    enum status status = read_words(request, &words);

    if (status != STATUS_OK)
        return status;
    wish->action = request->count == 0 ? SCAN_TOGGLE : SCAN_NOTHING;
    wish->fast = axis_set(request, 'R', wish->fast);
    wish->slow = axis_set(request, 'T', wish->slow);
    if (words.given[X] != NULL && (words.value[X] == 'S' || words.value[X] == 'P')) {
        wish->action = words.value[X] == 'S' ? SCAN_BEGIN : SCAN_END;
        words.given[X] = NULL;
    }

    const bool both = words.given[Y] != NULL && words.given[Z] != NULL;
    if (words.given[X] == NULL && !words.two && (words.nine || (!roles_only && both)))
        status = take_numbers(&words, wish);
    else
        status = take_roles(&words, wish);
    return status == STATUS_OK ? take_letters(request, wish) : status;
}
