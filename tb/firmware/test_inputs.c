/* SPDX-License-Identifier: BSD-2-Clause */
/* Buttons, joystick, knobs, DIP switches and TTL inputs: what hands do, down to what moves. */
#include "check.h"

#include <math.h>
#include <stdlib.h>

#include "core/fault.h"
#include "core/settings.h"
#include "host/mmio.h"
#include "machine.h"
#include "modules/coordinates.h"
#include "modules/inputs.h"
#include "modules/modules.h"
#include "modules/motion.h"
#include "modules/tuning.h"
#include "panel.h"
#include "port.h"
#include "regs.h"

#define SEND(text, reply) CHECK_TEXT(machine_send(text), reply)
#define DONE ":A \r\n"
#define MM 45396.0
#define TICKS_PER_MS 5u /* of machine_run */

static void start(void)
{
    machine_start();
    SEND("SU X- Y-", DONE); /* kept at once by tests before */
    panel_start();
    for (const struct module *const *module = firmware_modules; *module != NULL; module++)
        if ((*module)->init != NULL)
            (*module)->init();
    for (unsigned channel = 0; channel < 8; channel++)
        panel_analog(channel, 0.5);
    machine_run(200);
    (void)port_drain();
}

/* What is said within some milliseconds. */
static const char *hear(unsigned ms)
{
    machine_run(ms * TICKS_PER_MS);
    return port_drain();
}

static double position_mm(unsigned axis)
{
    return motion_position_counts(axis) / MM;
}

/* Speed over some milliseconds, mm/s. */
static double speed_mm_per_s(unsigned axis, unsigned ms)
{
    const double before = position_mm(axis);

    machine_run(ms * TICKS_PER_MS);
    return (position_mm(axis) - before) / ms * 1e3;
}

#define CHECK_NEAR(value, expected, tolerance)                                                     \
    do {                                                                                           \
        const double check_v = (value);                                                            \
        if (fabs(check_v - (expected)) > (tolerance))                                              \
            CHECK_FAIL("%g is not %g", check_v, (double)(expected));                               \
    } while (0)

/* --- Buttons ---------------------------------------------------------------------------------- */

TEST(presses_of_the_joystick_button_are_said)
{
    start();
    panel_press(BUTTON_JOYSTICK, BUTTON_SHORT, 0);
    CHECK_TEXT(hear(2), "");
    SEND("VB X=2", DONE);
    panel_press(BUTTON_JOYSTICK, BUTTON_SHORT, 0);
    CHECK_TEXT(hear(2), "p\r\n");
    panel_press(BUTTON_JOYSTICK, BUTTON_LONG, 0);
    CHECK_TEXT(hear(2), "P\r\n");
    panel_press(BUTTON_JOYSTICK, BUTTON_EXTRA_LONG, 0);
    CHECK_TEXT(hear(2), "P\r\n");
    panel_press(BUTTON_HOME, BUTTON_LONG, 0);
    CHECK_TEXT(hear(2), "");
}

TEST(a_press_is_taken_once)
{
    start();
    SEND("VB X=2", DONE);
    panel_press(BUTTON_JOYSTICK, BUTTON_SHORT, 0);
    CHECK_TEXT(hear(200), "p\r\n");
}

TEST(zero_makes_all_axes_0_or_z_alone)
{
    start();
    SEND("H X=100 Y=200 Z=300", DONE);
    SEND("BE Z=47", DONE);
    panel_press(BUTTON_ZERO, BUTTON_SHORT, 0);
    (void)hear(2);
    SEND("W X Y Z", ":A 100.0 200.0 0.0 \r\n");
    SEND("BE Z=15", DONE);
    panel_press(BUTTON_ZERO, BUTTON_SHORT, 0);
    CHECK_TEXT(hear(2), "");
    SEND("W X Y Z", ":A 0.0 0.0 0.0 \r\n");
}

