/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * core/number against the C library of the host, which converts exactly. The only intended
 * difference is the missing minus sign of a zero.
 */
#include "core/number.h"

#include <inttypes.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "check.h"
#include "number_vectors.h"

static const char *formatted(double value, unsigned decimals)
{
    static char text[NUMBER_TEXT_MAX + 1];

    text[number_format(text, value, decimals)] = '\0';
    return text;
}

/* What the C library prints, without the minus sign of a zero; "" when longer than we print. */
static const char *expected(double value, unsigned decimals)
{
    static char text[400];

    snprintf(text, sizeof text, "%.*f", (int)decimals, value);
    if (text[0] == '-' && strspn(text, "-0.") == strlen(text))
        memmove(text, text + 1, strlen(text));
    if (strlen(text) > NUMBER_TEXT_MAX)
        text[0] = '\0';
    return text;
}

static bool parses(const char *text, double *value, size_t *used)
{
    return number_parse(text, strlen(text), value, used) == NUMBER_OK;
}

/* Same double, except that denormal results are 0 here. */
static bool parses_as_library(const char *text)
{
    double value = -1, library = strtod(text, NULL);
    size_t used;
    enum number_status status = number_parse(text, strlen(text), &value, &used);

    if (isinf(library))
        return status == NUMBER_RANGE;
    if (library == 0 || fpclassify(library) == FP_SUBNORMAL)
        library = 0;
    return status == NUMBER_OK && used == strlen(text) && memcmp(&value, &library, 8) == 0;
}

TEST(formats_a_million_random_values_as_the_library_does)
{
    uint64_t state = NUMBER_SEED;

    for (unsigned i = 0; i < 1000000; i++) {
        unsigned decimals;
        double value = number_vector(&state, &decimals);

        if (strcmp(formatted(value, decimals), expected(value, decimals)) != 0)
            CHECK_FAIL("%a with %u decimals is \"%s\", not \"%s\" (vector %u)", value, decimals,
                       formatted(value, decimals), expected(value, decimals), i);
    }
}

TEST(parses_a_million_printed_values_as_the_library_does)
{
    uint64_t state = NUMBER_SEED + 1;

    for (unsigned i = 0; i < 1000000; i++) {
        static const char *const formats[] = {"%.17g", "%.6f", "%.3e", "%.15g", "%+.9f", "%.25g"};
        unsigned decimals;
        double value = number_vector(&state, &decimals);
        char text[400];

        snprintf(text, sizeof text, formats[i % 6], value);
        if (strlen(text) < 120 && !parses_as_library(text))
            CHECK_FAIL("\"%s\" (vector %u)", text, i);
    }
}

TEST(parses_random_digit_strings_as_the_library_does)
{
    uint64_t state = NUMBER_SEED + 2;

    for (unsigned i = 0; i < 300000; i++) {
        char text[100];

        number_vector_text(&state, text);
        if (!parses_as_library(text))
            CHECK_FAIL("\"%s\" (vector %u)", text, i);
    }
}

/* Half-way between two doubles, and a digit far behind that breaks the tie. */
TEST(rounds_ties_to_even_and_sees_the_last_digit)
{
    uint64_t state = NUMBER_SEED + 3;

    for (unsigned i = 0; i < 20000; i++) {
        unsigned decimals;
        double value = fabs(number_vector(&state, &decimals));
        char text[200], longer[210];

        if (value < 1 || value > 1e15)
            continue;
        long double half = ((long double)value + nextafter(value, INFINITY)) / 2;

        snprintf(text, sizeof text, "%.60Lf", half);
        if (strlen(text) > NUMBER_DIGITS_MAX)
            continue;
        snprintf(longer, sizeof longer, "%s1", text);
        if (!parses_as_library(text) || !parses_as_library(longer))
            CHECK_FAIL("\"%s\"", text);
    }
}

TEST(reads_back_what_it_prints_with_enough_decimals)
{
    for (int thousandths = -200000; thousandths <= 200000; thousandths++) {
        double value = thousandths / 1000.0, read;
        size_t used;

        CHECK(parses(formatted(value, 3), &read, &used) && read == value);
    }
}

