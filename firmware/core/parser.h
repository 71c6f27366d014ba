/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * One line to a request. Pure; knows neither commands nor axes.
 *
 *     line      = verb { argument }
 *     verb      = letters and digits, or one of / \ ! @ ~ (arguments may be glued to these)
 *     argument  = word "=" number | word "?" | word "+" | word "-" | word | number | '"' text '"'
 *     word      = letters
 *
 * Not case sensitive; quoted text keeps its case. Blanks separate where needed, may surround `=`
 * and may end the line. In a word before `= ? + -` the last letter is the axis and those before it
 * are ignored (`VX=4.69`); in any other word each letter is a bare axis (`XYZ`). A number alone is
 * an argument of letter LETTER_NUMBER.
 */
#ifndef CORE_PARSER_H
#define CORE_PARSER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/status.h"

enum {
    VERB_MAX = 12,      /* characters; no command is longer */
    ARGUMENTS_MAX = 32, /* more in one line: STATUS_UNDEFINED */
    LETTER_NUMBER = '#',
};

/** Form of an argument; the values are bits so that a command can name the set it takes. */
enum argument_kind {
    ARGUMENT_BARE = 1,   /* X     a request, or 0 where a number is wanted */
    ARGUMENT_VALUE = 2,  /* X=5 */
    ARGUMENT_QUERY = 4,  /* X? */
    ARGUMENT_PLUS = 8,   /* X+ */
    ARGUMENT_MINUS = 16, /* X- */
};

struct argument {
    char letter; /* upper case, or LETTER_NUMBER */
    enum argument_kind kind;
    double value; /* 0 unless ARGUMENT_VALUE */
};

struct request {
    char verb[VERB_MAX + 1]; /* upper case, zero-ended; "" when too long to be any command */
    size_t count;            /* of arguments */
    struct argument arguments[ARGUMENTS_MAX];
    const char *text; /* quoted text inside the line, or NULL; valid as long as the line */
    size_t text_length;
    bool text_closed; /* the closing quote was there */
    bool acted; /* what the command's `urgent` returned for this line; not the parser's */
};

/**
 * Parse a line.
 *
 * @return  STATUS_OK; or, with `verb` and the arguments before the fault filled in,
 *          STATUS_MISSING    `=` without a number, or `= ? + -` without a letter before it,
 *          STATUS_RANGE      a number too large for a double,
 *          STATUS_UNDEFINED  a character that belongs nowhere, or too many arguments.
 */
enum status parser_parse(const char *line, size_t length, struct request *request);

/** The verb of a line alone, as in request.verb; `verb` has room for VERB_MAX + 1 characters. */
void parser_verb(const char *line, size_t length, char *verb);

/** The last argument of a letter, or NULL: what a command acts on when a letter is repeated. */
const struct argument *request_argument(const struct request *request, char letter);

#endif
