/* SPDX-License-Identifier: BSD-2-Clause */
/* core/command, reply and console over the sample module: exact bytes of every kind of answer. */
#include "core/command.h"
#include "core/fault.h"

#include "check.h"
#include "port.h"
#include "sample.h"

#define EXPECT(line, reply) CHECK_TEXT(port_send(line), reply "\r\n")

static void start(void)
{
    port_start(sample_modules);
}

TEST(acknowledges_with_a_blank_and_errors_without)
{
    start();
    EXPECT("L X=10", ":A ");
    EXPECT("NOSUCH", ":N-1");
    EXPECT("W Q", ":N-2");
    EXPECT("L", ":N-3");
    EXPECT("L X=0", ":N-4");
    EXPECT("FAIL X=1", ":N-5");
    EXPECT("L X=1,", ":N-6");
}

TEST(knows_long_name_and_shortcut_and_no_other)
{
    start();
    EXPECT("LEVEL X?", ":A X=5.000000");
    EXPECT("l x?", ":A X=5.000000");
    EXPECT("LEVE X?", ":N-1");
    EXPECT("LEVELS X?", ":N-1");
    EXPECT("TINTX?", ":N-1");
}

TEST(prints_each_form_of_query)
{
    start();
    EXPECT("L X? Y?", ":A X=5.000000 Y=5.000000");
    EXPECT("G X? Y? Z?", ":X=50 Y=50 Z=50 A");
    EXPECT("TINT X? Z?", "X=1 Z=24 :A");
    EXPECT("FENCE X? Y?", ":A 100 100");
    EXPECT("OFFSET X? Y?", ":A 0.0 0.0 ");
}

TEST(answers_in_hardware_axis_order_and_once)
{
    start();
    EXPECT("G F? Z? Y? X?", ":X=50 Y=50 Z=50 F=50 A");
    EXPECT("G Y? Y? X?", ":X=50 Y=50 A");
    EXPECT("TINT R? Z? X?", "X=1 Z=24 R=0.000 :A");
    EXPECT("W Z X", ":A 0.0 200.5 ");
}

TEST(mixes_sets_and_queries)
{
    start();
    EXPECT("G X=7 Y=8 Z?", ":Z=50 A");
    EXPECT("G X? Y?", ":X=7 Y=8 A");
    EXPECT("G X=9 X?", ":X=9 A"); /* queries come after the sets */
    EXPECT("G X=1 X=2", ":A ");
    EXPECT("G X?", ":X=2 A");
}

TEST(changes_nothing_when_one_argument_is_wrong)
{
    start();
    EXPECT("G X=7 Y=500", ":N-4");
    EXPECT("G X=7 Q=1", ":N-2");
    EXPECT("G X=7 Y=", ":N-3");
    EXPECT("G X=7 *", ":N-6");
    EXPECT("TINT Z=99 X=3", ":N-4");
    EXPECT("FENCE X=1 Y+", ":N-5");
    EXPECT("G X?", ":X=50 A");
    EXPECT("TINT Z?", "Z=24 :A");
    EXPECT("FENCE X?", ":A 100");
    CHECK_INT(sample_sets, 0);
}

TEST(reports_the_gravest_error_of_a_line)
{
    start();
    EXPECT("NOSUCH Q=1 X=", ":N-1");
    EXPECT("G X=500 Q=1", ":N-2");
    EXPECT("G Q=1 X=500", ":N-2");
    EXPECT("FENCE Y+ X=9999", ":N-4");
    EXPECT("FENCE X=9999 Y+", ":N-4");
}

TEST(takes_a_missing_number_as_zero)
{
    start();
    EXPECT("OFFSET X=4 Y=5", ":A ");
    EXPECT("OFFSET XY", ":A ");
    EXPECT("OFFSET X? Y?", ":A 0.0 0.0 ");
    EXPECT("L X", ":N-4"); /* 0 is out of range here */
}

