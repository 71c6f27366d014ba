/* SPDX-License-Identifier: BSD-2-Clause */
#include "stage.h"

#include <stddef.h>
#include <string.h>

#include "host/mmio.h"
#include "modules/axis.h"
#include "modules/motion.h"
#include "port.h"
#include "regs.h"
#include "rig.h"

struct stage_line stage_lines[STAGE_LINES];
unsigned stage_line_count;
int32_t stage_position[AXIS_COUNT];
bool stage_sync;
int32_t stage_end_error;
uint32_t stage_merged;
unsigned stage_silent;
bool stage_estop;

static uint64_t time_fast;

/* --- The scan line, from its contract -------------------------------------------------------- */

static struct {
    bool armed, late, refused;
    uint32_t events;
    int32_t reference;
    bool reverse, emit;
    unsigned sync_axis, encoder_axis;
    uint64_t pitch_q32;
    uint32_t phase, pixels;
    int64_t progress, best; /* edges along the line since SYNC: now, and at most so far */
    uint32_t produced;
    int32_t end_counts;
} line;

static uint32_t reg(uintptr_t address)
{
    return mmio_model_get(address);
}

static void arm(void)
{
    const uint32_t config = reg(REG_COMPARE_CONFIG);
    const uint32_t width = reg(REG_DIVIDER_WIDTH);

    memset(&line, 0, sizeof line);
    stage_sync = false;
    line.sync_axis = config & REG_COMPARE_CONFIG_AXIS_MASK;
    line.reverse = (config & REG_COMPARE_CONFIG_REVERSE_MASK) != 0;
    line.reference = (int32_t)reg(REG_COMPARE_REFERENCE);
    line.encoder_axis = reg(REG_DIVIDER_AXIS);
    line.pitch_q32 = (uint64_t)reg(REG_DIVIDER_WHOLE) << 32 | reg(REG_DIVIDER_FRACTION);
    line.phase = reg(REG_DIVIDER_PHASE);
    line.pixels = reg(REG_DIVIDER_PIXELS);
    line.emit = (reg(REG_DIVIDER_CONFIG) & REG_DIVIDER_CONFIG_EMIT_MASK) != 0;
    line.refused = line.pixels == 0 || line.pitch_q32 >> 32 == 0 || width == 0 ||
                   width + 2 > reg(REG_DIVIDER_INTERVAL_MIN);
    if (line.refused)
        return;

    /* Upward edge r makes count r, so counts below r are before it; downward it makes r - 1. */
    const int32_t count = stage_position[line.sync_axis];
    line.late = line.reverse ? count < line.reference : count >= line.reference;
    line.armed = !line.late;
    if (line.late)
        line.events |= REG_COMPARE_INTERRUPT_LATE_MASK;
}

static void fire(void)
{
    struct stage_line *record = &stage_lines[stage_line_count];

    line.armed = false;
    line.events |= REG_COMPARE_INTERRUPT_STARTED_MASK;
    stage_sync = true;
    if (stage_line_count == STAGE_LINES)
        return;
    memset(record, 0, sizeof *record);
    record->sync_axis = line.sync_axis;
    record->encoder_axis = line.encoder_axis;
    record->reverse = line.reverse;
    record->emit = line.emit;
    record->sync_edge = line.reference;
    record->width_fast = reg(REG_DIVIDER_WIDTH);
    memcpy(record->at, stage_position, sizeof record->at);
    stage_line_count++;
}

static void advance(int32_t edge)
{
    struct stage_line *record = &stage_lines[stage_line_count - 1];
    const uint64_t next_q32 = (uint64_t)(line.produced + 1) * line.pitch_q32 + line.phase;

    if ((uint64_t)line.best != next_q32 >> 32)
        return;
    if (line.produced < STAGE_PIXELS)
        record->pixel_edge[line.produced] = edge;
    line.produced++;
    record->pixels = line.produced;
    line.end_counts = line.reverse ? edge - 1 : edge;
    if (line.produced == line.pixels) {
        line.events |= REG_COMPARE_INTERRUPT_FINISHED_MASK;
        record->finished = true;
        stage_sync = false;
    }
}

/* The decoder of an axis crosses an edge, upward or downward. */
static void cross(unsigned axis, int32_t edge, bool up)
{
    const bool along = up != line.reverse;

    if (line.armed && axis == line.sync_axis && edge == line.reference && along) {
        fire();
        return;
    }
    if (!stage_sync || axis != line.encoder_axis)
        return;
    line.progress += along ? 1 : -1;
    if (line.progress > line.best) {
        line.best = line.progress;
        advance(edge);
    }
}