TEST(buttons_that_are_switched_off_do_nothing)
{
    start();
    SEND("VB X=2", DONE);
    SEND("H X=100", DONE);
    SEND("BE Z=12", DONE);
    panel_press(BUTTON_ZERO, BUTTON_SHORT, 0);
    CHECK_TEXT(hear(2), "");
    SEND("W X", ":A 100.0 \r\n");
    panel_press(BUTTON_JOYSTICK, BUTTON_SHORT, 0);
    CHECK_TEXT(hear(2), "p\r\n");
    SEND("BE X=0", DONE);
    SEND("BE X? Z?", ":A X=0 Z=0\r\n");
    panel_press(BUTTON_JOYSTICK, BUTTON_SHORT, 0);
    CHECK_TEXT(hear(2), "");
    SEND("BE X=1", DONE);
    SEND("BE X? Z?", ":A X=15 Z=15\r\n");
    panel_press(BUTTON_ZERO, BUTTON_SHORT, 0);
    (void)hear(2);
    SEND("W X", ":A 0.0 \r\n");
}

TEST(functions_of_presses_are_settings)
{
    start();
    SEND("BCA X? Y? Z? F? T? R? M?", ":A X=3 Y=3 Z=3 F=3 T=3 R=3 M=3\r\n");
    SEND("BCA X=7", ":N-4\r\n");
    SEND("BE M=0", DONE);
    SEND("H X=100", DONE);
    panel_press(BUTTON_ZERO, BUTTON_SHORT, 0);
    (void)hear(2);
    SEND("W X", ":A 100.0 \r\n");
    SEND("BE M=3", DONE);
    panel_press(BUTTON_ZERO, BUTTON_LONG, 0); /* nothing is long about ZERO */
    (void)hear(2);
    SEND("W X", ":A 100.0 \r\n");
    panel_press(BUTTON_ZERO, BUTTON_SHORT, 0);
    (void)hear(2);
    SEND("W X", ":A 0.0 \r\n");
}

TEST(the_ring_buffer_has_its_buttons)
{
    start();
    SEND("RM X=0", DONE);
    panel_press(BUTTON_JOYSTICK, BUTTON_LONG, 0); /* stores a point */
    (void)hear(2);
    SEND("RM X?", ":A X=1\r\n");
    panel_press(BUTTON_HOME, BUTTON_LONG, 0); /* clears them */
    (void)hear(2);
    SEND("RM X?", ":A X=0\r\n");
}

TEST(stamps_are_of_the_release)
{
    start();
    mmio_model_set(REG_TIMER_COUNT, 5000);
    mmio_model_set(REG_SNAPSHOT_SAMPLE_TIME_LOW, 1000000);
    mmio_model_set(REG_SNAPSHOT_SAMPLE_TIME_HIGH, 7);
    CHECK(inputs_time_fast(4000) == (UINT64_C(7) << 32) + 1000000 - 4000);
    CHECK(inputs_time_fast(0xfffff000) == (UINT64_C(7) << 32) + 1000000 - 4 * (5000 + 4096));
}

/* --- TTL inputs ------------------------------------------------------------------------------- */

TEST(a_short_pulse_at_in1_is_said_as_both_edges)
{
    start();
    SEND("VB X=4", DONE);
    panel_ttl(INPUTS_IN1, true, 0);
    panel_ttl(INPUTS_IN1, false, 10);
    CHECK_TEXT(hear(2), "H\r\nL\r\n");
    panel_ttl(INPUTS_IN1, true, 20);
    CHECK_TEXT(hear(2), "H\r\n");
    panel_ttl(INPUTS_IN1, false, 30);
    panel_ttl(INPUTS_IN1, true, 40);
    CHECK_TEXT(hear(2), "L\r\nH\r\n");
    CHECK_TEXT(hear(100), "");
}

TEST(an_edge_at_in0_triggers_once)
{
    start();
    SEND("TTL X=10", DONE); /* each pulse toggles OUT0 */
    SEND("TTL", ":A 1\r\n");
    panel_ttl(INPUTS_IN0, true, 0);
    panel_ttl(INPUTS_IN0, false, 1);
    (void)hear(2);
    SEND("TTL", ":A 0\r\n");
    panel_ttl(INPUTS_IN0, true, 0);
    (void)hear(2);
    SEND("TTL", ":A 1\r\n");
    panel_ttl(INPUTS_IN0, false, 0);
    (void)hear(2);
    SEND("TTL", ":A 1\r\n");
}