TEST(never_prints_an_exponent_or_a_negative_zero)
{
    CHECK_TEXT(formatted(-0.0, 1), "0.0");
    CHECK_TEXT(formatted(-0.04, 1), "0.0");
    CHECK_TEXT(formatted(-0.05, 1), "-0.1"); /* the double is a little below -0.05 */
    CHECK_TEXT(formatted(-0.4, 0), "0");
    CHECK_TEXT(formatted(1e-300, 9), "0.000000000");
    CHECK_TEXT(formatted(1e18, 0), "1000000000000000000");
    CHECK_TEXT(formatted(0.5, 0), "0");
    CHECK_TEXT(formatted(1.5, 0), "2");
    CHECK_TEXT(formatted(2.5, 0), "2");
}

TEST(refuses_to_print_what_has_no_digits_or_too_many)
{
    char text[NUMBER_TEXT_MAX];

    CHECK_INT(number_format(text, INFINITY, 1), 0);
    CHECK_INT(number_format(text, NAN, 1), 0);
    CHECK_INT(number_format(text, 1e300, 0), 0);
    CHECK_INT(number_format(text, 2e24, 0), 0);
    CHECK_INT(number_format(text, -1e22, 0), 24);
    CHECK_INT(number_format(text, 1, 10), 0);
}

TEST(takes_only_the_characters_of_the_number)
{
    static const struct {
        const char *text;
        size_t used;
        double value;
    } cases[] = {
        {"1Y=2", 1, 1},       {"5F=1.0", 1, 5},   {"6e-06 Y", 5, 6e-6}, {"5E=3", 1, 5},
        {"5E+", 1, 5},        {"1.2.3", 3, 1.2},  {".05", 3, .05},      {"5.", 2, 5},
        {"+7", 2, 7},         {"-109.5", 6, -109.5},
        {"0.7000000000000001", 18, 0.7000000000000001}, {"00001e0001", 10, 10},
        {"1e-99999999999", 14, 0}, {"0e99999999999", 13, 0},
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double value;
        size_t used;

        if (!parses(cases[i].text, &value, &used) || used != cases[i].used ||
            value != cases[i].value)
            CHECK_FAIL("\"%s\" gives %a, %zu characters", cases[i].text, value, used);
    }
}

TEST(says_when_there_is_no_number_or_it_is_too_large)
{
    static const char *const none[] = {"", ".", "-", "+.", "e5", "X", "--5", "-.e1"};
    static const char *const large[] = {"1e309", "2e308", "-1e99999", "1e2147483648"};
    double value = 42;
    size_t used;

    for (size_t i = 0; i < sizeof none / sizeof *none; i++)
        CHECK_INT(number_parse(none[i], strlen(none[i]), &value, &used), NUMBER_NONE);
    for (size_t i = 0; i < sizeof large / sizeof *large; i++)
        CHECK_INT(number_parse(large[i], strlen(large[i]), &value, &used), NUMBER_RANGE);
    CHECK(value == 42);
}

TEST(survives_a_thousand_digits)
{
    char text[1001];
    double value = 42;
    size_t used;

    memset(text, '9', 1000);
    CHECK_INT(number_parse(text, 1000, &value, &used), NUMBER_RANGE);
    memset(text, '0', 1000);
    CHECK_INT(number_parse(text, 1000, &value, &used), NUMBER_OK);
    CHECK(value == 0 && used == 1000);
    text[0] = '.';
    text[999] = '1';
    CHECK_INT(number_parse(text, 1000, &value, &used), NUMBER_OK);
    CHECK(value == 0);
}

/* The digest that the target must reproduce; it changes only with the vectors. */
TEST(gives_the_digest_the_target_is_compared_with)
{
    printf("# digest %08" PRIx32 "\n", number_digest(NUMBER_TARGET_COUNT));
    CHECK_INT(number_digest(NUMBER_TARGET_COUNT), number_digest(NUMBER_TARGET_COUNT));
    CHECK(number_digest(NUMBER_TARGET_COUNT) != number_digest(NUMBER_TARGET_COUNT - 1));
}

TEST_MAIN(RUN(formats_a_million_random_values_as_the_library_does);
          RUN(parses_a_million_printed_values_as_the_library_does);
          RUN(parses_random_digit_strings_as_the_library_does);
          RUN(rounds_ties_to_even_and_sees_the_last_digit);
          RUN(reads_back_what_it_prints_with_enough_decimals);
          RUN(never_prints_an_exponent_or_a_negative_zero);
          RUN(refuses_to_print_what_has_no_digits_or_too_many);
          RUN(takes_only_the_characters_of_the_number);
          RUN(says_when_there_is_no_number_or_it_is_too_large);
          RUN(survives_a_thousand_digits);
          RUN(gives_the_digest_the_target_is_compared_with))
