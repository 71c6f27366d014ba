/* SPDX-License-Identifier: BSD-2-Clause */
/* core/line: bytes to lines. Expected: the sequence of events, written out. */
#include "core/line.h"

#include "check.h"

/* Everything the bytes bring about, as text: "[W X]" a line, "!" HALT, "~" clear, "^" too long,
 * "<66>" a control, "{24 T 7}" a frame: axis, command, length. */
static const char *events_of(const char *bytes, size_t length)
{
    static char out[4096];
    static const char marks[] = {[LINE_TOO_LONG] = '^', [LINE_HALT] = '!', [LINE_CLEAR] = '~'};
    struct line line;
    enum line_event event;
    size_t used = 0;

    line_init(&line);
    for (size_t i = 0; i < length; i++) {
        line_put(&line, (uint8_t)bytes[i]);
        while ((event = line_next(&line)) != LINE_NONE) {
            if (event == LINE_READY)
                used += (size_t)sprintf(out + used, "[%.*s]", (int)line.length, line.text);
            else if (event == LINE_CONTROL)
                used += (size_t)sprintf(out + used, "<%d>", line.control);
            else if (event == LINE_FRAME)
                used += (size_t)sprintf(out + used, "{%d %c %d}", line.frame[0], line.frame[1],
                                        (int)line.frame_length);
            else
                out[used++] = marks[event];
        }
    }
    out[used] = '\0';
    return out;
}

#define EXPECT(bytes, events) CHECK_TEXT(events_of(bytes, sizeof(bytes) - 1), events)

TEST(ends_a_line_at_carriage_return)
{
    EXPECT("W X\rM Y=1\r", "[W X][M Y=1]");
    EXPECT("W X", "");
}

TEST(says_nothing_to_an_empty_line)
{
    EXPECT("\r\r\n\r  \r\t\r/\r\r", "[/]");
}

TEST(ignores_line_feed_and_other_control_bytes)
{
    EXPECT("\nW X\r\nW Y\r", "[W X][W Y]");
    EXPECT("\n\001\021\023W\023 X\n\r", "[W X]");
}

TEST(skips_leading_blanks_and_keeps_the_rest)
{
    EXPECT("  TTL  X=0__\r", "[TTL  X=0__]");
    EXPECT("M X=1 \r", "[M X=1 ]");
    EXPECT("M\tX\r", "[M X]");
}

TEST(clears_the_line_at_backspace_delete_and_escape)
{
    EXPECT("W X\bW Y\r", "~[W Y]");
    EXPECT("W X\177W Y\r", "~[W Y]");
    EXPECT("W X\033W Y\r", "~[W Y]");
}

TEST(takes_128_characters_and_drops_129)
{
    char text[400];

    memset(text, 'A', sizeof text);
    text[128] = '\r';
    CHECK_INT(strlen(events_of(text, 129)), 130);
    text[128] = 'A';
    text[129] = '\r';
    CHECK_TEXT(events_of(text, 130), "^");
    memset(text, 'A', 300);
    memcpy(text + 300, "\rW X\r", 5);
    CHECK_TEXT(events_of(text, 305), "^[W X]");
    memcpy(text + 300, "\bW X\r", 5);
    CHECK_TEXT(events_of(text, 305), "~[W X]");
}

TEST(halts_at_the_backslash_without_waiting)
{
    EXPECT("\\", "!");
    EXPECT("\\\rW X\r", "![W X]");
    EXPECT("  \\\r", "!");
    EXPECT("W X\r\\", "[W X]!");
    EXPECT("\\\\\r", "!!");
}

TEST(does_not_halt_at_a_backslash_inside_a_line)
{
    EXPECT("LCD \\\r", "[LCD \\]");
}

TEST(runs_the_command_glued_behind_an_unterminated_halt)
{
    EXPECT("\\rW XYZ\r", "![W XYZ]"); /* the two characters backslash and r, no CR */
    EXPECT("\\rr x=5\r", "![r x=5]");
    EXPECT("\\r\\rW X\r", "!![W X]");
    EXPECT("\\W X\r", "![W X]");
    EXPECT("\\RS X\r", "![RS X]");
    EXPECT("\\r\rW X\r", "![W X]");
}

