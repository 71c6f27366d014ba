/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/pins.h"

#include "hal/divider.h"
#include "hal/router.h"

static bool out0, lamp, inverted, pixels_enabled, direct, on_out0;

static void route(void)
{
    const enum router_source encoder = direct ? ROUTER_DIRECT : ROUTER_PIXEL;

    router_select(ROUTER_ENCODER, encoder, inverted && !direct);
    if (on_out0)
        router_select(ROUTER_OUT0, encoder, inverted && !direct);
    else
        router_select(ROUTER_OUT0, lamp ? ROUTER_LED : out0 ? ROUTER_HIGH : ROUTER_LOW, inverted);
}

void pins_out0(bool high)
{
    out0 = high;
    lamp = false;
    route();
}

void pins_out0_lamp(bool lit)
{
    out0 = lit;
    lamp = true;
    route();
}

bool pins_out0_is_lamp(void)
{
    return lamp;
}

void pins_invert(bool invert)
{
    inverted = invert;
    route();
}

bool pins_out0_level(void)
{
    return out0 != inverted;
}

void pins_enable_pixels(bool enabled)
{
    pixels_enabled = enabled;
}

bool pins_pixels_enabled(void)
{
    return pixels_enabled;
}

void pins_encoder_direct(bool on)
{
    direct = on;
    route();
}

void pins_encoder_on_out0(bool on)
{
    on_out0 = on;
    route();
}

void pins_encoder_axis(unsigned axis)
{
    /* The rest is loaded with each line. */
    const struct divider_line line = {.axis = axis};

    divider_load(&line);
}
