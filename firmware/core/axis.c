/* SPDX-License-Identifier: BSD-2-Clause */
#include "core/axis.h"

char axis_letters[AXIS_COUNT] = {
    AXIS_LETTERS[0],
#if AXIS_COUNT > 1
    AXIS_LETTERS[1],
#endif
#if AXIS_COUNT > 2
    AXIS_LETTERS[2],
#endif
#if AXIS_COUNT > 3
    AXIS_LETTERS[3],
#endif
};

void axis_set_letter(unsigned axis, char letter)
{
    axis_letters[axis] = letter;
}