/* --- Analog inputs and DIP switches ----------------------------------------------------------- */

TEST(rdadc_prints_eight_bits_of_a_channel)
{
    start();
    SEND("RA X Y", ":A 128 128\r\n");
    panel_analog(0, 0);
    panel_analog(1, 1);
    panel_analog(3, 0.25);
    SEND("RA F Y X", ":A 0 255 64\r\n");
    SEND("RA", ":N-3\r\n");
    SEND("RA Q", ":N-2\r\n");
    SEND("RA X=1", ":N-4\r\n");
}

static void restart(unsigned dip)
{
    mmio_model_set(REG_INPUTS_LEVELS, dip << REG_INPUTS_LEVELS_DIP_SHIFT);
    mmio_model_set(REG_IDENTITY_CLOCK_HZ, 50000000);
    settings_load();
    for (const struct module *const *module = firmware_modules; *module != NULL; module++)
        if ((*module)->init != NULL)
            (*module)->init();
}

TEST(switches_4_and_5_set_the_rate)
{
    static const double rates[] = {115200, 28800, 19200, 9600};

    start();
    for (unsigned dip = 0; dip < 16; dip++) {
        restart(dip);
        CHECK_NEAR(50e6 / mmio_model_get(REG_SERIAL_DIVISOR), rates[dip % 4], rates[dip % 4] / 500);
    }
}

TEST(switches_7_and_8_reverse_y_and_x)
{
    start();
    restart(4);
    SEND("H X=0 Y=0", DONE);
    SEND("M X=10000 Y=20000", DONE);
    CHECK_INT(motion_target_counts(0), 45396);
    CHECK_INT(motion_target_counts(1), -90792);
    SEND("SU Y=1", DONE);
    SEND("M Y=20000", DONE);
    CHECK_INT(motion_target_counts(1), -45396);
    SEND("UM Y=-10000", DONE);
    CHECK(!coordinates_mirrored(1) && !coordinates_mirrored(0));
    SEND("UM Y=10000", DONE);
    restart(8);
    CHECK(coordinates_mirrored(0) && !coordinates_mirrored(1));
}

TEST(a_setting_stands_in_for_switches)
{
    start();
    restart(9);
    SEND("DIP X? Y?", ":A X=9 Y=-1\r\n");
    SEND("DIP X=1", ":N-4\r\n");
    SEND("DIP Y=4", DONE);
    CHECK(coordinates_mirrored(1) && !coordinates_mirrored(0));
    SEND("DIP X? Y?", ":A X=9 Y=4\r\n");
    SEND("DIP Y=-1", DONE);
    CHECK(coordinates_mirrored(0) && !coordinates_mirrored(1));
}

/* --- Joystick --------------------------------------------------------------------------------- */

/* Speed of a level, by the words of joystick.c: half the range, deadband, square law, percent. */
static double expected_mm_per_s(double level, double percent)
{
    const double off = level * 2 - 1, net = (fabs(off) - 0.06) / 0.94;

    return net <= 0 ? 0 : copysign(net * net, off) * percent / 100 * motion_speed_max_mm_per_s(0);
}

TEST(a_deflection_is_a_speed)
{
    static const double levels[] = {0.6, 0.75, 1.0, 0.2, 0.0};

    start();
    for (unsigned n = 0; n < sizeof levels / sizeof *levels; n++) {
        const double expected = expected_mm_per_s(levels[n], 100);

        panel_analog(0, levels[n]);
        machine_run(300 * TICKS_PER_MS);
        CHECK_NEAR(speed_mm_per_s(0, 200), expected, 0.01 + 0.03 * fabs(expected));
        SEND("/", "N\r\n");
        CHECK_INT(atoi(machine_send("RS X") + 3) & 9, 8); /* not busy, joystick connected */
    }
    panel_analog(0, 0.52);
    machine_run(300 * TICKS_PER_MS);
    CHECK_NEAR(speed_mm_per_s(0, 200), 0, 0.001);
    CHECK_NEAR(position_mm(1), 0, 0.001);
}

