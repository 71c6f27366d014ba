/* SPDX-License-Identifier: BSD-2-Clause */
/** Encoder inputs. Positions come from hal/snapshot.h. */
#ifndef HAL_ENCODER_H
#define HAL_ENCODER_H

#include <stdbool.h>
#include <stdint.h>

/** Longest glitch filter, in samples of the fast clock. */
enum { ENCODER_FILTER_MAX = 15 };

/**
 * Set the glitch filter and the counting direction of an axis.
 *
 * @param filter_samples  0 (off) to ENCODER_FILTER_MAX; each sample adds a clock of latency.
 * @param invert          Count up when B leads A.
 */
void encoder_configure(unsigned axis, unsigned filter_samples, bool invert);

/** Illegal transitions so far, saturating at 65535; as of the last snapshot_now. */
uint32_t encoder_errors(unsigned axis);

#endif
