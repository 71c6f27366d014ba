/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/pins.h"

#include "hal/divider.h"
#include "hal/router.h"

static bool out0, inverted, pixels_enabled, direct;

static void route(void)
{
    router_select(ROUTER_OUT0, out0 ? ROUTER_HIGH : ROUTER_LOW, inverted);
    if (direct)
        router_select(ROUTER_ENCODER, ROUTER_DIRECT, false);
    else
        router_select(ROUTER_ENCODER, ROUTER_PIXEL, inverted);
}

void pins_out0(bool high)
{
    out0 = high;
    route();
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

void pins_encoder_axis(unsigned axis)
{
    /* The rest is loaded with each line. */
    const struct divider_line line = {.axis = axis};

    divider_load(&line);
}
