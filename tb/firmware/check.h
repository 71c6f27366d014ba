/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The smallest test runner that does: each test prints one line, `ok NAME` or `not ok NAME: why`.
 *
 *     TEST(adds_two_numbers) { CHECK(1 + 1 == 2); CHECK_INT(1 + 1, 2); CHECK_TEXT(name, "abbe"); }
 *     TEST_MAIN(RUN(adds_two_numbers))
 *
 * A failed check leaves the test. The exit status is 1 when any failed. With an argument only the
 * test of that name is run (test_host.py does so), and it is an error when there is none.
 */
#ifndef TB_FIRMWARE_CHECK_H
#define TB_FIRMWARE_CHECK_H

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static bool check_failed;
static bool check_any_failed;
static bool check_any_run;
static const char *check_only;

#define TEST(name) static void name(void)

#define CHECK_FAIL(...)                                                                            \
    do {                                                                                           \
        char check_text[1200];                                                                     \
        snprintf(check_text, sizeof check_text, __VA_ARGS__);                                      \
        printf("not ok %s: line %d: %s\n", __func__, __LINE__, check_text);                        \
        check_failed = true;                                                                       \
        return;                                                                                    \
    } while (0)

#define CHECK(condition)                                                                           \
    do {                                                                                           \
        if (!(condition))                                                                          \
            CHECK_FAIL("%s", #condition);                                                          \
    } while (0)

#define CHECK_INT(actual, expected)                                                                \
    do {                                                                                           \
        long long check_a = (long long)(actual), check_e = (long long)(expected);                  \
        if (check_a != check_e)                                                                    \
            CHECK_FAIL("%s is %lld, not %lld", #actual, check_a, check_e);                         \
    } while (0)

#define CHECK_TEXT(actual, expected)                                                               \
    do {                                                                                           \
        const char *check_a = (actual), *check_e = (expected);                                     \
        if (strcmp(check_a, check_e) != 0)                                                         \
            CHECK_FAIL("%s is \"%s\", not \"%s\"", #actual, check_a, check_e);                     \
    } while (0)

#define RUN(name)                                                                                  \
    do {                                                                                           \
        if (check_only != NULL && strcmp(check_only, #name) != 0)                                  \
            break;                                                                                 \
        check_any_run = true;                                                                      \
        check_failed = false;                                                                      \
        name();                                                                                    \
        if (!check_failed)                                                                         \
            printf("ok %s\n", #name);                                                              \
        check_any_failed |= check_failed;                                                          \
        fflush(stdout);                                                                            \
    } while (0)

#define TEST_MAIN(...)                                                                             \
    int main(int argc, char **argv)                                                                \
    {                                                                                              \
        check_only = argc > 1 ? argv[1] : NULL;                                                    \
        __VA_ARGS__;                                                                               \
        return check_any_failed || !check_any_run ? 1 : 0;                                                         \
    }

#endif
