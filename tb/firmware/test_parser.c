/* SPDX-License-Identifier: BSD-2-Clause */
/* core/parser: lines that hosts really send, and lines nobody should. Expected: written out. */
#include "core/parser.h"

#include "check.h"

/* The request as text: VERB, then each argument as X, X=5, X?, X+ or X-; then :status if not OK. */
static const char *parsed(const char *line)
{
    static char out[4000];
    struct request request;
    enum status status = parser_parse(line, strlen(line), &request);
    size_t used = (size_t)sprintf(out, "%s", request.verb);

    for (size_t i = 0; i < request.count; i++) {
        const struct argument *argument = &request.arguments[i];
        static const char marks[] = {[ARGUMENT_BARE] = 0, [ARGUMENT_QUERY] = '?',
                                     [ARGUMENT_PLUS] = '+', [ARGUMENT_MINUS] = '-'};

        used += (size_t)sprintf(out + used, " %c", argument->letter);
        if (argument->kind == ARGUMENT_VALUE)
            used += (size_t)sprintf(out + used, "=%.17g", argument->value);
        else if (argument->kind != ARGUMENT_BARE)
            out[used++] = marks[argument->kind];
        out[used] = '\0';
    }
    if (request.text != NULL)
        used += (size_t)sprintf(out + used, " '%.*s'%s", (int)request.text_length, request.text,
                                request.text_closed ? "" : "...");
    if (status != STATUS_OK)
        sprintf(out + used, " :%d", status);
    return out;
}

#define EXPECT(line, text) CHECK_TEXT(parsed(line), text)

TEST(reads_verb_and_arguments)
{
    EXPECT("M X=1234.5 Y=-2", "M X=1234.5 Y=-2");
    EXPECT("SL X=-50 Y=-50 Z?", "SL X=-50 Y=-50 Z?");
    EXPECT("MC X+ Y-", "MC X+ Y-");
    EXPECT("Z2B Z?", "Z2B Z?");
    EXPECT("/", "/");
    EXPECT("SCAN", "SCAN");
}

TEST(does_not_care_about_case)
{
    EXPECT("s x? y?", "S X? Y?");
    EXPECT("sCaNr x=0 Y=1 z=24", "SCANR X=0 Y=1 Z=24");
}

TEST(takes_arguments_without_blanks_between)
{
    EXPECT("SCANV X=0 Y=1 Z=5F=1.0", "SCANV X=0 Y=1 Z=5 F=1");
    EXPECT("SCANV X=0.1Y=0.1 Z=1 F=2", "SCANV X=0.10000000000000001 Y=0.10000000000000001 Z=1 F=2");
    EXPECT("M X=1Y=2", "M X=1 Y=2");
    EXPECT("RS X?Y?Z?", "RS X? Y? Z?");
    EXPECT("MC X+Y-", "MC X+ Y-");
}

TEST(splits_letters_that_run_together)
{
    EXPECT("W XYZ", "W X Y Z");
    EXPECT("H XY Z", "H X Y Z");
    EXPECT("RS X Y?", "RS X Y?");
}

TEST(ignores_letters_before_the_axis_letter)
{
    EXPECT("S VX=4.690000 VY=4.690000 ", "S X=4.6900000000000004 Y=4.6900000000000004");
    EXPECT("AC ACX=25.000000 ", "AC X=25");
    EXPECT("WT WTX=0.000000 ", "WT X=0");
    EXPECT("S VX?", "S X?");
}

TEST(takes_blanks_around_the_equals_sign)
{
    EXPECT("S X=5.74 Z= 1.2864", "S X=5.7400000000000002 Z=1.2864");
    EXPECT("S X = 5  Y  =6", "S X=5 Y=6");
    EXPECT("TTL  X=0  F=1", "TTL X=0 F=1");
    EXPECT("M X=0.000000 Y=0.000000 ", "M X=0 Y=0");
}

TEST(reads_exponents_and_long_numbers)
{
    EXPECT("PC X=6e-06 Y=6E-06", "PC X=6.0000000000000002e-06 Y=6.0000000000000002e-06");
    EXPECT("R x=0.7000000000000001", "R X=0.70000000000000007");
    EXPECT("S X=1e8", "S X=100000000");
    EXPECT("X X=5E=3", "X X=5 E=3"); /* E is a letter here */
    EXPECT("X X=5E", "X X=5 E");
}

