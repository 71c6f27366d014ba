/* SPDX-License-Identifier: BSD-2-Clause */
/** Push-buttons: what is pressed, and how the presses that have ended went. */
#ifndef HAL_BUTTONS_H
#define HAL_BUTTONS_H

#include <stdbool.h>
#include <stdint.h>

enum button { BUTTON_AT, BUTTON_HOME, BUTTON_ZERO, BUTTON_JOYSTICK, BUTTON_COUNT };

/** Classes of presses, decided on release: from 0, 1 and 3 s. */
enum button_length { BUTTON_SHORT, BUTTON_LONG, BUTTON_EXTRA_LONG, BUTTON_LENGTHS };

struct button_press {
    uint32_t duration_ms; /* at most 65535 */
    enum button_length length;
    uint32_t at_cycles; /* of its release: the timer's count (hal/timer.h) */
};

/** A press that has ended since it was last asked for. False: none. Two of them: the later one. */
bool buttons_take(enum button button, struct button_press *press);

/** Held down now, debounced. */
bool buttons_pressed(enum button button);

/** Forget presses that have ended. */
void buttons_clear(void);

#endif
