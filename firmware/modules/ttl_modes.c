/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/ttl_modes.h"

#include <stddef.h>

#include "core/axis.h"
#include "modules/led_dimmer.h"
#include "modules/ring_buffer.h"
#include "modules/scan.h"
#include "modules/ttl_in.h"
#include "modules/ttl_out.h"
#include "modules/ttl_report.h"
#include "modules/z_stack.h"

/* The profiles that have a mode. */
enum {
    ALL = 1 << TTL_PROFILE_ALL,
    IN0 = 1 << TTL_PROFILE_IN0_INT,
    ENC = 1 << TTL_PROFILE_ENC_INT,
    REPORT = 1 << TTL_PROFILE_REPORT_INT,
    ORDINARY = ALL | IN0,
};

/* In the profile that is all builds at once mode 1 is two of them: the pixel clock of a scan, and
 * otherwise the ring buffer. */
static bool ring_step_but_in_a_scan(struct ttl_step *step)
{
    return !scan_running() && ring_buffer_step(step);
}

/* The first that fits counts. */
const struct ttl_in_mode ttl_in_modes[] = {
    {.number = 0, .profiles = ALL | IN0 | ENC | REPORT},
    {.number = 1, .profiles = ALL, .pixels = true, .trigger = ring_buffer_trigger,
     .step = ring_step_but_in_a_scan, .stepped = ring_buffer_stepped},
    {.number = 1, .profiles = IN0, .trigger = ring_buffer_trigger, .step = ring_buffer_step,
     .stepped = ring_buffer_stepped},
    {.number = 1, .profiles = ENC, .pixels = true},
    {.number = 2, .profiles = ORDINARY, .step = ttl_in_repeat},
    {.number = 4, .profiles = ORDINARY, .step = z_stack_step,
     .stepped = z_stack_stepped},
    {.number = 5, .profiles = ORDINARY, .trigger = ttl_in_report, .end = ttl_in_report_end},
    {.number = 6, .profiles = ALL, .pixels = true, .trigger = scan_trigger},
    {.number = 6, .profiles = IN0, .trigger = scan_trigger},
    {.number = 10, .profiles = ORDINARY, .trigger = ttl_out_toggle},
    {.number = TTL_IN_SERVO_LOCK, .profiles = ORDINARY, .taken = true},
    {.number = 12, .profiles = ORDINARY, .trigger = ring_buffer_trigger,
     .step = ring_buffer_step_relative, .stepped = ring_buffer_stepped_relative},
    {.number = TTL_IN_ANY, .profiles = REPORT, .begin = ttl_report_begin, .end = ttl_report_end},
    {0},
};

const struct ttl_out_mode ttl_out_modes[] = {
    {.number = 0, .begin = ttl_out_low},
    {.number = 1, .begin = ttl_out_high},
    {.number = 2, .begin = ttl_out_low, .end = ttl_out_end_pulse},
    {.number = 3, .argument = 0, .level = ttl_out_at_constant_speed},
#if AXIS_COUNT > 1
    {.number = 4, .argument = 1, .level = ttl_out_at_constant_speed},
#endif
#if AXIS_COUNT > 2
    {.number = 5, .argument = 2, .level = ttl_out_at_constant_speed},
#endif
#if AXIS_COUNT > 3
    {.number = 6, .argument = 3, .level = ttl_out_at_constant_speed},
#endif
    {.number = 9, .begin = led_dimmer_on, .end = led_dimmer_off},
    {.number = -1},
};
