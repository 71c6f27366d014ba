/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The rows: what commands and parameters there are, and the one dispatcher over them.
 *
 * A parameter is a (command, letter) pair with a value, a range and a print format; most of the
 * language is parameters and needs no code. A command has a name, a shortcut, the form of its
 * query replies, and a handler for what is no parameter. Modules may add parameters to a command
 * that another module defines.
 *
 * A line is all or nothing: every argument is checked first, then sets are made in the order of the
 * line, then queries are printed in hardware axis order, then `run` acts. The first error in the
 * order -1, -3, -2, -4, -5 is the one reply, and nothing has changed (-5 alone may come from a
 * handler that has begun). A line with broken syntax (parser.h) is refused right after -1.
 */
#ifndef CORE_COMMAND_H
#define CORE_COMMAND_H

#include <stdbool.h>
#include <stdint.h>

#include "core/axis.h"
#include "core/parser.h"
#include "core/reply.h"
#include "core/status.h"

enum command_flags {
    COMMAND_NEEDS_ARGUMENT = 1, /* `run` without any argument is :N-3 */
    COMMAND_TAKES_TEXT = 2,     /* broken syntax is no fault; `run` gets what could be read */
    COMMAND_ASKS = 4,           /* changes nothing, whatever its arguments */
};

/** All letters, for `letters` of a command that judges them itself. */
#define LETTERS_ALL "ABCDEFGHIJKLMNOPQRSTUVWXYZ#"

struct command {
    const char *name;     /* long name, upper case; NULL ends a table */
    const char *shortcut; /* or NULL */
    const char *summary;  /* one sentence, for the command page */
    enum reply_form form; /* of queries of its parameters */
    uint8_t flags;        /* enum command_flags */

    /**
     * Arguments that are no parameter rows go to `run`: the kinds it takes (enum argument_kind,
     * or-ed) and the letters (NULL: the fitted axes). Others are :N-4 and :N-2.
     */
    uint8_t accepts;
    const char *letters;

    /** Optional: judge the whole line before anything changes. */
    enum status (*check)(const struct request *request);

    /**
     * Act on a line without arguments, or with arguments that are no rows; NULL: :N-3 and :N-2.
     * Checks everything before it changes anything. Never waits. STATUS_PENDING: called again with
     * the same request when the text written so far has left (reply.h, `step`).
     */
    enum status (*run)(const struct request *request, struct reply *reply);

    /**
     * Optional, HALT only: called as soon as the line is known, ahead of commands and replies that
     * wait. `run` is called as well, in its turn, and gives the reply; request->acted holds what
     * this returned.
     */
    bool (*urgent)(void);
};

/** `letter` of a parameter that has one value for each axis. */
#define PARAMETER_AXES '*'

enum parameter_type {
    PARAMETER_REAL,
    PARAMETER_INTEGER, /* a fraction is cut off toward zero; printed without decimals */
};

/** What a value outside minimum..maximum does. */
enum parameter_outside {
    OUTSIDE_REFUSE, /* :N-4 */
    OUTSIDE_CLIP,   /* acknowledged, set to the bound */
    OUTSIDE_IGNORE, /* acknowledged, nothing set */
};

enum parameter_saved {
    SAVED_BY_SS, /* SS Z */
    SAVED_AT_ONCE,
    SAVED_NEVER,
};

struct parameter {
    const char *command; /* long name of its command; NULL ends a table */
    char letter;         /* 'X' ..., or PARAMETER_AXES */
    enum parameter_type type;
    uint8_t decimals; /* printed, 0 to 9; PARAMETER_REAL only */
    uint8_t decimals_max; /* if larger: as many up to this as it takes to print the value exactly */
    const char *unit; /* NULL or "": none */
    const char *summary;
    double minimum, maximum;                /* both allowed */
    /**
     * What `check` leaves of that, for the command page: "-100 ... -0.1, 0.1 ... 100", or in words. Of
     * integers the page asks `check` itself, unless the answer hangs on other settings.
     */
    const char *taken;
    enum parameter_outside below, above;
    double initial;
    double (*initial_of)(unsigned axis); /* instead of `initial`, where axes differ; or NULL */
    enum parameter_saved saved;
    bool read_only; /* setting it is :N-4 */

    double *value; /* one, or AXIS_COUNT of them; NULL when `get` and `set` do it all */

    /* All optional. `axis` is 0 for a parameter that is not per axis. */
    enum status (*check)(unsigned axis, double value); /* refuse it; changes nothing */
    double (*adjust)(unsigned axis, double value);     /* what is stored instead (cut to counts) */
    void (*set)(unsigned axis, double value);          /* after the value is stored */
    double (*get)(unsigned axis);                      /* what a query prints instead of `value` */
    /**
     * X+ and X-. Called twice: with `act` false to judge (a fault is the reply), with `act` true
     * to act, when its status is not looked at. NULL: :N-4.
     */
    enum status (*sign)(unsigned axis, bool plus, bool act);
};

struct module;

/** Take the rows of a list of modules, ended by NULL. False: more of them than core/rows.h holds. */
bool command_init(const struct module *const *modules);

/** The list given to command_init. */
const struct module *const *command_modules(void);

/** The command of a verb (name or shortcut, upper case), or NULL. */
const struct command *command_find(const char *verb);

/**
 * Carry out a line. Writes the reply's text, without its end.
 *
 * @param request  Filled in, but for `acted`; must be kept while the status is STATUS_PENDING.
 * @param reply    Cleared by the caller.
 */
enum status command_execute(const char *line, size_t length, struct request *request,
                            struct reply *reply);

/**
 * Carry out a frame of the low-level format: axis, command, size, data, 58. What it writes is the
 * whole answer, without an end. False: no module knew it, which needs no answer.
 */
bool command_frame(const uint8_t *frame, struct reply *reply);

/** Go on with a request whose status was STATUS_PENDING. */
enum status command_resume(const struct request *request, struct reply *reply);

/** Call the command's `urgent`, if it has one, and return what it says; otherwise false. */
bool command_urgent(const char *line, size_t length);

/** Set a value as a command would: adjusted, stored, `set` called. No check. */
void parameter_store(const struct parameter *parameter, unsigned axis, double value);

/** Its value at a start with nothing kept. */
double parameter_initial(const struct parameter *parameter, unsigned axis);

/** The value a query prints. */
double parameter_value(const struct parameter *parameter, unsigned axis);

/** AXIS_COUNT, or 1. */
unsigned parameter_values(const struct parameter *parameter);

#endif
