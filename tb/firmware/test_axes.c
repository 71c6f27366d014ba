/* SPDX-License-Identifier: BSD-2-Clause */
/* Axes fitted and not fitted, for the AXIS_COUNT this is built with (test_axes.py: another). */
#include "check.h"
#include "core/axis.h"
#include "machine.h"

static const char *send(const char *format, char letter)
{
    static char line[64];

    snprintf(line, sizeof line, format, letter);
    return machine_send(line);
}

TEST(fitted_axes_are_named_and_answer)
{
    char axes[16] = "", where[64] = ":A ";

    machine_start();
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        strcat(where, "0.0 ");
        snprintf(axes + 2 * axis, 3, "%c ", AXIS_LETTERS[axis]);
        CHECK_TEXT(send("W %c", AXIS_LETTERS[axis]), ":A 0.0 \r\n");
        CHECK_TEXT(send("H %c=5", AXIS_LETTERS[axis]), ":A \r\n");
        CHECK_TEXT(send("H %c", AXIS_LETTERS[axis]), ":A \r\n");
    }
    strcat(where, "\r\n");
    CHECK_TEXT(machine_send("W"), where);
    CHECK(strstr(machine_send("BU X"), axes) != NULL);
}

TEST(axes_not_fitted_are_unknown_and_leave_the_others_alone)
{
    machine_start();
    for (const char *letter = &(AXIS_LETTERS "Q")[AXIS_COUNT]; *letter != '\0'; letter++) {
        CHECK_TEXT(send("W %c", *letter), ":N-2\r\n");
        CHECK_TEXT(send("M X=100 %c=1", *letter), ":N-2\r\n");
        CHECK_TEXT(send("S %c?", *letter), ":N-2\r\n");
        CHECK_TEXT(send("H X=77 %c", *letter), ":N-2\r\n");
    }
    CHECK_TEXT(machine_send("/"), "N\r\n");
    CHECK_TEXT(machine_send("W X"), ":A 0.0 \r\n");
}

/* Letters of pseudo axes exist whatever axes are fitted. */
TEST(parameter_letters_do_not_depend_on_the_axes)
{
    machine_start();
    CHECK_TEXT(machine_send("TTL F?"), ":A F=1\r\n");
    CHECK_TEXT(machine_send("SCANR X=0.5 Z=24.4"), ":A \r\n");
}

TEST_MAIN(RUN(fitted_axes_are_named_and_answer);
          RUN(axes_not_fitted_are_unknown_and_leave_the_others_alone);
          RUN(parameter_letters_do_not_depend_on_the_axes))
