/* SPDX-License-Identifier: BSD-2-Clause */
/* LCD and UNITS. */
#include "check.h"

#include "machine.h"
#include "modules/display.h"

#define SEND(text, reply) CHECK_TEXT(machine_send(text), reply)
#define DONE ":A \r\n"

TEST(keeps_text_in_quotes_with_its_case)
{
    machine_start();
    SEND("lcd \"Hello, World 1=2?\"", DONE);
    CHECK_TEXT(display_text(), "Hello, World 1=2?");
    SEND("LCD \"12345678901234567890123\"", DONE);
    CHECK_TEXT(display_text(), "12345678901234567890");
}

TEST(clears_at_anything_else)
{
    static const char *const others[] = {"LCD", "LCD ?", "LCD \"open", "LCD open", "LCD =", "LCD X="};

    machine_start();
    for (unsigned n = 0; n < sizeof others / sizeof *others; n++) {
        SEND("LCD \"text\"", DONE);
        CHECK_TEXT(display_text(), "text");
        SEND(others[n], DONE);
        CHECK_TEXT(display_text(), "");
    }
}

TEST(units_go_to_and_fro)
{
    machine_start();
    CHECK(!display_inches());
    SEND("UN", DONE);
    CHECK(display_inches());
    SEND("UNITS", DONE);
    CHECK(!display_inches());
}

TEST_MAIN(RUN(keeps_text_in_quotes_with_its_case); RUN(clears_at_anything_else);
          RUN(units_go_to_and_fro))
