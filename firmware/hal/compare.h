/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Position compare: the start of an active line. "Set, then arm"; armed, it needs no firmware.
 *
 * Arming arms the divider (hal/divider.h) with it; set that up first.
 */
#ifndef HAL_COMPARE_H
#define HAL_COMPARE_H

#include <stdbool.h>
#include <stdint.h>

struct compare_status {
    bool armed;  /* waiting for the reference edge */
    bool active; /* between the reference edge and the last pixel: SYNC is on */
    bool late;   /* the last arming was at or past the reference edge; it does not fire */
};

/** What happened since the event was last acknowledged. */
struct compare_events {
    bool started;  /* the reference edge was crossed */
    bool finished; /* the last pixel was reached */
    bool late;
};

/**
 * Arm for one line. Ends whatever was under way.
 *
 * @param axis            Axis of SYNC.
 * @param reference_edge  Edge (between counts edge-1 and edge) at which the line begins.
 * @param reverse         The line is scanned toward lower counts.
 */
void compare_arm(unsigned axis, int32_t reference_edge, bool reverse);

/** End whatever is under way: SYNC falls, no more pixels. */
void compare_disarm(void);

/** State after all writes so far have had their effect; waits for that, about a microsecond. */
struct compare_status compare_status(void);

/** Read and acknowledge the events. Also in the line interrupt. */
struct compare_events compare_take_events(void);

#endif
