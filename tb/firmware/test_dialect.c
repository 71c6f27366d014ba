/* SPDX-License-Identifier: BSD-2-Clause */
/* The lines that the other tests send in the dialect of other hosts. */
#include "check.h"

#include <stdlib.h>

#include "dialect.h"

static const char *said(const char *line)
{
    static char text[500];

    text[dialect_write(line, text, sizeof text)] = '\0';
    return text;
}

TEST(numbers_have_exponents_blanks_go_and_cr_is_doubled)
{
    (void)setenv("DIALECT", "1", 1);
    CHECK_TEXT(said("M X=12.5 Y=-3 Z"), "M X=125e-01Y=-3e-00Z\r\r");
    CHECK_TEXT(said("PC X=.000006 Y?"), "PC X=000006e-06Y?\r\r");
    CHECK_TEXT(said("W X Y"), "W X Y\r\r"); /* XY=1 would be Y */
    CHECK_TEXT(said("M X=1e400 Y=1.2.3"), "M X=1e400Y=1.2.3\r\r");
    CHECK_TEXT(said("LCD \"a X=1\""), "LCD \"a X=1\"\r");
    (void)unsetenv("DIALECT");
    CHECK_TEXT(said("M X=12.5 Y=-3 Z"), "M X=12.5 Y=-3 Z\r");
}

TEST_MAIN(RUN(numbers_have_exponents_blanks_go_and_cr_is_doubled))
