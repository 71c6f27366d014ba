/* SPDX-License-Identifier: BSD-2-Clause */
#include "core/command.h"

#include <stddef.h>
#include <string.h>

#include "core/events.h"
#include "core/module.h"
#include "core/number.h"
#include "core/rows.h"
#include "core/settings.h"

/* Queries are answered in this order, whatever the order asked, but the hardware's axes first. */
static const char reply_order[] = "XYZFTRMABCDEGHIJKLNOPQSUVW";

static const struct module *const no_modules[] = {NULL};
static const struct module *const *modules = no_modules;

bool command_init(const struct module *const *list)
{
    modules = list;
    return rows_init(list);
}

const struct module *const *command_modules(void)
{
    return modules;
}

const struct command *command_find(const char *verb)
{
    const struct rows_entry *entry = rows_find(verb);

    return entry != NULL ? entry->command : NULL;
}

/* A parameter row, and which of its values a letter means. */
struct target {
    const struct parameter *parameter;
    unsigned axis;
};

static struct target find_target(const struct rows_entry *entry, char letter)
{
    int axis = axis_index(letter);

    for (const struct rows_link *link = entry->parameters; link != NULL; link = link->next) {
        if (link->row->letter == letter)
            return (struct target){link->row, 0};
        if (link->row->letter == PARAMETER_AXES && axis >= 0)
            return (struct target){link->row, (unsigned)axis};
    }
    return (struct target){NULL, 0};
}

unsigned parameter_values(const struct parameter *parameter)
{
    return parameter->letter == PARAMETER_AXES ? AXIS_COUNT : 1;
}

double parameter_value(const struct parameter *parameter, unsigned axis)
{
    if (parameter->get != NULL)
        return parameter->get(axis);
    return parameter->value != NULL ? parameter->value[axis] : 0;
}

double parameter_initial(const struct parameter *parameter, unsigned axis)
{
    return parameter->initial_of != NULL ? parameter->initial_of(axis) : parameter->initial;
}

void parameter_store(const struct parameter *parameter, unsigned axis, double value)
{
    if (parameter->adjust != NULL)
        value = parameter->adjust(axis, value);
    if (parameter->value != NULL)
        parameter->value[axis] = value;
    if (parameter->set != NULL)
        parameter->set(axis, value);
}

/* Cut the fraction off; beyond 2^53 there is none. */
static double whole(double value)
{
    return value > -9e15 && value < 9e15 ? (double)(int64_t)value : value;
}

/* What an argument would set; `ignore`: nothing. */
static enum status value_to_set(struct target target, double asked, double *value, bool *ignore)
{
    const struct parameter *row = target.parameter;
    enum parameter_outside outside = OUTSIDE_CLIP;

    *value = row->type == PARAMETER_INTEGER ? whole(asked) : asked;
    *ignore = false;
    if (row->read_only)
        return STATUS_RANGE;
    if (*value < row->minimum) {
        outside = row->below;
        *value = row->minimum;
    } else if (*value > row->maximum) {
        outside = row->above;
        *value = row->maximum;
    }
    if (outside == OUTSIDE_REFUSE)
        return STATUS_RANGE;
    *ignore = outside == OUTSIDE_IGNORE;
    if (*ignore || row->check == NULL)
        return STATUS_OK;
    return row->check(target.axis, *value);
}

static enum status check_parameter(struct target target, const struct argument *argument)
{
    const struct parameter *row = target.parameter;
    double value;
    bool ignore;

    switch (argument->kind) {
    case ARGUMENT_QUERY:
        return row->value != NULL || row->get != NULL ? STATUS_OK : STATUS_RANGE;
    case ARGUMENT_PLUS:
    case ARGUMENT_MINUS:
        if (row->sign == NULL || row->read_only)
            return STATUS_RANGE;
        return row->sign(target.axis, argument->kind == ARGUMENT_PLUS, false);
    default:
        return value_to_set(target, argument->value, &value, &ignore);
    }
}

static void set_parameter(struct target target, const struct argument *argument)
{
    double value;
    bool ignore;

    switch (argument->kind) {
    case ARGUMENT_QUERY:
        break;
    case ARGUMENT_PLUS:
    case ARGUMENT_MINUS:
        (void)target.parameter->sign(target.axis, argument->kind == ARGUMENT_PLUS, true);
        break;
    default:
        (void)value_to_set(target, argument->value, &value, &ignore);
        if (!ignore)
            parameter_store(target.parameter, target.axis, value);
        break;
    }
    if (target.parameter->saved == SAVED_AT_ONCE && argument->kind != ARGUMENT_QUERY)
        settings_keep(target.parameter, target.axis);
}

static enum status check_handler(const struct command *command, const struct argument *argument)
{
    bool known = command->letters != NULL ? strchr(command->letters, argument->letter) != NULL
                                          : axis_index(argument->letter) >= 0;

    if (command->run == NULL || command->accepts == 0 || !known)
        return STATUS_UNKNOWN_AXIS;
    return (command->accepts & argument->kind) != 0 ? STATUS_OK : STATUS_RANGE;
}