TEST(glues_arguments_to_symbols)
{
    EXPECT("!X", "! X");
    EXPECT("@X=100Y=-100 Z", "@ X=100 Y=-100 Z");
    EXPECT("/ ", "/");
    EXPECT("! X Y ", "! X Y");
    EXPECT("~", "~");
}

TEST(gives_a_bare_number_a_letter_of_its_own)
{
    EXPECT("TTL Y=9 40", "TTL Y=9 #=40");
    EXPECT("M -5", "M #=-5");
    EXPECT("X X=1.2.3", "X X=1.2 #=0.29999999999999999");
}

TEST(keeps_the_case_of_quoted_text)
{
    EXPECT("lcd \"Hello, World = 5?\"", "LCD 'Hello, World = 5?'");
    EXPECT("LCD \"open", "LCD 'open'...");
    EXPECT("LCD \"\"", "LCD ''");
}

TEST(says_what_is_missing)
{
    EXPECT("SCANF =0", "SCANF :-3");
    EXPECT("M X=", "M :-3");
    EXPECT("M X=Y=1", "M :-3");
    EXPECT("M X=1 =2", "M X=1 :-3");
    EXPECT("S ?", "S :-3");
    EXPECT("V?", "V :-3");
    EXPECT("MC +", "MC :-3");
    EXPECT("M X=-", "M :-3");
    EXPECT("M X=inf", "M :-3");
}

TEST(refuses_numbers_beyond_a_double)
{
    EXPECT("M X=1e309", "M :-4");
    EXPECT("M X=1 Y=-1e999", "M X=1 :-4");
}

TEST(refuses_characters_that_belong_nowhere)
{
    EXPECT("M X=1,Y=2", "M X=1 :-6");
    EXPECT("M *", "M :-6");
    EXPECT("M X=0x10", "M X=0 X #=10"); /* no hexadecimal: a stray axis and number */
    EXPECT("\200\201", " :-6");
    EXPECT("M X=1 \200", "M X=1 :-6");
}

TEST(knows_no_verb_longer_than_any_command)
{
    EXPECT("ABCDEFGHIJKL X", "ABCDEFGHIJKL X");
    EXPECT("ABCDEFGHIJKLM X", " X");
    EXPECT("2H/", "2H :-6");
    EXPECT(":A", " :-6");
    EXPECT("", "");
}

TEST(bounds_the_number_of_arguments)
{
    EXPECT("W XXXXXXXXXXXXXXXXXXXXXXXXXXXXXXXX",
           "W X X X X X X X X X X X X X X X X X X X X X X X X X X X X X X X X");
    EXPECT("W XXXXXXXXXXXXXXXXXXXXXXXXXXXXXXXXX",
           "W X X X X X X X X X X X X X X X X X X X X X X X X X X X X X X X X :-6");
}

TEST(lets_the_last_argument_of_a_letter_count)
{
    struct request request;
    const char *line = "M X=1 Y=2 X=3";

    CHECK_INT(parser_parse(line, strlen(line), &request), STATUS_OK);
    CHECK(request_argument(&request, 'X')->value == 3);
    CHECK(request_argument(&request, 'Z') == NULL);
}

TEST_MAIN(RUN(reads_verb_and_arguments); RUN(does_not_care_about_case);
          RUN(takes_arguments_without_blanks_between); RUN(splits_letters_that_run_together);
          RUN(ignores_letters_before_the_axis_letter); RUN(takes_blanks_around_the_equals_sign);
          RUN(reads_exponents_and_long_numbers); RUN(glues_arguments_to_symbols);
          RUN(gives_a_bare_number_a_letter_of_its_own); RUN(keeps_the_case_of_quoted_text);
          RUN(says_what_is_missing); RUN(refuses_numbers_beyond_a_double);
          RUN(refuses_characters_that_belong_nowhere);
          RUN(knows_no_verb_longer_than_any_command); RUN(bounds_the_number_of_arguments);
          RUN(lets_the_last_argument_of_a_letter_count))
