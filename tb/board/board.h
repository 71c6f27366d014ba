/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The simulated board: four axes of motor, lead screw, friction, encoder and switches, and the input pins.
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
};

/** One encoder edge. */
struct board_edge {
    int64_t time_ps;
    int64_t count; /**< After the edge. */
    uint8_t axis;
    int8_t direction; /**< +1 or -1. */
};

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

/* -- Time -------------------------------------------------------------------------------------------------- */

/** When the next thing happens: an encoder edge, or the end of the plant step. */
int64_t board_next_ps(const struct board *board);

/** Let it happen. Returns 1 and fills `edge` (if not NULL) for an encoder edge, 0 for the end of a step. */
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

/** Cut the PWM wires of these axes (bit mask): their drive is 0 from the next plant step on, whatever comes. */
void board_cut_pwm(struct board *board, unsigned axes);

/** Hold an encoder wire at a level; -1 lets it go. The motor does not notice. */
void board_stick_wire(struct board *board, unsigned axis, enum board_wire wire, int level);

#ifdef __cplusplus
}
#endif

#endif
