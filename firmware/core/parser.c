/* SPDX-License-Identifier: BSD-2-Clause */
#include "core/parser.h"

#include <string.h>

#include "core/number.h"

/* The rest of a line. */
struct cursor {
    const char *at, *end;
};

static char peek(const struct cursor *cursor)
{
    return cursor->at < cursor->end ? *cursor->at : '\0';
}

static void skip_blanks(struct cursor *cursor)
{
    while (peek(cursor) == ' ' || peek(cursor) == '\t')
        cursor->at++;
}

static char upper(char character)
{
    return character >= 'a' && character <= 'z' ? (char)(character - 'a' + 'A') : character;
}

static bool is_letter(char character)
{
    return upper(character) >= 'A' && upper(character) <= 'Z';
}

static bool starts_number(char character)
{
    return (character >= '0' && character <= '9') || character == '.';
}

static bool is_symbol(char character)
{
    return character != '\0' && strchr("/\\!@~", character) != NULL;
}

static void take_verb(struct cursor *cursor, char *verb)
{
    size_t length = 0;

    memset(verb, 0, VERB_MAX + 1);
    if (is_symbol(peek(cursor))) {
        verb[0] = *cursor->at++;
        return;
    }
    for (; is_letter(peek(cursor)) || (peek(cursor) >= '0' && peek(cursor) <= '9'); length++) {
        if (length < VERB_MAX)
            verb[length] = upper(peek(cursor));
        cursor->at++;
    }
    if (length > VERB_MAX)
        memset(verb, 0, VERB_MAX + 1);
}

static enum status add(struct request *request, char letter, enum argument_kind kind, double value)
{
    if (request->count == ARGUMENTS_MAX)
        return STATUS_UNDEFINED;
    request->arguments[request->count++] =
        (struct argument){.letter = upper(letter), .kind = kind, .value = value};
    return STATUS_OK;
}

static enum status take_number(struct cursor *cursor, struct request *request, char letter)
{
    double value;
    size_t used;

    switch (number_parse(cursor->at, (size_t)(cursor->end - cursor->at), &value, &used)) {
    case NUMBER_NONE:
        return STATUS_MISSING;
    case NUMBER_RANGE:
        return STATUS_RANGE;
    default:
        cursor->at += used;
        return add(request, letter, ARGUMENT_VALUE, value);
    }
}

/* A run of letters and what follows it. Only `=` may stand apart from its letter. */
static enum status take_word(struct cursor *cursor, struct request *request)
{
    const char *word = cursor->at;

    while (is_letter(peek(cursor)))
        cursor->at++;
    const char *end = cursor->at;
    char follower = peek(cursor);

    if (follower == '?' || follower == '+' || follower == '-') {
        cursor->at++;
        return add(request, end[-1],
                   follower == '?'   ? ARGUMENT_QUERY
                   : follower == '+' ? ARGUMENT_PLUS
                                     : ARGUMENT_MINUS,
                   0);
    }
    skip_blanks(cursor);
    if (peek(cursor) == '=') {
        cursor->at++;
        skip_blanks(cursor);
        return take_number(cursor, request, end[-1]);
    }
    for (; word < end; word++) {
        enum status status = add(request, *word, ARGUMENT_BARE, 0);

        if (status != STATUS_OK)
            return status;
    }
    return STATUS_OK;
}

static void take_text(struct cursor *cursor, struct request *request)
{
    const char *start = ++cursor->at;

    while (cursor->at < cursor->end && *cursor->at != '"')
        cursor->at++;
    request->text = start;
    request->text_length = (size_t)(cursor->at - start);
    request->text_closed = cursor->at < cursor->end;
    if (request->text_closed)
        cursor->at++;
}

static enum status take_argument(struct cursor *cursor, struct request *request)
{
    char first = peek(cursor);

    if (is_letter(first))
        return take_word(cursor, request);
    if (starts_number(first))
        return take_number(cursor, request, LETTER_NUMBER);
    switch (first) {
    case '"':
        take_text(cursor, request);
        return STATUS_OK;
    case '+':
    case '-':
        /* A signed number alone, or a sign without its letter. */
        return take_number(cursor, request, LETTER_NUMBER);
    case '=':
    case '?':
        return STATUS_MISSING;
    default:
        return STATUS_UNDEFINED;
    }
}

enum status parser_parse(const char *line, size_t length, struct request *request)
{
    struct cursor cursor = {.at = line, .end = line + length};
    enum status status = STATUS_OK;

    request->count = 0;
    request->text = NULL;
    request->text_length = 0;
    request->text_closed = false;
    skip_blanks(&cursor);
    take_verb(&cursor, request->verb);
    skip_blanks(&cursor);
    while (status == STATUS_OK && cursor.at < cursor.end) {
        status = take_argument(&cursor, request);
        skip_blanks(&cursor);
    }
    return status;
}

void parser_verb(const char *line, size_t length, char *verb)
{
    struct cursor cursor = {.at = line, .end = line + length};

    skip_blanks(&cursor);
    take_verb(&cursor, verb);
}

const struct argument *request_argument(const struct request *request, char letter)
{
    for (size_t i = request->count; i-- > 0;)
        if (request->arguments[i].letter == letter)
            return &request->arguments[i];
    return NULL;
}
