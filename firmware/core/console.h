/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * One serial port speaking the command language: bytes in, lines, commands, replies out.
 *
 * console_poll reads everything that has come in before it does anything else, so HALT acts within
 * one turn of the main loop however many commands or how long a reply wait before it. Lines wait in
 * a queue of CONSOLE_QUEUE bytes and are answered in order, one reply each; a line that no longer
 * fits is dropped and answered :N-6 in its turn, however many there are. A reply is sent as the transmit ring takes it;
 * unsolicited lines (core/report.h) go out between replies.
 */
#ifndef CORE_CONSOLE_H
#define CORE_CONSOLE_H

#include "core/command.h"
#include "core/line.h"
#include "core/ring.h"

enum { CONSOLE_QUEUE = 1024 };

struct console {
    struct ring *receive;  /* the port's interrupt puts, the console takes */
    struct ring *transmit; /* the console puts, the port's interrupt takes */
    void (*kick)(void);    /* optional: called after bytes were put into `transmit` */

    /* Private. */
    struct line line;
    struct ring queue; /* lines that wait, each ended by CR */
    uint8_t queue_bytes[CONSOLE_QUEUE];
    uint32_t lost;     /* lines dropped since the last that went into the queue */
    uint32_t refusals; /* :N-6 to be sent before the next line is taken from the queue */
    char text[LINE_MAX]; /* line being carried out; quoted text in `request` points into it */
    struct request request;
    struct reply reply;
    enum { CONSOLE_IDLE, CONSOLE_PENDING, CONSOLE_LAST } state;
};

void console_init(struct console *console, struct ring *receive, struct ring *transmit,
                  void (*kick)(void));

/** One turn: take what has come in, carry out at most one line or step, send what fits. */
void console_poll(struct console *console);

/** Bytes have come in, or a reply in parts is under way: a turn is due before anything long is done. */
bool console_due(const struct console *console);

/**
 * Send what is left of the reply in hand, in a turn that takes and carries out nothing. True: all of
 * it has gone into the ring; further parts of a long one are given up. Lines that wait go on waiting.
 */
bool console_finish(struct console *console);

/** True when no line waits and nothing is being sent. */
bool console_idle(const struct console *console);

#endif
