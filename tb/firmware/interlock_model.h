/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The interlock by its contract (docs/blocks/interlock.md), for the host: in continuous time and from whole counts,
 * where the gateware samples steps. Times are picoseconds; they never go back.
 */
#ifndef TB_FIRMWARE_INTERLOCK_MODEL_H
#define TB_FIRMWARE_INTERLOCK_MODEL_H

#include <stdbool.h>
#include <stdint.h>

/** Registers as at reset; the counts are as they are. */
void interlock_model_start(const int32_t counts[4]);

/** From now on an axis is driven so. */
void interlock_model_drive(unsigned axis, int64_t now_ps, int32_t steps);

/** What its encoder does. */
void interlock_model_count(unsigned axis, int64_t now_ps, int32_t count);
void interlock_model_illegal(unsigned axis, int64_t now_ps);

/** The watchdog, or an order, resets the processor. */
void interlock_model_reset_processor(void);

/** When the next fault comes, if nothing else happens before. */
int64_t interlock_model_next_ps(void);

/** Let it come; at every servo tick at least. */
void interlock_model_run(int64_t now_ps);

/** An axis is held off; and since when, or -1. */
bool interlock_model_off(unsigned axis);
int64_t interlock_model_off_ps(unsigned axis);

/** When its last drive that was not 0 began. */
int64_t interlock_model_driven_ps(unsigned axis);

/** How near to a fault any axis has come since the start without one, in parts of the limit: 1 is a fault. */
struct interlock_nearness {
    double strong, drive, speed, following;
};
struct interlock_nearness interlock_model_nearness(void);

#endif
