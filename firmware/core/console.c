/* SPDX-License-Identifier: BSD-2-Clause */
#include "core/console.h"

#include <string.h>

#include "core/events.h"
#include "core/number.h"
#include "core/report.h"

/*
 * Stands in the queue for lines that were dropped; their number follows in decimal. No line holds
 * control bytes.
 */
static const uint8_t lost_mark = 0x15;

enum {
    LOST_MAX = 1 + 10 + 1,    /* bytes for lost lines: mark, number, CR */
    HALT_ROOM = LOST_MAX + 8, /* left free for lines that acted at once, so that HALT is answered */
};

/* Stands in the queue before a binary frame, whose bytes follow as pairs of letters A to P. */
static const uint8_t frame_mark = 0x06;

/* Stands in the queue before a line whose command acted at once. */
static const uint8_t acted_mark = 0x12;

void console_init(struct console *console, struct ring *receive, struct ring *transmit,
                  void (*kick)(void))
{
    memset(console, 0, sizeof *console);
    console->receive = receive;
    console->transmit = transmit;
    console->kick = kick;
    console->queue.bytes = console->queue_bytes;
    console->queue.mask = CONSOLE_QUEUE - 1;
    line_init(&console->line);
}

static void put_lost(struct console *console)
{
    char number[NUMBER_TEXT_MAX];
    size_t length;

    if (console->lost == 0)
        return;
    length = number_format(number, console->lost, 0);
    ring_put(&console->queue, lost_mark);
    for (size_t i = 0; i < length; i++)
        ring_put(&console->queue, (uint8_t)number[i]);
    ring_put(&console->queue, '\r');
    console->lost = 0;
}

/* A line without room is counted, and so answered in its turn. */
static void take_line(struct console *console, const char *text, size_t length)
{
    bool acted = command_urgent(text, length);

    if (ring_free(&console->queue) < LOST_MAX + acted + length + 1 + (acted ? 0 : HALT_ROOM)) {
        console->lost++;
        return;
    }
    put_lost(console);
    if (acted)
        ring_put(&console->queue, acted_mark);
    for (size_t i = 0; i < length; i++)
        ring_put(&console->queue, (uint8_t)text[i]);
    ring_put(&console->queue, '\r');
}

/* Without room the frame is lost; there is no answer that could say so. */
static void take_frame(struct console *console, const uint8_t *frame, size_t length)
{
    if (ring_free(&console->queue) < LOST_MAX + 2 * length + 2)
        return;
    put_lost(console);
    ring_put(&console->queue, frame_mark);
    for (size_t i = 0; i < length; i++) {
        ring_put(&console->queue, (uint8_t)('A' + (frame[i] >> 4)));
        ring_put(&console->queue, (uint8_t)('A' + (frame[i] & 15)));
    }
    ring_put(&console->queue, '\r');
}

static void control(uint8_t byte)
{
    switch (byte) {
    case LINE_CONTROL_FINE:
        reply_position_decimals = 1;
        break;
    case LINE_CONTROL_COARSE:
        reply_position_decimals = 0;
        break;
    case LINE_CONTROL_RESET:
        events_publish(EVENT_RESET, 0, events_now());
        break;
    default:
        break;
    }
}

static void handle(struct console *console, enum line_event event)
{
    const struct line *line = &console->line;

    switch (event) {
    case LINE_READY:
        take_line(console, line->text, line->length);
        break;
    case LINE_HALT:
        take_line(console, "\\", 1);
        break;
    case LINE_TOO_LONG:
        console->lost++;
        break;
    case LINE_CLEAR:
        ring_clear(&console->queue);
        console->lost = 0;
        console->refusals = 0;
        break;
    case LINE_FRAME:
        take_frame(console, line->frame, line->frame_length);
        break;
    case LINE_CONTROL:
        control(line->control);
        break;
    default:
        break;
    }
}

static void take_input(struct console *console)
{
    uint32_t count = ring_used(console->receive);
    uint8_t byte;

    for (; count > 0 && ring_take(console->receive, &byte); count--) {
        enum line_event event;

        line_put(&console->line, byte);
        while ((event = line_next(&console->line)) != LINE_NONE)
            handle(console, event);
    }
}

