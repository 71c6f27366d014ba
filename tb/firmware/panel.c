/* SPDX-License-Identifier: BSD-2-Clause */
#include "panel.h"

#include "host/mmio.h"
#include "regs.h"

static void clear_ones(void *context, uintptr_t address, uint32_t value)
{
    (void)context;
    mmio_model_set(address, mmio_model_get(address) & ~value);
}

static void set_bits(uintptr_t address, uint32_t bits, bool set)
{
    const uint32_t before = mmio_model_get(address);

    mmio_model_set(address, set ? before | bits : before & ~bits);
}

void panel_start(void)
{
    mmio_model_hook((struct mmio_hook){REG_INPUTS_EDGES, REG_INPUTS_EDGES, 0, clear_ones, 0});
    mmio_model_hook((struct mmio_hook){REG_BUTTONS_EVENTS, REG_BUTTONS_EVENTS, 0, clear_ones, 0});
}

void panel_ttl(enum inputs_ttl pin, bool level, uint32_t at_cycles)
{
    const bool in0 = pin == INPUTS_IN0;
    const uint32_t rose = in0 ? REG_INPUTS_EDGES_IN0_ROSE_MASK : REG_INPUTS_EDGES_IN1_ROSE_MASK;
    const uint32_t fell = in0 ? REG_INPUTS_EDGES_IN0_FELL_MASK : REG_INPUTS_EDGES_IN1_FELL_MASK;

    set_bits(REG_INPUTS_LEVELS, in0 ? REG_INPUTS_LEVELS_IN0_MASK : REG_INPUTS_LEVELS_IN1_MASK,
             level);
    set_bits(REG_INPUTS_EDGES, level ? rose : fell, true);
    mmio_model_set(in0 ? REG_INPUTS_IN0_TIME : REG_INPUTS_IN1_TIME, at_cycles);
}

void panel_press(enum button button, enum button_length length, uint32_t at_cycles)
{
    static const uint32_t duration_ms[] = {200, 1500, 4000};

    mmio_model_set(REG_BUTTONS_PRESS0 + 4u * button,
                   duration_ms[length] | (uint32_t)length << REG_BUTTONS_PRESS0_LENGTH_SHIFT);
    mmio_model_set(REG_BUTTONS_TIME0 + 4u * button, at_cycles);
    set_bits(REG_BUTTONS_EVENTS, 1u << button, true);
}

void panel_analog(unsigned channel, double level)
{
    mmio_model_set(REG_ADC_CHANNEL0 + 4 * channel, (uint32_t)(level * 4095 + 0.5));
    set_bits(REG_ADC_STATUS, REG_ADC_STATUS_VALID_MASK, true);
}

void panel_turn(unsigned knob, int edges)
{
    const uintptr_t address = REG_KNOB_POSITION0 + 4 * knob;

    mmio_model_set(address, (mmio_model_get(address) + (uint32_t)edges) & 0xffff);
}
