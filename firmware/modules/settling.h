/* SPDX-License-Identifier: BSD-2-Clause */
/** How long each axis takes to arrive, as the main loop sees it: what INFO prints. */
#ifndef MODULES_SETTLING_H
#define MODULES_SETTLING_H

/** From the end of the set-point's motion to arrival (the pause included). */
struct settling {
    double last_ms, mean_ms; /* since start-up; 0 before the first arrival */
    double error_sum_counts; /* of the settling in progress or the last one, as often as seen */
};

const struct settling *settling_of(unsigned axis);

/** Forget all of it: start-up and RESET. */
void settling_init(void);

/** Each turn of the main loop. Looks at one axis: an end is seen up to AXIS_COUNT turns late. */
void settling_poll(void);

#endif
