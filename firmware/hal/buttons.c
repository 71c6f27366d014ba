/* SPDX-License-Identifier: BSD-2-Clause */
#include "hal/buttons.h"

#include "regs.h"

/* Both events of a button. */
static uint32_t events_of(enum button button)
{
    return 1u << (REG_BUTTONS_EVENTS_RELEASED_SHIFT + button) |
           1u << (REG_BUTTONS_EVENTS_LOST_SHIFT + button);
}

bool buttons_take(enum button button, struct button_press *press)
{
    uint32_t result;

    if ((buttons_events_released_get() >> button & 1u) == 0)
        return false;
    /* Cleared first: a press that ends from here on is asked for again. */
    buttons_events_write(events_of(button));
    result = buttons_press_read(button);
    press->duration_ms =
        (result & REG_BUTTONS_PRESS0_DURATION_MASK) >> REG_BUTTONS_PRESS0_DURATION_SHIFT;
    press->length = (enum button_length)((result & REG_BUTTONS_PRESS0_LENGTH_MASK) >>
                                         REG_BUTTONS_PRESS0_LENGTH_SHIFT);
    press->at_cycles = buttons_time_read(button);
    return true;
}

bool buttons_pressed(enum button button)
{
    return (buttons_levels_pressed_get() >> button & 1u) != 0;
}

void buttons_clear(void)
{
    buttons_events_write(buttons_events_read());
}
