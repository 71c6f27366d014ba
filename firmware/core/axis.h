/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Axis letters and numbers. Axis n is hardware channel n. Its letter is letter n of AXIS_LETTERS,
 * unless it was given another (Z2B).
 */
#ifndef CORE_AXIS_H
#define CORE_AXIS_H

#include "config.h"

/** Letters in use; all different. Written by axis_set_letter only. */
extern char axis_letters[AXIS_COUNT];

/** Number of a fitted axis, 0 to AXIS_COUNT - 1, or -1: no such axis is fitted. Upper case only. */
static inline int axis_index(char letter)
{
    for (int axis = 0; axis < AXIS_COUNT; axis++)
        if (axis_letters[axis] == letter)
            return axis;
    return -1;
}

/** Letter of axis 0 to AXIS_COUNT - 1. */
static inline char axis_letter(unsigned axis)
{
    return axis_letters[axis];
}

/** Give an axis a letter, 'A' to 'Z', that no other has. Start-up only. */
void axis_set_letter(unsigned axis, char letter);

#endif