TEST(the_button_makes_it_slow_while_it_moves)
{
    start();
    panel_analog(1, 1.0);
    machine_run(300 * TICKS_PER_MS);
    CHECK_NEAR(speed_mm_per_s(1, 100), expected_mm_per_s(1, 100), 0.2);
    panel_press(BUTTON_JOYSTICK, BUTTON_SHORT, 0);
    machine_run(300 * TICKS_PER_MS);
    CHECK_NEAR(speed_mm_per_s(1, 100), expected_mm_per_s(1, 5), 0.02);
    SEND("JS Y=-10", DONE);
    panel_analog(1, 0.5);
    machine_run(100 * TICKS_PER_MS);
    panel_analog(1, 1.0);
    machine_run(300 * TICKS_PER_MS);
    CHECK_NEAR(speed_mm_per_s(1, 100), -expected_mm_per_s(1, 10), 0.02);
}

TEST(it_stops_at_the_soft_limits)
{
    start();
    SEND("SU X=1", DONE);
    panel_analog(0, 1.0);
    machine_run(1500 * TICKS_PER_MS);
    CHECK_NEAR(position_mm(0), 1, 0.001);
    for (unsigned entry = 0; entry < FAULT_LOG; entry++) /* a hand at the limit is no error */
        CHECK(fault_read(entry) != FAULT_LIMIT_UPPER);
    panel_analog(0, 0.0);
    machine_run(300 * TICKS_PER_MS);
    CHECK_NEAR(speed_mm_per_s(0, 50), expected_mm_per_s(0, 100), 0.1);
}

TEST(it_does_not_drive_back_from_beyond_a_limit)
{
    start();
    SEND("SU X=-1", DONE); /* the axis is at 0, beyond it */
    panel_analog(0, 1.0);
    machine_run(300 * TICKS_PER_MS);
    CHECK_NEAR(position_mm(0), 0, 0.001);
    panel_analog(0, 0.0);
    machine_run(300 * TICKS_PER_MS);
    CHECK(position_mm(0) < -0.5);
}

TEST(after_a_halt_it_must_be_let_go)
{
    start();
    panel_analog(0, 0.8);
    machine_run(300 * TICKS_PER_MS);
    SEND("HALT", DONE);
    machine_run(300 * TICKS_PER_MS);
    CHECK_NEAR(speed_mm_per_s(0, 100), 0, 0.001);
    panel_analog(0, 0.5);
    machine_run(100 * TICKS_PER_MS);
    panel_analog(0, 0.8);
    machine_run(300 * TICKS_PER_MS);
    CHECK_NEAR(speed_mm_per_s(0, 100), expected_mm_per_s(0.8, 100), 0.1);
}

TEST(a_command_takes_the_axis_and_a_hand_does_not_disturb_it)
{
    start();
    panel_analog(0, 0.8);
    machine_run(300 * TICKS_PER_MS);
    SEND("M X=0", DONE);
    SEND("/", "B\r\n");
    CHECK(machine_wait());
    machine_run(200 * TICKS_PER_MS);
    CHECK_NEAR(position_mm(0), 0, 0.001); /* and stays, the joystick still held */
    panel_analog(0, 0.5);
    machine_run(100 * TICKS_PER_MS);
    SEND("M X=10000", DONE);
    panel_analog(0, 0.0);
    CHECK(machine_wait());
    CHECK_NEAR(position_mm(0), 1, 0.05);
}

TEST(devices_are_settings)
{
    start();
    SEND("J X? Y? Z? F?", ":A X=2 Y=3 Z=4 F=23\r\n");
    SEND("J X-", DONE);
    SEND("J X?", ":A X=0\r\n");
    CHECK_INT(atoi(machine_send("RS X") + 3) & 8, 0);
    panel_analog(0, 1.0);
    machine_run(200 * TICKS_PER_MS);
    CHECK_NEAR(position_mm(0), 0, 0.001);
    SEND("J Y=2", DONE); /* one joystick, another axis */
    machine_run(300 * TICKS_PER_MS);
    CHECK(position_mm(1) > 0.5);
    SEND("J Y-", DONE);
    machine_run(200 * TICKS_PER_MS);
    CHECK_NEAR(speed_mm_per_s(1, 100), 0, 0.001);
    SEND("J X+ Y+", DONE);
    SEND("J X? Y?", ":A X=2 Y=3\r\n");
    SEND("J X=8", ":N-4\r\n");
    SEND("J X=1", DONE);
    SEND("J X?", ":A X=2\r\n");
}