static void step(unsigned axis, bool up)
{
    const int32_t edge = up ? stage_position[axis] + 1 : stage_position[axis];

    stage_position[axis] += up ? 1 : -1;
    cross(axis, edge, up);
}

static uint32_t read_line(void *context, uintptr_t address)
{
    (void)context;
    switch (address) {
    case REG_COMPARE_STATUS:
        return (line.armed ? REG_COMPARE_STATUS_ARMED_MASK : 0) |
               (stage_sync ? REG_COMPARE_STATUS_ACTIVE_MASK : 0) |
               (line.late ? REG_COMPARE_STATUS_LATE_MASK : 0);
    case REG_COMPARE_INTERRUPT:
        return line.events;
    case REG_DIVIDER_STATUS:
        return (line.refused ? REG_DIVIDER_STATUS_REFUSED_MASK : 0) |
               (stage_merged != 0 ? REG_DIVIDER_STATUS_MERGED_MASK : 0);
    case REG_DIVIDER_MERGED:
        return stage_merged;
    case REG_DIVIDER_PRODUCED:
        return line.produced;
    case REG_DIVIDER_END_POSITION:
        return (uint32_t)(line.end_counts + stage_end_error);
    default:
        return mmio_model_get(address);
    }
}

static void write_line(void *context, uintptr_t address, uint32_t value)
{
    (void)context;
    if (address == REG_COMPARE_INTERRUPT) {
        line.events &= ~value;
    } else if (address == REG_COMPARE_CONTROL) {
        if ((value & REG_COMPARE_CONTROL_DISARM_MASK) != 0) {
            line.armed = false;
            stage_sync = false;
        } else if ((value & REG_COMPARE_CONTROL_ARM_MASK) != 0) {
            arm();
        }
    } else {
        mmio_model_set(address, value);
    }
}

/* --- The rest -------------------------------------------------------------------------------- */

static uint32_t read_pwm_events(void *context, uintptr_t address)
{
    (void)context;
    (void)address;
    return REG_PWM_INTERRUPT_TICK_MASK;
}

static void show_positions(void)
{
    rig_latch(time_fast, stage_position);
    mmio_model_set(REG_INPUTS_LEVELS, stage_estop ? REG_INPUTS_LEVELS_ESTOP_MASK : 0);
}

void stage_start(void)
{
    memset(stage_position, 0, sizeof stage_position);
    memset(&line, 0, sizeof line);
    stage_line_count = 0;
    stage_sync = false;
    stage_end_error = 0;
    stage_merged = 0;
    stage_silent = 0;
    stage_estop = false;
    time_fast = 0;

    mmio_model_reset();
    mmio_model_hook((struct mmio_hook){.first = REG_COMPARE_CONFIG, .last = REG_COMPARE_INTERRUPT,
                                       .read = read_line, .write = write_line});
    mmio_model_hook((struct mmio_hook){.first = REG_DIVIDER_AXIS, .last = REG_DIVIDER_MERGED,
                                       .read = read_line, .write = write_line});
    mmio_model_hook((struct mmio_hook){.first = REG_PWM_INTERRUPT, .last = REG_PWM_INTERRUPT,
                                       .read = read_pwm_events});
    mmio_model_set(REG_IDENTITY_FAST_CLOCK_HZ, 200000000);
    show_positions();
    rig_start();
    for (int n = 0; n < 200; n++)
        stage_tick();
}

static void follow(void)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        struct axis_view view;

        if ((stage_silent >> axis & 1u) != 0)
            continue;
        axis_read(axis, &view);
        const int32_t target =
            (int32_t)((view.setpoint.position_q32 + (INT64_C(1) << 31)) >> 32);
        while (stage_position[axis] != target)
            step(axis, target > stage_position[axis]);
    }
}

void stage_tick(void)
{
    for (unsigned n = 0; n < 200 / AXIS_TICK_US; n++) {
        time_fast += UINT64_C(200000000) / 1000000 * AXIS_TICK_US;
        show_positions();
        axis_tick();
        follow();
    }
    show_positions();
    rig_turn();
}

int stage_run(int limit)
{
    for (int n = 0; n < limit; n++) {
        if (!motion_busy())
            return n;
        stage_tick();
    }
    return -1;
}
