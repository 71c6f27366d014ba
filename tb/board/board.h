/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The simulated board: four axes of motor, lead screw, friction, encoder and switches; buttons, knobs, DIP switches
 * and analog inputs; the other input pins.
 *
 * One model for the Verilated gateware, the firmware's host build and the tests. Motors are integrated on a fixed
 * grid (the plant step, 5 us): a step takes the mean of the drive over the step before it. Within a step the
 * velocity is linear in time, so encoder edges have exact times, to a picosecond, wherever they fall.
 *
 * The encoder moves only through the motor, and the motor only through the drive. The same calls at the same
 * times give the same edges, bit for bit.
 *
 * Times are picoseconds since power-up. Positions are encoder counts from the middle of the travel, positive in
 * the direction of a positive drive. An encoder edge e is the boundary between counts e-1 and e.
 */
#ifndef BOARD_H
#define BOARD_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { BOARD_AXES = 4 };

/** Levels at the controller's input pins. In the masks, bit n belongs to axis n (X, Y, Z, F). */
struct board_pins {
    uint8_t enc_a;
    uint8_t enc_b;
    uint8_t enc_z;
    uint8_t limit_lower; /**< 1: switch closed. Changes at the end of a plant step. */
    uint8_t limit_upper;
    uint8_t estop; /**< 1: drives off. */
    uint8_t in0;
    uint8_t in1;
    uint8_t button; /**< 1: pressed. Bit n is board_contact n; they bounce. */
    uint8_t joystick_button;
    uint8_t dip; /**< 1: on. Bits 0 to 3: switches 4, 5, 7, 8. */
    uint8_t knob_a; /**< Bit n: knob n. */
    uint8_t knob_b;
    uint8_t adc_miso; /**< From the converter. */
};

/** One encoder edge. */
struct board_edge {
    int64_t time_ps;
    int64_t count; /**< After the edge. */
    uint8_t axis;
    int8_t direction; /**< +1 or -1. */
};

enum board_contact { BOARD_AT, BOARD_HOME, BOARD_ZERO, BOARD_JOYSTICK, BOARD_JOYSTICK_WIRE };
enum { BOARD_KNOBS = 3, BOARD_CHANNELS = 8 };
enum board_input { BOARD_ESTOP, BOARD_IN0, BOARD_IN1 };
enum board_wire { BOARD_WIRE_A, BOARD_WIRE_B, BOARD_WIRE_Z };

struct board;

/**
 * Build a board, at rest, at time 0.
 *
 * @param parameters  "name=value" lines as tb/board/plant.py prints them; every parameter exactly as in plant.toml.
 * @param error       Receives the reason when the result is NULL.
 * @return            NULL when a parameter is missing, unknown, or makes no sense.
 */
struct board *board_create(const char *parameters, char *error, size_t error_size);
void board_destroy(struct board *board);

/* -- Drive ------------------------------------------------------------------------------------------------- */

/**
 * From `time_ps` on, drive a motor with this fraction of the supply, -1..+1 (clamped); 0 brakes.
 * `time_ps` must not lie before an earlier call's, nor beyond the plant step that is running (clamped to it).
 */
void board_drive(struct board *board, int64_t time_ps, unsigned axis, double drive);

/** The same for all axes from the levels of the pins. A disabled bridge brakes. */
void board_drive_pins(struct board *board, int64_t time_ps, unsigned pwm, unsigned dir, int motor_enable);

/** The converter's pins, from the controller. adc_miso follows 15.5 ns later. */
void board_adc_pins(struct board *board, int64_t time_ps, int cs_n, int sck, int mosi);

/** In their place: a whole frame at once. The word to the converter; returns the one from it. */
uint16_t board_adc_frame(struct board *board, uint16_t word);

/* -- Time -------------------------------------------------------------------------------------------------- */

/** When the next thing happens: an encoder edge, a change of another pin, or the end of the plant step. */
int64_t board_next_ps(const struct board *board);

/** Let it happen. Returns 1 and fills `edge` (if not NULL) for an encoder edge, 0 for anything else. */
int board_next(struct board *board, struct board_edge *edge);

/** Let everything happen up to and including `time_ps`. */
void board_advance(struct board *board, int64_t time_ps);

/* -- What can be seen -------------------------------------------------------------------------------------- */

/** The levels now; the pointer stays valid, its target changes with board_next, board_advance and the switches. */
const struct board_pins *board_pins(const struct board *board);

/** The count that an ideal decoder would hold, had it started from the middle of the travel. */
int64_t board_count(const struct board *board, unsigned axis);

/** True position and speed at a time within the running plant step (clamped to it). */
double board_position_counts(const struct board *board, unsigned axis, int64_t time_ps);
double board_speed_counts_per_s(const struct board *board, unsigned axis, int64_t time_ps);

/* -- Hands on the board ------------------------------------------------------------------------------------ */

void board_set_input(struct board *board, enum board_input input, int level);

/** Press or release a button at a time to come; it bounces for up to contact_bounce_ms. */
void board_set_contact(struct board *board, int64_t time_ps, enum board_contact contact, int level);

/** The DIP switches, as in board_pins. */
void board_set_dip(struct board *board, unsigned levels);

/**
 * Turn a knob by so many edges, upward or downward, one every `interval_ps` from `time_ps` on; each bounces for up to
 * knob_bounce_us. To be done before it is turned again.
 */
void board_turn_knob(struct board *board, int64_t time_ps, unsigned knob, int edges, int64_t interval_ps);

/** Level of an analog input, 0 to 1 of the range. A joystick in the middle is 0.5. */
void board_set_analog(struct board *board, unsigned channel, double level);

/** Cut the PWM wires of these axes (bit mask): their drive is 0 from the next plant step on, whatever comes. */
void board_cut_pwm(struct board *board, unsigned axes);

/** Hold an encoder wire at a level; -1 lets it go. The motor does not notice. */
void board_stick_wire(struct board *board, unsigned axis, enum board_wire wire, int level);

#ifdef __cplusplus
}
#endif

#endif
