/* SPDX-License-Identifier: BSD-2-Clause */
#include "core/reply.h"

#include <string.h>

#include "core/number.h"

double reply_position_decimals = 1;
bool reply_ends_in_cr;

void reply_clear(struct reply *reply)
{
    reply->step = 0;
    reply->length = 0;
    reply->sent = 0;
    reply->overflow = false;
    reply->opened = false;
}

void reply_char(struct reply *reply, char character)
{
    if (reply->length < REPLY_MAX)
        reply->text[reply->length++] = character;
    else
        reply->overflow = true;
}

static void append(struct reply *reply, const char *text, size_t length)
{
    for (size_t i = 0; i < length; i++)
        reply_char(reply, text[i]);
}

static void blanks(struct reply *reply, size_t count)
{
    for (; count > 0; count--)
        reply_char(reply, ' ');
}

void reply_text(struct reply *reply, const char *text)
{
    append(reply, text, strlen(text));
}

void reply_number_right(struct reply *reply, double value, unsigned decimals, unsigned width)
{
    char text[NUMBER_TEXT_MAX];
    size_t length = number_format(text, value, decimals);

    if (length == 0)
        reply->overflow = true;
    if (length < width)
        blanks(reply, width - length);
    append(reply, text, length);
}

void reply_number(struct reply *reply, double value, unsigned decimals)
{
    reply_number_right(reply, value, decimals, 0);
}

void reply_integer(struct reply *reply, int32_t value)
{
    reply_number(reply, value, 0);
}

void reply_text_right(struct reply *reply, const char *text, unsigned width)
{
    size_t length = strlen(text);

    if (length < width)
        blanks(reply, width - length);
    append(reply, text, length);
}

void reply_pad_to(struct reply *reply, unsigned column)
{
    size_t start = reply->length;

    while (start > 0 && reply->text[start - 1] != '\r')
        start--;
    if (reply->length - start < column)
        blanks(reply, column - (reply->length - start));
}

void reply_end_line(struct reply *reply)
{
    reply_char(reply, '\r');
}

void reply_open(struct reply *reply, enum reply_form form)
{
    reply->form = form;
    reply->opened = false;
}

void reply_field(struct reply *reply, char letter)
{
    static const char *const openings[] = {
        [FORM_P] = ":A ", [FORM_S] = ":", [FORM_L] = "", [FORM_V] = ":A ", [FORM_VALUES] = ":A ",
    };

    if (reply->opened)
        reply_char(reply, ' ');
    else
        reply_text(reply, openings[reply->form]);
    reply->opened = true;
    if (reply->form != FORM_V && reply->form != FORM_VALUES) {
        reply_char(reply, letter);
        reply_char(reply, '=');
    }
}

void reply_close(struct reply *reply)
{
    static const char *const closings[] = {
        [FORM_P] = "", [FORM_S] = " A", [FORM_L] = " :A", [FORM_V] = " ", [FORM_VALUES] = "",
    };

    if (reply->opened)
        reply_text(reply, closings[reply->form]);
    reply->opened = false;
}