TEST(treats_values_outside_the_range_as_the_row_says)
{
    start();
    EXPECT("L X=1000000000", ":A ");
    EXPECT("L X?", ":A X=100.000000");
    EXPECT("L X=0.5", ":N-4");
    EXPECT("G X=-101", ":A "); /* acknowledged, ignored */
    EXPECT("G X?", ":X=50 A");
    EXPECT("G X=101", ":N-4");
    EXPECT("G X=-100 Y=100", ":A ");
    EXPECT("G X? Y?", ":X=-100 Y=100 A");
}

TEST(cuts_fractions_off_integers)
{
    start();
    EXPECT("G X=7.9 Y=-7.9 Z=-0.5", ":A ");
    EXPECT("G X? Y? Z?", ":X=7 Y=-7 Z=0 A");
}

TEST(asks_the_check_and_stores_what_adjust_says)
{
    start();
    EXPECT("TINT X=3", ":N-4");
    EXPECT("TINT X=4 R=2.9", ":A ");
    EXPECT("TINT X? R?", "X=4 R=2.500 :A");
}

TEST(prints_as_many_decimals_as_the_value_needs)
{
    start();
    EXPECT("TINT Z=24.4", ":A ");
    EXPECT("TINT Z?", "Z=24.4 :A");
    EXPECT("TINT Z=38", ":A ");
    EXPECT("TINT Z?", "Z=38 :A");
    EXPECT("TINT Z=0.123456789", ":A ");
    EXPECT("TINT Z?", "Z=0.123457 :A");
}

TEST(refuses_to_set_what_is_read_only)
{
    start();
    EXPECT("L T?", ":A T=12.5");
    EXPECT("L T=5", ":N-4");
    EXPECT("L T+", ":N-4");
}

TEST(passes_plus_and_minus_to_the_row)
{
    start();
    EXPECT("FENCE X+", ":A ");
    EXPECT("FENCE X?", ":A 7");
    EXPECT("FENCE X-", ":A ");
    EXPECT("FENCE X?", ":A 100");
    EXPECT("G X+", ":N-4");
}

TEST(hands_letters_that_are_no_rows_to_the_handler)
{
    start();
    EXPECT("LAMP", "N");
    EXPECT("LAMP S", ":A ");
    EXPECT("LAMP", "B");
    EXPECT("/", "B");
    EXPECT("LAMP P", ":A ");
    EXPECT("LAMP Q", ":N-2");
    EXPECT("LAMP S=1", ":N-4");
    EXPECT("LAMP S P", ":N-4"); /* the check of the whole line */
    EXPECT("STATUS X", ":N-2");
    EXPECT("FAIL", ":N-3");
    EXPECT("G", ":N-3");
}

TEST(shares_a_line_between_rows_and_handler)
{
    start();
    EXPECT("LAMP F=5 S", ":A ");
    EXPECT("LAMP F? S", ":A F=5");
    EXPECT("LAMP P F?", ":A F=5");
    EXPECT("LAMP", "N");
    EXPECT("LAMP F=10 S", ":N-4");
    EXPECT("LAMP F=10 Q", ":N-2");
    EXPECT("LAMP Q F=10", ":N-2");
    EXPECT("LAMP F=7 S=1", ":N-4");
    EXPECT("LAMP", "N");
    EXPECT("LAMP F?", ":A F=5");
}

TEST(drops_the_text_of_a_handler_that_fails)
{
    start();
    EXPECT("FAIL X=1", ":N-5");
    CHECK_INT(fault_read(0), FAULT_ENCODER);
}

TEST(can_stay_silent)
{
    start();
    CHECK_TEXT(port_send("SILENT Q"), "");
    EXPECT("LAMP", "N");
}

TEST(answers_n6_rather_than_overrun_a_reply)
{
    start();
    EXPECT("FLOOD", ":N-6");
    EXPECT("OFFSET X=1e9", ":A ");
    EXPECT("OFFSET X?", ":A 1000000000.0 ");
}

