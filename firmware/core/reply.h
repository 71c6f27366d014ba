/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The text of one reply, built in a bounded buffer and sent by the console as the port takes it.
 *
 * A handler writes text and returns a status; the console adds the end: CR LF after text, the bare
 * acknowledge ":A " CR LF when a handler that succeeded wrote nothing, ":N-4" CR LF (and the text
 * dropped) for an error. A reply longer than REPLY_MAX is written in parts, see `step`.
 */
#ifndef CORE_REPLY_H
#define CORE_REPLY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { REPLY_MAX = 320 }; /* characters a handler may write in one call */

/** Spelling of an answer with values. */
enum reply_form {
    FORM_P,      /* :A X=1 Y=2 */
    FORM_S,      /* :X=1 Y=2 A */
    FORM_L,      /* X=1 Y=2 :A */
    FORM_V,      /* :A 1 2 and a blank */
    FORM_VALUES, /* :A 1 2 */
};

struct reply {
    /**
     * 0 in the first call of a command's `run`. A `run` that returns STATUS_PENDING changes it to
     * know, when it is called again, what it has written. Its meaning is the handler's own.
     */
    uint32_t step;

    /* Private to core/. */
    char text[REPLY_MAX + 2]; /* and room for CR LF */
    size_t length;
    size_t sent;
    bool overflow; /* more than REPLY_MAX was written, or a number that cannot be printed */
    enum reply_form form;
    bool opened;
};

/** Decimals of the positions WHERE prints: `VB Z=`, 255 72 (1) and 255 84 (0). 1 after reset. */
extern double reply_position_decimals;

/** Lines end in CR alone, without LF: `VB X=`, bit 3. False after reset. */
extern bool reply_ends_in_cr;

void reply_clear(struct reply *reply);

void reply_char(struct reply *reply, char character);
void reply_text(struct reply *reply, const char *text);
/** Append `value` with `decimals` 0 to 9, rounded (core/number.h). */
void reply_number(struct reply *reply, double value, unsigned decimals);
void reply_integer(struct reply *reply, int32_t value);
/** As printf's "%*s" and "%*.*f": right-justified in `width` with blanks, never cut. */
void reply_text_right(struct reply *reply, const char *text, unsigned width);
void reply_number_right(struct reply *reply, double value, unsigned decimals, unsigned width);
/** Blanks up to `column` (0-based) of the line being written; none if it is already there. */
void reply_pad_to(struct reply *reply, unsigned column);
/** End an inner line of a reply of several lines: CR alone. The console ends the last one. */
void reply_end_line(struct reply *reply);

/**
 * An answer with values in one of the forms: open, one field for each value, close.
 * Without a field between them nothing is written.
 */
void reply_open(struct reply *reply, enum reply_form form);
/** Begin a field and write what precedes its value; the caller writes the value. */
void reply_field(struct reply *reply, char letter);
void reply_close(struct reply *reply);

#endif
