/* SPDX-License-Identifier: BSD-2-Clause */
#include "dialect.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DIGITS "0123456789"

/* Length of a plain number with nothing glued to it, or 0. */
static size_t plain_number(const char *at)
{
    size_t sign = *at == '-', whole = strspn(at + sign, DIGITS), all = sign + whole;
    size_t fraction = 0;

    if (at[all] == '.') {
        fraction = strspn(at + all + 1, DIGITS);
        all += 1 + fraction;
    }
    return whole + fraction > 0 && whole + fraction < 17 && (at[all] == ' ' || at[all] == '\0')
               ? all : 0;
}

/* 12.5 as 125e-01. */
static size_t write_exponent(const char *number, size_t length, char *text)
{
    const char *point = memchr(number, '.', length);
    size_t decimals = point != NULL ? (size_t)(number + length - point - 1) : 0, used = 0;

    for (size_t n = 0; n < length; n++)
        if (number[n] != '.')
            text[used++] = number[n];
    return used + (size_t)sprintf(text + used, "e-%02zu", decimals);
}

static bool may_be_glued(char before, char after)
{
    return strchr(DIGITS "?", before) != NULL && ((after >= 'A' && after <= 'Z') ||
                                                  (after >= 'a' && after <= 'z'));
}

size_t dialect_write(const char *line, char *text, size_t size)
{
    size_t used = 0, length = strlen(line);
    bool otherwise = getenv("DIALECT") != NULL && strchr(line, '"') == NULL && length < 100 &&
                     4 * length < size;

    if (!otherwise) {
        memcpy(text, line, length);
        text[length] = '\r';
        return length + 1;
    }
    for (const char *at = line; *at != '\0'; at++) {
        size_t number = *at == '=' ? plain_number(at + 1) : 0;

        if (*at == ' ' && used > 0 && at > line && strchr(line, '=') != NULL &&
            strchr(line, ' ') != at && may_be_glued(at[-1], at[1]))
            continue;
        text[used++] = *at;
        if (number > 0) {
            used += write_exponent(at + 1, number, text + used);
            at += number;
        }
    }
    text[used++] = '\r';
    text[used++] = '\r';
    return used;
}
