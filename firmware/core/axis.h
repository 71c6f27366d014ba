/* SPDX-License-Identifier: BSD-2-Clause */
/** Axis letters and numbers. Axis n is hardware channel n, letter n of AXIS_LETTERS. */
#ifndef CORE_AXIS_H
#define CORE_AXIS_H

#include "config.h"

/** Number of a fitted axis, 0 to AXIS_COUNT - 1, or -1: no such axis is fitted. Upper case only. */
static inline int axis_index(char letter)
{
    for (int axis = 0; axis < AXIS_COUNT; axis++)
        if (AXIS_LETTERS[axis] == letter)
            return axis;
    return -1;
}

/** Letter of axis 0 to AXIS_COUNT - 1. */
static inline char axis_letter(unsigned axis)
{
    return AXIS_LETTERS[axis];
}

#endif
