/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Bytes from the host to command lines.
 *
 *  - CR ends a line. An empty line, or one of blanks only, is nothing and gets no answer.
 *  - A tab is a blank. Other control bytes, LF among them, are ignored wherever they stand.
 *  - 0x08, 0x7F and 0x1B drop the line typed so far and all lines that wait (LINE_CLEAR).
 *  - More than LINE_MAX characters: the line is dropped up to its CR (LINE_TOO_LONG at the CR).
 *  - `\` first in a line is HALT at once, without waiting for CR (LINE_HALT). What follows it:
 *    a small `r` directly behind is dropped (two programs send the two characters `\r` and no CR);
 *    then a blank makes the rest up to CR part of HALT, ignored; anything else starts a new line,
 *    so that a command glued behind an unterminated HALT is run and answered.
 *  - 255 starts a two-byte control, taken anywhere and at once: 65 ASCII lines, 66 binary frames,
 *    82 reset, 72 and 84 precision of WHERE (LINE_CONTROL). 65 and 66 drop the line typed so far,
 *    the others leave it alone. Another second byte is dropped with the 255, CR excepted.
 *  - Until 255 65, binary frames: axis, command, size, data, 58 (LINE_FRAME). Writing commands (T D
 *    S A) have `size` data bytes, 0 to 4; in others the size tells how much is to be answered, or
 *    nothing, and there are no data. Inside a well-formed frame 255 65 are data; bytes that form no
 *    frame are dropped one by one, so that noise never hides a 255 65 for longer than one frame.
 *
 * Pure: no hardware, no time.
 */
#ifndef CORE_LINE_H
#define CORE_LINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    LINE_MAX = 128,     /* characters of a line, CR not counted */
    LINE_FRAME_MAX = 8, /* bytes of a binary frame */
};

enum line_event {
    LINE_NONE,
    LINE_READY,    /* `text` holds `length` characters, valid until the next line_next */
    LINE_TOO_LONG, /* a line was dropped; answer :N-6 */
    LINE_HALT,     /* stop now, and answer as HALT */
    LINE_CLEAR,    /* forget the lines that wait */
    LINE_FRAME,    /* `frame` holds a whole frame, valid until the next line_next */
    LINE_CONTROL,  /* `control` holds the second byte: 65, 66, 72, 82 or 84 */
};

enum {
    LINE_CONTROL_ASCII = 65,
    LINE_CONTROL_BINARY = 66,
    LINE_CONTROL_FINE = 72,   /* WHERE in hundredths of a micron */
    LINE_CONTROL_RESET = 82,
    LINE_CONTROL_COARSE = 84, /* WHERE in tenths of a micron */
};

struct line {
    char text[LINE_MAX];
    size_t length;
    uint8_t control;
    uint8_t frame[LINE_FRAME_MAX];
    size_t frame_length;

    /* Private. */
    enum { LINE_START, LINE_TEXT, LINE_AFTER_HALT, LINE_AFTER_HALT_R, LINE_SKIP, LINE_OVER } state;
    bool complete; /* `text` has been handed out; the next byte starts afresh */
    bool prefix;   /* the last byte was 255 */
    bool binary;
    uint8_t input[LINE_FRAME_MAX]; /* bytes put and not yet judged: the start of a binary frame */
    size_t input_length;
};

void line_init(struct line *line);

/** Hand over one byte. Then call line_next until it returns LINE_NONE, before the next byte. */
void line_put(struct line *line, uint8_t byte);

/** What the bytes so far brought about, one event a call; LINE_NONE: no more. */
enum line_event line_next(struct line *line);

#endif
