/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The whole firmware on the host, its servo closed over the board model: how well it moves.
 *
 * Each servo tick applies the duties of the one before, as the gateware does, latches the board's
 * counts into the snapshot registers and runs the firmware's tick interrupt.
 */
#ifndef TB_FIRMWARE_CLOSED_LOOP_H
#define TB_FIRMWARE_CLOSED_LOOP_H

#include <stdbool.h>
#include <stdint.h>

#include "../board/board.h"

/**
 * Power up on a board whose parameters differ from plant.toml as these say: "x.running_friction"
 * and a factor, ended by NULL. Nothing is kept from before. Runs until the axes are regulated.
 */
struct closed_loop_change {
    const char *name;
    double factor;
};
void closed_loop_start(const struct closed_loop_change *changes);

/** The board, to watch and to disturb. */
struct board *closed_loop_board(void);

/** Let 200 us of servo ticks pass, a tick of these functions; then the main loop. */
enum { CLOSED_LOOP_TICK_US = 200 };
void closed_loop_tick(void);
void closed_loop_run(unsigned ticks);

/** Send a line, CR added; its reply. Takes one tick. */
const char *closed_loop_send(const char *line);

/** The same for a line whose reply takes time: run until it is complete, at most `limit` ticks. */
const char *closed_loop_ask(const char *line, int limit);

/** Run until STATUS would say N; ticks it took, or -1: not within `limit` ticks. */
int closed_loop_wait(int limit);

/** A hand on the stage: adds this fraction of full drive until it is 0 again. */
void closed_loop_push(unsigned axis, double drive);

/** Exchange the wires of a motor. */
void closed_loop_reverse(unsigned axis, bool reversed);

/** Time of the last tick. */
int64_t closed_loop_now_ps(void);

/** True position of an axis at the last tick, counts. */
double closed_loop_position(unsigned axis);

#endif
