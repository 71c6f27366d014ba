/* SPDX-License-Identifier: BSD-2-Clause */
#include "machine.h"

#include <math.h>
#include <string.h>

#include "core/action.h"
#include "core/events.h"
#include "core/fault.h"
#include "host/mmio.h"
#include "modules/axis.h"
#include "modules/coordinates.h"
#include "modules/limits.h"
#include "modules/modules.h"
#include "port.h"
#include "regs.h"

/* A motor of 7 ms and 7.48 mm/s at full drive less friction on a screw of 45396 counts/mm. */
static const double friction = 0.1, breakaway = 0.15;
static const double full_counts_per_tick = 7.48 / 0.9 * 45396 * AXIS_TICK_US * 1e-6,
                    gain_per_tick = AXIS_TICK_US / 7000.0;

static double position[4], speed[4];

static double next_speed(double before, double duty)
{
    double way = before != 0 ? before : duty, after;

    if (before == 0 && fabs(duty) <= breakaway)
        return 0;
    duty -= way > 0 ? friction : -friction;
    after = before + (duty * full_counts_per_tick - before) * gain_per_tick;
    return after * way > 0 ? after : 0;
}

static void stage_tick(void)
{
    uint64_t time_fast = (uint64_t)mmio_model_get(REG_SNAPSHOT_TICK_TIME_HIGH) << 32 |
                         mmio_model_get(REG_SNAPSHOT_TICK_TIME_LOW);

    time_fast += 200 * AXIS_TICK_US;
    mmio_model_set(REG_SNAPSHOT_TICK_TIME_LOW, (uint32_t)time_fast);
    mmio_model_set(REG_SNAPSHOT_TICK_TIME_HIGH, (uint32_t)(time_fast >> 32));
    for (unsigned axis = 0; axis < 4; axis++) {
        double duty = pwm_duty_read(axis) / 2500.0;

        position[axis] += speed[axis] = next_speed(speed[axis], duty);
        mmio_model_set(REG_SNAPSHOT_TICK_POSITION0 + 4 * axis,
                       (uint32_t)(int32_t)floor(position[axis]));
        mmio_model_set(REG_SNAPSHOT_SAMPLE_POSITION0 + 4 * axis,
                       (uint32_t)(int32_t)floor(position[axis]));
    }
}

static void tick(void)
{
    for (unsigned n = 0; n < 200 / AXIS_TICK_US; n++) {
        stage_tick();
        axis_tick();
    }
    for (const struct module *const *module = firmware_modules; *module != NULL; module++)
        if ((*module)->poll != NULL)
            (*module)->poll();
    fault_poll();
    events_poll();
}

void machine_start(void)
{
    mmio_model_reset();
    memset(position, 0, sizeof position);
    memset(speed, 0, sizeof speed);
    axis_init();
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        coordinates_set_origin(axis, 0);
    limits_open();
    events_set_clock(axis_time_fast);
    action_init(firmware_claims);
    port_start(firmware_modules);
    machine_run(10);
}

void machine_run(unsigned ticks)
{
    while (ticks-- > 0)
        tick();
}

const char *machine_bytes(const void *bytes, size_t length)
{
    tick();
    return port_bytes(bytes, length);
}

const char *machine_send(const char *line)
{
    tick();
    return port_send(line);
}

bool machine_wait(void)
{
    for (unsigned ticks = 0; ticks < 50000; ticks += 50) {
        machine_run(50);
        if (strcmp(port_send("/"), "N\r\n") == 0)
            return true;
    }
    return false;
}
