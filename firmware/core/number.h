/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Decimal text to IEEE double and back, exactly and alike on target and host.
 *
 * Both directions work on integers of up to 1536 bits and never on floating point, so no compiler
 * flag, library or FPU can change a digit. No heap; about 400 bytes of stack.
 */
#ifndef CORE_NUMBER_H
#define CORE_NUMBER_H

#include <stddef.h>

enum number_status {
    NUMBER_OK,
    NUMBER_NONE,  /* the text does not start with a number */
    NUMBER_RANGE, /* larger than a double can be, or more than NUMBER_DIGITS_MAX digits */
};

enum {
    NUMBER_DIGITS_MAX = 128,  /* significant digits read */
    NUMBER_DECIMALS_MAX = 9,  /* decimals written */
    NUMBER_TEXT_MAX = 24,     /* characters written by number_format, at most; no final zero byte */
};

/**
 * Read a number at the start of a text: [+-] digits [. digits] [e [+-] digits].
 *
 * One digit at least, on either side of the point. An `e` not followed by an exponent is not part
 * of the number (`5E=1` is 5, then a letter E). Correctly rounded, ties to even; magnitudes below
 * 2^-1022 become 0; -0 becomes 0.
 *
 * @param text    Characters; need not end in a zero byte.
 * @param length  How many there are.
 * @param value   Result; untouched unless NUMBER_OK.
 * @param used    Characters that belong to the number, 0 for NUMBER_NONE.
 */
enum number_status number_parse(const char *text, size_t length, double *value, size_t *used);

/**
 * Write a number with a fixed count of decimals, as printf's "%.*f" does: correctly rounded from
 * the exact value of the double, ties to even, never an exponent. Unlike printf a result that is
 * all zeros has no minus sign: "-0.0" is never written.
 *
 * @param text      At least NUMBER_TEXT_MAX characters. No zero byte is appended.
 * @param decimals  0 to NUMBER_DECIMALS_MAX.
 * @return          Characters written; 0 when `value` is no finite number, has too many digits for
 *                  NUMBER_TEXT_MAX, or `decimals` is too large.
 */
size_t number_format(char *text, double value, unsigned decimals);

#endif
