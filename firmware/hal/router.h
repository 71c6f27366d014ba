/* SPDX-License-Identifier: BSD-2-Clause */
/** What drives the TTL output pins. */
#ifndef HAL_ROUTER_H
#define HAL_ROUTER_H

#include <stdbool.h>

enum router_pin { ROUTER_OUT0, ROUTER_SYNC, ROUTER_ENCODER };

enum router_source {
    ROUTER_LOW = 0,
    ROUTER_HIGH = 1,
    ROUTER_LINE = 2,   /* SYNC: the active part of a line */
    ROUTER_PIXEL = 3,  /* pixel clock */
    ROUTER_DIRECT = 4, /* channel A of the divider's axis, as it is */
    ROUTER_LED = 5,    /* modulation of a lamp */
};

/** Select a pin's source; `invert` acts after the selection. */
void router_select(enum router_pin pin, enum router_source source, bool invert);

#endif