TEST(takes_what_follows_halt_and_a_blank_as_part_of_halt)
{
    EXPECT("\\ X Y\rW X\r", "![W X]");
    EXPECT("\\r x=5\rW X\r", "![W X]"); /* not a move: HALT must not be followed by one by accident */
    EXPECT("\\ \\\rW X\r", "![W X]");
}

TEST(takes_two_byte_controls_anywhere)
{
    EXPECT("\377H\377T\377R", "<72><84><82>");
    EXPECT("W\377H X\r", "<72>[W X]");
    EXPECT("W\377\001 X\r", "[W X]"); /* unknown: both dropped */
    EXPECT("W\377\377H X\r", "<72>[W X]");
    EXPECT("W X\377\r", "[W X]"); /* a CR is never swallowed */
    EXPECT("W X\377A/\r", "<65>[/]");
}

TEST(takes_binary_frames_until_told_otherwise)
{
    EXPECT("\377B\030T\003\240\206\001:W X\r\377AW Y\r", "<66>{24 T 7}<65>[W Y]");
    EXPECT("\377B\030?\000:\032a\003::::\377A/\r", "<66>{24 ? 4}{26 a 4}<65>[/]");
    EXPECT("\377B\030D\003:::::\377A/\r", "<66>{24 D 7}<65>[/]");
}

TEST(takes_255_65_inside_a_frame_as_data)
{
    EXPECT("\377B\030T\003\377A\000:\377AW Y\r", "<66>{24 T 7}<65>[W Y]");
    EXPECT("\377B\030T\004\377A\377A:/\r\377A/\r", "<66>{24 T 8}<65>[/]");
}

TEST(finds_255_65_behind_the_noise_of_a_frame_that_never_ends)
{
    /* Waiting for up to five more bytes when the real 255 65 comes; nothing after it is lost. */
    EXPECT("\377Bab\004\r\377A\rW X\r", "<66><65>[W X]");
    EXPECT("\377Bab\004\377A/\r/\r", "<66><65>[/][/]");
    EXPECT("\377Bab\003\377A/\r/\r", "<66><65>[/][/]");
    EXPECT("\377Ba\377A/\r/\r", "<66><65>[/][/]");
    EXPECT("\377Bab\377A/\r/\r", "<66><65>[/][/]");
    EXPECT("\377Bab\002\377A/\r/\r", "<66><65>[/][/]");
    EXPECT("\377Babc\377A/\r/\r", "<66><65>[/][/]");
    EXPECT("\377BaT\004\r\377A\rW X\r", "<66><65>[W X]");
    EXPECT("\377BaT\003\377A/\r/\r", "<66><65>[/][/]");
}

TEST(understands_controls_in_binary_mode)
{
    EXPECT("\377B\377H\377R\377\377T\377A/\r", "<66><72><82><84><65>[/]");
}

TEST_MAIN(RUN(ends_a_line_at_carriage_return); RUN(says_nothing_to_an_empty_line);
          RUN(ignores_line_feed_and_other_control_bytes);
          RUN(skips_leading_blanks_and_keeps_the_rest);
          RUN(clears_the_line_at_backspace_delete_and_escape);
          RUN(takes_128_characters_and_drops_129); RUN(halts_at_the_backslash_without_waiting);
          RUN(does_not_halt_at_a_backslash_inside_a_line);
          RUN(runs_the_command_glued_behind_an_unterminated_halt);
          RUN(takes_what_follows_halt_and_a_blank_as_part_of_halt);
          RUN(takes_two_byte_controls_anywhere); RUN(takes_binary_frames_until_told_otherwise);
          RUN(takes_255_65_inside_a_frame_as_data);
          RUN(finds_255_65_behind_the_noise_of_a_frame_that_never_ends);
          RUN(understands_controls_in_binary_mode))