TEST(without_a_converter_there_is_no_joystick)
{
    start();
    mmio_model_set(REG_ADC_STATUS, 0);
    mmio_model_set(REG_ADC_CHANNEL0, 0);
    machine_run(300 * TICKS_PER_MS);
    CHECK_NEAR(position_mm(0), 0, 0.001);
}

/* --- Knobs ------------------------------------------------------------------------------------ */

TEST(a_knob_moves_its_axis_by_distances)
{
    start();
    panel_turn(0, 40); /* 40 edges of 5 % of 10 um */
    machine_run(300 * TICKS_PER_MS);
    CHECK_NEAR(position_mm(2), 0.02, 0.0005);
    SEND("/", "N\r\n");
    SEND("JS Z=-50", DONE);
    panel_turn(0, 8);
    machine_run(300 * TICKS_PER_MS);
    CHECK_NEAR(position_mm(2), -0.02, 0.0005);
    panel_turn(0, -8);
    machine_run(300 * TICKS_PER_MS);
    CHECK_NEAR(position_mm(2), 0.02, 0.0005);
}

TEST(edges_of_less_than_a_count_are_not_lost)
{
    start();
    SEND("JS Z=0.1", DONE); /* 10 nm, 0.454 counts */
    for (unsigned n = 0; n < 100; n++) {
        panel_turn(0, 1);
        machine_run(40 * TICKS_PER_MS);
    }
    CHECK_NEAR(motion_target_counts(2), 45, 1);
}

TEST(the_knob_goes_over_to_the_last_axis_and_back)
{
    start();
    SEND("BE F=2", DONE);
    panel_turn(0, 40);
    machine_run(300 * TICKS_PER_MS);
    CHECK_NEAR(position_mm(2), 0, 0.0005);
    CHECK_NEAR(position_mm(3), 0.02, 0.0005);
    SEND("BCA Y=2", DONE);
    panel_press(BUTTON_AT, BUTTON_LONG, 0);
    machine_run(50 * TICKS_PER_MS);
    panel_turn(0, 40);
    machine_run(300 * TICKS_PER_MS);
    CHECK_NEAR(position_mm(2), 0.02, 0.0005);
    CHECK_NEAR(position_mm(3), 0.02, 0.0005);
}

TEST_MAIN(RUN(presses_of_the_joystick_button_are_said); RUN(a_press_is_taken_once);
          RUN(zero_makes_all_axes_0_or_z_alone); RUN(buttons_that_are_switched_off_do_nothing);
          RUN(functions_of_presses_are_settings); RUN(the_ring_buffer_has_its_buttons);
          RUN(stamps_are_of_the_release); RUN(a_short_pulse_at_in1_is_said_as_both_edges);
          RUN(an_edge_at_in0_triggers_once); RUN(rdadc_prints_eight_bits_of_a_channel);
          RUN(switches_4_and_5_set_the_rate); RUN(switches_7_and_8_reverse_y_and_x);
          RUN(a_setting_stands_in_for_switches); RUN(a_deflection_is_a_speed);
          RUN(the_button_makes_it_slow_while_it_moves); RUN(it_stops_at_the_soft_limits);
          RUN(it_does_not_drive_back_from_beyond_a_limit); RUN(after_a_halt_it_must_be_let_go);
          RUN(a_command_takes_the_axis_and_a_hand_does_not_disturb_it); RUN(devices_are_settings);
          RUN(without_a_converter_there_is_no_joystick); RUN(a_knob_moves_its_axis_by_distances);
          RUN(edges_of_less_than_a_count_are_not_lost);
          RUN(the_knob_goes_over_to_the_last_axis_and_back))
