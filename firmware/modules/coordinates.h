/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Between what a host writes and encoder counts. The one place that knows UM, CNTS and the origin.
 *
 *     user units (UM per mm, default tenths of a micron)   MOVE MOVREL WHERE HERE
 *     user mm    (user units / |UM|)                       SETLOW SETUP SCANR SCANV
 *     counts     (the decoder's)                           everything inside
 *
 * user = (counts - origin) / CNTS * UM. UM may be negative, or a switch may reverse the axis: it is
 * mirrored then, in user units and in user mm alike: a host that reads positions and sends limits
 * sees one frame.
 */
#ifndef MODULES_COORDINATES_H
#define MODULES_COORDINATES_H

#include <stdbool.h>
#include <stdint.h>

#include "core/module.h"

/** Counts are kept within this, so that differences and set-points cannot overflow. */
#define COORDINATES_COUNTS_MAX (INT32_C(1) << 30)

extern const struct module coordinates_module;

/** CNTS, above 0. */
double coordinates_counts_per_mm(unsigned axis);

/** UM, not 0; its sign is turned round when the axis is reversed. */
double coordinates_units_per_mm(unsigned axis);

/** Give CNTS another value. */
void coordinates_set_scale(unsigned axis, double counts_per_mm);

/** A growing user coordinate is a falling count: UM is negative, or the axis is reversed. */
bool coordinates_mirrored(unsigned axis);

/** Turn the axis round for the user, as a negative UM does, UM staying as it is. */
void coordinates_reverse(unsigned axis, bool reversed);

/** The count nearest to a place; halves away from zero; clipped at +-COORDINATES_COUNTS_MAX. */
int32_t coordinates_user_to_counts(unsigned axis, double user);
int32_t coordinates_mm_to_counts(unsigned axis, double mm);

/** A distance in user units to whole counts, signed (MOVREL); and with what a count is too coarse for. */
int32_t coordinates_distance_to_counts(unsigned axis, double user);
double coordinates_distance_to_part_counts(unsigned axis, double user);
double coordinates_part_counts_to_distance(unsigned axis, double counts);

double coordinates_counts_to_user(unsigned axis, int32_t counts);
double coordinates_counts_to_mm(unsigned axis, int32_t counts);

/**
 * Mm from the user's 0 in the direction of the counts, whatever UM and the switches make of it: what
 * the settings store keeps of a place. Another start may mirror the axis otherwise, or not yet.
 */
double coordinates_counts_to_stage_mm(unsigned axis, int32_t counts);
int32_t coordinates_stage_mm_to_counts(unsigned axis, double mm);

/** Keep a place in the settings store, as stage mm, under a command's name. False: not kept. */
bool coordinates_keep_place(const char *name, unsigned axis, int32_t counts);

/** The place kept under a name, or another, stage mm, if none is. After the settings, as these scale. */
int32_t coordinates_kept_place(const char *name, unsigned axis, double otherwise_mm);

/** Let a count be 0 for the user. Start-up and RESET; before the settings are loaded. */
void coordinates_set_origin(unsigned axis, int32_t counts);

/** Whether a place lies within COORDINATES_COUNTS_MAX of the user's 0: what HERE may give. */
bool coordinates_fits(unsigned axis, double user);

/** HERE: let a count be a place in user units, exactly. */
void coordinates_name(unsigned axis, int32_t counts, double user);

#endif
