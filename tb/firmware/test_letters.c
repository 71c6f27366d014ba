/* SPDX-License-Identifier: BSD-2-Clause */
/* Z2B and UNLOCK F: other letters for axes. */
#include "check.h"

#include "machine.h"

#define SEND(text, reply) CHECK_TEXT(machine_send(text), reply)
#define DONE ":A \r\n"

TEST(queries_tell_the_number_of_the_axis)
{
    machine_start();
    SEND("Z2B Y?", ":A Y=1\r\n");
    SEND("Z2B Z? X?", ":A X=0 Z=2\r\n");
    SEND("UL F?", ":A F=2\r\n");
    SEND("UL F=1", ":N-4\r\n");
    SEND("UL X?", ":N-2\r\n");
}

TEST(a_new_letter_counts_after_a_save_and_a_start)
{
    machine_start();
    SEND("Z2B Z=66", DONE);
    SEND("W Z", ":A 0.0 \r\n");
    SEND("W B", ":N-2\r\n");
    SEND("S Z=2.5", DONE);
    SEND("SS Z", DONE);
    machine_start();
    SEND("W Z", ":N-2\r\n");
    SEND("S F? B? X?", ":A X=4.556000 B=2.500000 F=4.556000\r\n"); /* hardware order */
    SEND("M B=1000", DONE);
    CHECK(strstr(machine_send("BU X"), "\rMotor Axes: X Y B F  \r") != NULL);
    CHECK(strncmp(machine_send("I B"), "Axis Name ChB:         B", 24) == 0);
    SEND("Z2B B=90", DONE);
    SEND("SS Z", DONE);
    machine_start();
    SEND("S Z?", ":A Z=2.500000\r\n");
}

TEST(without_a_save_nothing_changes)
{
    machine_start();
    SEND("Z2B Z=66", DONE);
    machine_start();
    SEND("W Z", ":A 0.0 \r\n");
}

TEST(a_letter_that_is_taken_or_none_is_refused)
{
    machine_start();
    SEND("Z2B Z=88", ":N-4\r\n"); /* X */
    SEND("Z2B Z=64", ":N-4\r\n");
    SEND("Z2B Z=91", ":N-4\r\n");
    SEND("Z2B Z=66", DONE);
    SEND("Z2B X=66", ":N-4\r\n"); /* will be Z's */
    SEND("Z2B X=90", ":N-4\r\n"); /* is Z's still */
    SEND("Z2B Z=90", DONE);
}

TEST_MAIN(RUN(queries_tell_the_number_of_the_axis);
          RUN(a_new_letter_counts_after_a_save_and_a_start); RUN(without_a_save_nothing_changes);
          RUN(a_letter_that_is_taken_or_none_is_refused))