TEST(ends_inner_lines_in_cr_and_the_last_in_crlf)
{
    const char *text, *last;
    char line[64];

    start();
    text = port_send("STORY");
    for (int i = 0; i < 40; i++) {
        int length = snprintf(line, sizeof line, "line%-29d     value    1.50%s", i,
                              i == 39 ? "\r\n" : "\r");

        CHECK(strncmp(text, line, (size_t)length) == 0);
        last = text += length;
    }
    CHECK_TEXT(last, "");
}

TEST(answers_pipelined_commands_in_order)
{
    start();
    CHECK_TEXT(port_text("G X=1\rG X?\rNOSUCH\rLAMP\r"), ":A \r\n:X=1 A\r\n:N-1\r\nN\r\n");
}

TEST(queues_a_kilobyte_and_answers_every_line_while_a_reply_waits)
{
    const char *text;

    start();
    port_hold();
    port_queue("STORY\r");
    port_take(0);
    for (int i = 0; i < 140; i++) /* 980 bytes */
        port_queue("G X=77\r");
    for (int i = 0; i < 20; i++)
        port_take(0);
    port_queue("\rG X?\r");
    text = port_take(8000);
    for (int i = 0; i < 300 && strstr(text, ":X=77 A") == NULL; i++)
        text = port_take(8000);
    CHECK(strstr(text, ":X=77 A\r\n") != NULL);
}

TEST(answers_n6_in_its_turn_for_every_line_that_no_longer_fits)
{
    int lost = 0, done = 0;

    start();
    port_hold();
    port_queue("STORY\r");
    port_take(0);
    for (int i = 0; i < 300; i++) { /* 2100 bytes into a queue of 1024 */
        port_queue("G X=77\r");
        port_take(0);
    }
    for (int i = 0; i < 2000; i++) {
        const char *text = port_take(8000);

        lost += strcmp(text, ":N-6\r\n") == 0;
        done += strcmp(text, ":A \r\n") == 0;
    }
    CHECK(done >= 130);
    CHECK_INT(done + lost, 300);
    port_queue("LAMP\r");
    CHECK_TEXT(port_take(8000), "N\r\n");
    port_take(8000);
    CHECK(console_idle(&port_console));
}

TEST(answers_halt_behind_lines_that_no_longer_fit_and_then_goes_on)
{
    static char all[16384];
    size_t length = 0;

    start();
    CHECK_TEXT(port_send("LAMP S"), ":A \r\n");
    port_hold();
    port_queue("STORY\r");
    port_take(0);
    for (int i = 0; i < 300; i++) {
        port_queue("G X=77\r");
        port_take(0);
    }
    port_queue("\\\rG X=77\r");
    port_take(0);
    CHECK_INT(sample_urgent, 1);
    for (int i = 0; i < 2000; i++) {
        const char *text = port_take(8000);

        if (i == 1000)
            port_queue("LAMP\r");
        memcpy(all + length, text, strlen(text) + 1);
        length += strlen(text);
    }
    const char *halted = strstr(all, ":N-6\r\n:N-21\r\n");

    CHECK(halted != NULL);
    CHECK_TEXT(halted, ":N-6\r\n:N-21\r\n:N-6\r\nN\r\n");
}

TEST(halts_at_once_while_a_long_reply_waits)
{
    start();
    CHECK_TEXT(port_send("LAMP S"), ":A \r\n");
    port_hold();
    port_queue("STORY\rG X=3\r\\");
    port_take(0);
    CHECK_INT(sample_urgent, 1); /* acted; the reply comes in its turn */
    port_queue("\rHALT\r");
    port_take(0);
    CHECK_INT(sample_urgent, 2);
    CHECK(sample_lit);
    const char *text = "";
    for (int i = 0; i < 300 && strcmp(text, ":N-21\r\n") != 0; i++)
        text = port_take(8000);
    CHECK_TEXT(text, ":N-21\r\n");
    CHECK_TEXT(port_take(8000), ":A \r\n");
}

