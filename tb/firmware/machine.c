/* SPDX-License-Identifier: BSD-2-Clause */
#include "machine.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "host/mmio.h"
#include "modules/axis.h"
#include "port.h"
#include "regs.h"
#include "rig.h"

/* A motor of 7 ms and 7.48 mm/s at full drive less friction on a screw of 45396 counts/mm. */
static const double friction = 0.1, breakaway = 0.15;
static const double full_counts_per_tick = 7.48 / 0.9 * 45396 * AXIS_TICK_US * 1e-6,
                    gain_per_tick = AXIS_TICK_US / 7000.0;

static double position[4], speed[4];
static uint64_t time_fast;

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
    int32_t counts[4];

    time_fast += 200 * AXIS_TICK_US;
    for (unsigned axis = 0; axis < 4; axis++) {
        position[axis] += speed[axis] = next_speed(speed[axis], pwm_duty_read(axis) / 2500.0);
        counts[axis] = (int32_t)floor(position[axis]);
    }
    rig_latch(time_fast, counts);
}

static void tick(void)
{
    for (unsigned n = 0; n < 200 / AXIS_TICK_US; n++) {
        stage_tick();
        axis_tick();
    }
    rig_turn();
}

void machine_start(void)
{
    mmio_model_reset();
    memset(position, 0, sizeof position);
    memset(speed, 0, sizeof speed);
    time_fast = 0;
    rig_start();
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

double machine_target(char axis)
{
    char line[8];

    snprintf(line, sizeof line, "M %c?", axis);
    return atof(machine_send(line) + 5);
}
