/* SPDX-License-Identifier: BSD-2-Clause */
#include "core/line.h"

#include <string.h>

enum {
    CR = 0x0D,
    BACKSPACE = 0x08,
    TAB = 0x09,
    ESCAPE = 0x1B,
    DELETE = 0x7F,
    PREFIX = 0xFF,
    FRAME_END = 58,
    FRAME_DATA_MAX = LINE_FRAME_MAX - 4,
};

static void start(struct line *line)
{
    line->length = 0;
    line->state = LINE_START;
}

void line_init(struct line *line)
{
    memset(line, 0, sizeof *line);
}

static bool is_blank_only(const struct line *line)
{
    for (size_t i = 0; i < line->length; i++)
        if (line->text[i] != ' ')
            return false;
    return true;
}

static enum line_event end_line(struct line *line)
{
    bool over = line->state == LINE_OVER, text = line->state == LINE_TEXT;

    line->complete = true;
    if (over)
        return LINE_TOO_LONG;
    return text && !is_blank_only(line) ? LINE_READY : LINE_NONE;
}

static enum line_event control_byte(struct line *line, uint8_t byte)
{
    switch (byte) {
    case LINE_CONTROL_ASCII:
    case LINE_CONTROL_BINARY:
        line->binary = byte == LINE_CONTROL_BINARY;
        start(line);
        break;
    case LINE_CONTROL_FINE:
    case LINE_CONTROL_RESET:
    case LINE_CONTROL_COARSE:
        break;
    default:
        return LINE_NONE;
    }
    line->control = byte;
    return LINE_CONTROL;
}

static enum line_event printable(struct line *line, char character)
{
    switch (line->state) {
    case LINE_AFTER_HALT:
        if (character == 'r') {
            line->state = LINE_AFTER_HALT_R;
            return LINE_NONE;
        }
        /* fall through */
    case LINE_AFTER_HALT_R:
        line->state = character == ' ' ? LINE_SKIP : LINE_START;
        break;
    default:
        break;
    }
    switch (line->state) {
    case LINE_START:
        if (character == ' ')
            return LINE_NONE;
        if (character == '\\') {
            line->state = LINE_AFTER_HALT;
            return LINE_HALT;
        }
        line->state = LINE_TEXT;
        break;
    case LINE_TEXT:
        break;
    default:
        return LINE_NONE;
    }
    if (line->length == LINE_MAX) {
        line->state = LINE_OVER;
        return LINE_NONE;
    }
    line->text[line->length++] = character;
    return LINE_NONE;
}

static enum line_event ascii_byte(struct line *line, uint8_t byte)
{
    if (line->complete) {
        line->complete = false;
        start(line);
    }
    if (line->prefix) {
        line->prefix = byte == PREFIX;
        if (byte != CR)
            return control_byte(line, byte);
    }
    switch (byte) {
    case PREFIX:
        line->prefix = true;
        return LINE_NONE;
    case CR:
        return end_line(line);
    case BACKSPACE:
    case DELETE:
    case ESCAPE:
        start(line);
        return LINE_CLEAR;
    case TAB:
        return printable(line, ' ');
    default:
        return byte < ' ' ? LINE_NONE : printable(line, (char)byte);
    }
}

/* Bytes of the frame that the bytes waiting begin, of which three are there. */
static size_t frame_length(const struct line *line)
{
    bool writes = line->input[1] != 0 && strchr("TDSA", line->input[1]) != NULL;

    return writes ? line->input[2] + 4u : 4u;
}

/* Whether the bytes waiting can be the start of a frame. */
static bool may_be_frame(const struct line *line)
{
    size_t have = line->input_length;

    if (have < 3)
        return true;
    if (line->input[2] > FRAME_DATA_MAX)
        return false;
    return have < frame_length(line) || line->input[have - 1] == FRAME_END;
}

static bool is_whole_frame(const struct line *line)
{
    return line->input_length >= 4 && line->input_length == frame_length(line);
}

static void drop(struct line *line, size_t count)
{
    line->input_length -= count;
    memmove(line->input, line->input + count, line->input_length);
}

/* Judge the bytes waiting in binary mode, from the oldest on. False: they need another byte. */
static bool binary_step(struct line *line, enum line_event *event)
{
    if (line->input[0] == PREFIX) {
        if (line->input_length < 2)
            return false;
        uint8_t second = line->input[1];

        drop(line, second == PREFIX ? 1 : 2);
        *event = control_byte(line, second);
    } else if (!may_be_frame(line)) {
        drop(line, 1);
    } else if (is_whole_frame(line)) {
        memcpy(line->frame, line->input, line->input_length);
        line->frame_length = line->input_length;
        line->input_length = 0;
        *event = LINE_FRAME;
    } else {
        return false;
    }
    return true;
}

void line_put(struct line *line, uint8_t byte)
{
    if (line->input_length < LINE_FRAME_MAX)
        line->input[line->input_length++] = byte;
}

enum line_event line_next(struct line *line)
{
    enum line_event event = LINE_NONE;

    while (event == LINE_NONE && line->input_length > 0) {
        if (line->binary) {
            if (!binary_step(line, &event))
                break;
        } else {
            uint8_t byte = line->input[0];

            drop(line, 1);
            event = ascii_byte(line, byte);
        }
    }
    return event;
}