/* The one of two outcomes that is reported. */
static enum status graver(enum status a, enum status b)
{
    static const int8_t order[] = {STATUS_UNKNOWN_COMMAND, STATUS_MISSING, STATUS_UNKNOWN_AXIS,
                                   STATUS_RANGE,           STATUS_FAILED,  STATUS_UNDEFINED};

    for (size_t i = 0; i < sizeof order; i++)
        if (a == order[i] || b == order[i])
            return (enum status)order[i];
    return a != STATUS_OK ? a : b;
}

/* Judge the whole line. `runs`: something in it is for the handler. */
static enum status check_line(const struct rows_entry *entry, const struct request *request,
                              bool *runs)
{
    const struct command *command = entry->command;
    enum status status = STATUS_OK;

    *runs = request->count == 0;
    if (request->count == 0 && request->text == NULL &&
        (command->run == NULL || (command->flags & COMMAND_NEEDS_ARGUMENT) != 0))
        return STATUS_MISSING;
    for (size_t i = 0; i < request->count; i++) {
        const struct argument *argument = &request->arguments[i];
        struct target target = find_target(entry, argument->letter);

        if (target.parameter != NULL) {
            status = graver(status, check_parameter(target, argument));
        } else {
            status = graver(status, check_handler(command, argument));
            *runs = true;
        }
    }
    if (*runs && command->run == NULL)
        status = graver(status, STATUS_UNKNOWN_AXIS);
    if (status == STATUS_OK && command->check != NULL)
        status = command->check(request);
    return status;
}

static bool is_exact(double value, unsigned decimals)
{
    char text[NUMBER_TEXT_MAX];
    size_t used;
    double read;
    size_t length = number_format(text, value, decimals);

    return number_parse(text, length, &read, &used) == NUMBER_OK && read == value;
}

static void print_value(struct reply *reply, const struct parameter *row, unsigned axis)
{
    double value = parameter_value(row, axis);
    unsigned decimals = row->type == PARAMETER_INTEGER ? 0 : row->decimals;

    while (decimals < row->decimals_max && !is_exact(value, decimals))
        decimals++;
    reply_number(reply, value, decimals);
}

static void print_query(const struct rows_entry *entry, char letter, struct reply *reply)
{
    const struct target target = find_target(entry, letter);

    if (target.parameter == NULL)
        return;
    reply_field(reply, letter);
    print_value(reply, target.parameter, target.axis);
}

static uint32_t letter_bit(char letter)
{
    return letter >= 'A' && letter <= 'Z' ? UINT32_C(1) << (letter - 'A') : 0;
}

static void print_queries(const struct rows_entry *entry, const struct request *request,
                          struct reply *reply)
{
    uint32_t asked = 0;

    for (size_t i = 0; i < request->count; i++)
        if (request->arguments[i].kind == ARGUMENT_QUERY)
            asked |= letter_bit(request->arguments[i].letter);
    reply_open(reply, entry->command->form);
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        if ((asked & letter_bit(axis_letter(axis))) != 0)
            print_query(entry, axis_letter(axis), reply);
        asked &= ~letter_bit(axis_letter(axis));
    }
    for (const char *letter = reply_order; asked != 0 && *letter != '\0'; letter++)
        if ((asked & letter_bit(*letter)) != 0)
            print_query(entry, *letter, reply);
    reply_close(reply);
}

static bool may_change(const struct command *command, const struct request *request)
{
    if ((command->flags & COMMAND_ASKS) != 0)
        return false;
    for (size_t i = 0; i < request->count; i++)
        if (request->arguments[i].kind != ARGUMENT_QUERY)
            return true;
    return request->count == 0;
}

enum status command_execute(const char *line, size_t length, struct request *request,
                            struct reply *reply)
{
    enum status status = parser_parse(line, length, request);
    const struct rows_entry *entry = rows_find(request->verb);
    const struct command *command = entry != NULL ? entry->command : NULL;
    bool runs;

    if (command == NULL)
        return STATUS_UNKNOWN_COMMAND;
    if (status != STATUS_OK && (command->flags & COMMAND_TAKES_TEXT) == 0)
        return status;
    status = check_line(entry, request, &runs);
    if (status != STATUS_OK)
        return status;
    if (may_change(command, request))
        events_publish(EVENT_COMMAND, 0, 0);
    for (size_t i = 0; i < request->count; i++) {
        struct target target = find_target(entry, request->arguments[i].letter);

        if (target.parameter != NULL)
            set_parameter(target, &request->arguments[i]);
    }
    print_queries(entry, request, reply);
    return runs ? command->run(request, reply) : STATUS_OK;
}

bool command_frame(const uint8_t *frame, struct reply *reply)
{
    events_publish(EVENT_COMMAND, 0, 0);
    for (unsigned m = 0; modules[m] != NULL; m++)
        if (modules[m]->frame != NULL && modules[m]->frame(frame, reply))
            return true;
    return false;
}

enum status command_resume(const struct request *request, struct reply *reply)
{
    const struct command *command = command_find(request->verb);

    return command != NULL && command->run != NULL ? command->run(request, reply)
                                                   : STATUS_UNDEFINED;
}

bool command_urgent(const char *line, size_t length)
{
    char verb[VERB_MAX + 1];
    const struct command *command;

    parser_verb(line, length, verb);
    command = command_find(verb);
    return command != NULL && command->urgent != NULL && command->urgent();
}
