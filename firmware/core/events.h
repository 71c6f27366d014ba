/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Named events, stamped with `fast` time, that modules subscribe to by name in a static table.
 *
 * A hook is of one of two kinds. An INTERRUPT hook runs inside events_publish, whatever the context
 * of the publisher: it does the least and shares data through rings or snapshots only. A MAIN hook
 * runs later, in events_poll, from a queue of EVENT_QUEUE entries in order of publication. An event
 * nobody subscribes to costs a table look-up. A full queue drops the event; events_poll then logs
 * FAULT_TASK_OVERTIME.
 */
#ifndef CORE_EVENTS_H
#define CORE_EVENTS_H

#include <stdbool.h>
#include <stdint.h>

enum event_name {
    EVENT_NONE,         /* ends a table */
    EVENT_SERVO_TURN,   /* each turn of the servo, 0.5 ms; argument: its tick. Interrupt hooks only */
    EVENT_MOVE_DONE,    /* a commanded move has ended and settled; argument: axis */
    EVENT_BUSY,         /* the answer of STATUS changed; argument: 1 busy, 0 not */
    EVENT_POINT,        /* from place to place; argument: 1 under way to the next, 0 has reached it */
    EVENT_HALT,         /* everything was stopped; argument: 1 when that ended a commanded move */
    EVENT_TRIGGER_IN,   /* qualified edge at IN0; argument: level */
    EVENT_IN1,          /* edge at IN1; argument: level after it */
    EVENT_BUTTON,       /* a press was classed; argument: enum action */
    EVENT_LINE_START,   /* SYNC fired; argument: line number */
    EVENT_LINE_END,     /* the active line ended; argument: pulses produced */
    EVENT_FAULT,        /* something was logged; argument: code */
    EVENT_ORIGIN_MOVED, /* HERE or ZERO shifted coordinates; argument: axis */
    EVENT_REPORT_SENT,  /* a reply has left for the port; argument: 0 */
    EVENT_COMMAND,      /* a line or frame that may change something is carried out next; argument: 0 */
    EVENT_RESET,        /* a reset was asked for (255 82); argument: 0 */
    EVENT_COUNT,
};

struct event {
    enum event_name name;
    uint32_t argument;
    uint64_t time_fast; /* when it happened, in fast clocks since reset */
};

/** Fast clocks are 5 ns long. */
#define EVENTS_FAST_PER_S UINT64_C(200000000)
#define EVENTS_FAST_PER_MS (EVENTS_FAST_PER_S / 1000)

enum { EVENT_HOOKS_MAX = 10, EVENT_QUEUE = 32 };

enum event_context { EVENT_IN_MAIN, EVENT_IN_INTERRUPT };

struct subscription {
    enum event_name event;
    enum event_context context;
    void (*run)(const struct event *event);
};

struct module;

/** Gather the subscriptions of all modules. False: more than EVENT_HOOKS_MAX hooks of one event. */
bool events_init(const struct module *const *modules);

/** The clock that stamps events published by core, in fast clocks. Without one they carry 0. */
void events_set_clock(uint64_t (*now_fast)(void));
uint64_t events_now(void);

/** Some module subscribes to an event. For publishers that are in a hurry. */
bool events_heard(enum event_name name);

/** Publish from the main loop. */
void events_publish(enum event_name name, uint32_t argument, uint64_t time_fast);

/** Publish from an interrupt (interrupts do not nest: one producer). */
void events_publish_from_interrupt(enum event_name name, uint32_t argument, uint64_t time_fast);

/** Main loop: run the main hooks of what has been published, at most EVENT_QUEUE events a call. */
void events_poll(void);

#endif