/* Give the reply its end, or keep it open. */
static void conclude(struct console *console, enum status status, bool first)
{
    struct reply *reply = &console->reply;

    if (reply->overflow)
        status = STATUS_UNDEFINED;
    if (status == STATUS_PENDING) {
        console->state = CONSOLE_PENDING;
        return;
    }
    console->state = CONSOLE_LAST;
    if (status < 0) {
        reply_clear(reply);
        reply_text(reply, ":N");
        reply_integer(reply, status);
    } else if (status == STATUS_OK && first && reply->length == 0) {
        reply_text(reply, ":A ");
    }
    if (status != STATUS_SILENT) {
        reply->text[reply->length++] = '\r';
        if (!reply_ends_in_cr)
            reply->text[reply->length++] = '\n';
    }
}

/* The frame behind its mark in `text`, `length` characters in all. */
static void run_frame(struct console *console, size_t length)
{
    uint8_t frame[LINE_FRAME_MAX];

    for (size_t i = 0; 2 * i + 2 < length; i++)
        frame[i] = (uint8_t)((console->text[2 * i + 1] - 'A') << 4 |
                             (console->text[2 * i + 2] - 'A'));
    if (command_frame(frame, &console->reply))
        conclude(console, STATUS_SILENT, true);
}

static void next_line(struct console *console)
{
    size_t length = 0, used;
    double lost = 0;
    uint8_t byte;

    if (console->refusals == 0 && ring_used(&console->queue) == 0) {
        console->refusals = console->lost;
        console->lost = 0;
    }
    if (console->refusals > 0) {
        console->refusals--;
        reply_clear(&console->reply);
        conclude(console, STATUS_UNDEFINED, true);
        return;
    }
    console->request.acted = false;
    while (ring_take(&console->queue, &byte) && byte != '\r') {
        if (byte == acted_mark)
            console->request.acted = true;
        else
            console->text[length++] = (char)byte;
    }
    if (length == 0)
        return;
    reply_clear(&console->reply);
    if (console->text[0] == (char)frame_mark) {
        run_frame(console, length);
        return;
    }
    if (console->text[0] == (char)lost_mark) {
        (void)number_parse(console->text + 1, length - 1, &lost, &used);
        console->refusals = (uint32_t)lost;
        next_line(console);
        return;
    }
    conclude(console,
             command_execute(console->text, length, &console->request, &console->reply), true);
}

static void next_part(struct console *console)
{
    struct reply *reply = &console->reply;

    reply->length = 0;
    reply->sent = 0;
    reply->overflow = false;
    conclude(console, command_resume(&console->request, reply), false);
}

/* Unsolicited lines, between replies. True: none is left. */
static bool send_reports(struct console *console)
{
    uint8_t byte;
    bool any = false;

    while (ring_free(console->transmit) > 0 && report_take(&byte))
        any |= ring_put(console->transmit, byte);
    if (any && console->kick != NULL)
        console->kick();
    return report_is_empty();
}

/* True when all of the text has gone into the ring. */
static bool send(struct console *console)
{
    struct reply *reply = &console->reply;
    size_t before = reply->sent;

    while (reply->sent < reply->length &&
           ring_put(console->transmit, (uint8_t)reply->text[reply->sent]))
        reply->sent++;
    if (reply->sent > before && console->kick != NULL)
        console->kick();
    return reply->sent == reply->length;
}

void console_poll(struct console *console)
{
    take_input(console);
    if (console->state == CONSOLE_IDLE && send_reports(console))
        next_line(console);
    if (console->state == CONSOLE_IDLE || !send(console))
        return;
    if (console->state == CONSOLE_PENDING) {
        next_part(console);
        return;
    }
    console->state = CONSOLE_IDLE;
    events_publish(EVENT_REPORT_SENT, 0, events_now());
}

bool console_due(const struct console *console)
{
    return ring_used(console->receive) > 0 || console->state == CONSOLE_PENDING;
}

bool console_finish(struct console *console)
{
    if (console->state != CONSOLE_IDLE && !send(console))
        return false;
    console->state = CONSOLE_IDLE;
    return true;
}

bool console_idle(const struct console *console)
{
    return console->state == CONSOLE_IDLE && ring_used(&console->queue) == 0 &&
           console->lost == 0 && console->refusals == 0 && report_is_empty();
}