TEST(answers_halt_once_with_and_without_its_end)
{
    start();
    CHECK_TEXT(port_text("\\\r"), ":A \r\n");
    CHECK_TEXT(port_text("HALT\r"), ":A \r\n");
    CHECK_TEXT(port_text("\\r"), ":A \r\n"); /* backslash, r and no CR */
    CHECK_TEXT(port_text("LAMP\r"), "N\r\n");
    CHECK_TEXT(port_text("\\r"), ":A \r\n");
    CHECK_TEXT(port_text("\r"), "");
    CHECK_INT(sample_urgent, 4);
}

TEST(forgets_waiting_lines_at_an_abort_key)
{
    start();
    port_hold();
    port_queue("STORY\rG X=3\rG Y=\b");
    port_take(0);
    for (int i = 0; i < 300; i++)
        port_take(8000);
    CHECK(console_idle(&port_console));
    port_queue("G X?\r");
    CHECK_TEXT(port_take(8000), ":X=50 A\r\n");
}

TEST(sets_the_precision_of_where_by_control)
{
    start();
    EXPECT("W X Y", ":A 0.0 100.2 ");
    CHECK_TEXT(port_bytes("\377T", 2), "");
    EXPECT("W X Y", ":A 0 100 ");
    CHECK_TEXT(port_bytes("\377H", 2), "");
    EXPECT("W X Y", ":A 0.0 100.2 ");
}

/* The nasty inputs: each gets the answer of the language, and the next good command works. */
TEST(survives_nasty_lines)
{
    char text[400];

    start();
    EXPECT("SCANF =0", ":N-1");
    EXPECT("XYZZY X=1", ":N-1");
    EXPECT("L", ":N-3");
    EXPECT("L Q=1", ":N-2");
    memset(text, 'A', 300);
    text[300] = '\0';
    EXPECT(text, ":N-6");
    memset(text, '?', 128);
    text[128] = '\0';
    EXPECT(text, ":N-1");
    EXPECT("LAMP", "N");
}

TEST(finds_no_name_twice_in_the_tables)
{
    for (const struct command *a = sample_module.commands; a->name != NULL; a++)
        for (const struct command *b = a + 1; b->name != NULL; b++)
            CHECK(strcmp(a->name, b->name) != 0);
}

TEST_MAIN(RUN(acknowledges_with_a_blank_and_errors_without);
          RUN(knows_long_name_and_shortcut_and_no_other); RUN(prints_each_form_of_query);
          RUN(answers_in_hardware_axis_order_and_once); RUN(mixes_sets_and_queries);
          RUN(changes_nothing_when_one_argument_is_wrong);
          RUN(reports_the_gravest_error_of_a_line); RUN(takes_a_missing_number_as_zero);
          RUN(treats_values_outside_the_range_as_the_row_says); RUN(cuts_fractions_off_integers);
          RUN(asks_the_check_and_stores_what_adjust_says);
          RUN(prints_as_many_decimals_as_the_value_needs);
          RUN(refuses_to_set_what_is_read_only); RUN(passes_plus_and_minus_to_the_row);
          RUN(hands_letters_that_are_no_rows_to_the_handler);
          RUN(shares_a_line_between_rows_and_handler);
          RUN(drops_the_text_of_a_handler_that_fails); RUN(can_stay_silent);
          RUN(answers_n6_rather_than_overrun_a_reply);
          RUN(ends_inner_lines_in_cr_and_the_last_in_crlf);
          RUN(answers_pipelined_commands_in_order);
          RUN(queues_a_kilobyte_and_answers_every_line_while_a_reply_waits);
          RUN(answers_n6_in_its_turn_for_every_line_that_no_longer_fits);
          RUN(answers_halt_behind_lines_that_no_longer_fit_and_then_goes_on);
          RUN(halts_at_once_while_a_long_reply_waits);
          RUN(answers_halt_once_with_and_without_its_end);
          RUN(forgets_waiting_lines_at_an_abort_key);
          RUN(sets_the_precision_of_where_by_control); RUN(survives_nasty_lines);
          RUN(finds_no_name_twice_in_the_tables))
