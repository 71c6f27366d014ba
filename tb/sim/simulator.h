/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The Verilated controller on its board: clocks, pins and time.
 *
 * One `fast` edge every 5 ns and one `sync` edge every fourth, rising together. An encoder edge is seen by the first
 * `fast` edge after it, however close; the controller's pins move at the clock edge that moves them. The `cpu` clock
 * has the edges of `sync`, but for those that find `cpu_asleep` high, as the `fast` edge before has left it.
 *
 * Times are picoseconds since power-up; reset lasts for the first SIM_RESET_SYNC_CLOCKS.
 */
#ifndef SIMULATOR_H
#define SIMULATOR_H

#include <stddef.h>
#include <stdint.h>

#include "board/board.h"

#ifdef __cplusplus
extern "C" {
#endif

#define SIM_FAST_PERIOD_PS 5000
#define SIM_SYNC_PERIOD_PS 20000
#define SIM_RESET_SYNC_CLOCKS 16
#define SIM_FLASH_BYTES (16 << 20)

/** Pins that can be recorded and waited for; bits of a mask. In runs of four, for axes X, Y, Z, F. */
enum sim_signal {
    SIM_ENC_A = 0,
    SIM_ENC_B = 4,
    SIM_ENC_Z = 8,
    SIM_PWM = 12,
    SIM_DIR = 16,
    SIM_MOTOR_ENABLE = 20,
    SIM_ESTOP,
    SIM_IN0,
    SIM_IN1,
    SIM_SERIAL_RX,
    SIM_SERIAL_TX,
    SIM_OUT0,
    SIM_SYNC,
    SIM_ENCODER,
    SIM_REPORT_TX,
};

/** A recorded change of a pin. */
struct sim_change {
    int64_t time_ps;
    uint32_t signal;
    uint32_t level;
};

/** A recorded sample of the stage's true motion. */
struct sim_sample {
    int64_t time_ps;
    double position_counts[BOARD_AXES];
    double speed_counts_per_s[BOARD_AXES];
};

/** Why sim_run returned. */
enum sim_reason { SIM_TIME, SIM_PIN, SIM_LINES, SIM_FINISHED };

struct sim;

/**
 * @param plant      As for board_create.
 * @param arguments  Plusargs for the Verilog, such as "+firmware=FILE".
 * @return           NULL, with the reason in `error`, when the plant is refused.
 */
struct sim *sim_create(const char *plant, double baud, int argument_count, const char *const *arguments,
                       char *error, size_t error_size);
void sim_destroy(struct sim *sim);

/** The board, for all that board.h can do except driving its motors and its time. */
struct board *sim_board(struct sim *sim);

/** Everything before this time has happened; a multiple of the `sync` period. */
int64_t sim_time_ps(const struct sim *sim);

/**
 * Run for a duration, or until the end of the `sync` period in which a pin in `stop_rise` rose or one in `stop_fall`
 * fell, or in which the number of line feeds received since power-up reached `stop_lines` (0: never).
 */
enum sim_reason sim_run(struct sim *sim, int64_t duration_ps, uint32_t stop_rise, uint32_t stop_fall,
                        size_t stop_lines);

/** Change an input at a time to come, to the picosecond; changes are to be ordered by time. */
void sim_schedule_input(struct sim *sim, int64_t time_ps, enum board_input input, int level);

/* -- The flash, which is not fitted at first: its pin reads 1 ------------------------------------------------ */

/** Fit one with these contents, the rest of its SIM_FLASH_BYTES erased. Before time passes, and once. */
void sim_fit_flash(struct sim *sim, const uint8_t *bytes, size_t size);
/** Its contents now, SIM_FLASH_BYTES; a change under way is there as far as it is done. NULL: not fitted. */
const uint8_t *sim_flash(const struct sim *sim);
/** How long a page programmed and a sector erased take from now on. */
void sim_set_flash_times(struct sim *sim, int64_t program_ps, int64_t erase_ps);

/* -- The serial line --------------------------------------------------------------------------------------- */

void sim_serial_write(struct sim *sim, const uint8_t *bytes, size_t size);
/** Take up to `size` received bytes, and the times of their start bits; returns how many. */
size_t sim_serial_read(struct sim *sim, uint8_t *bytes, int64_t *start_ps, size_t size);
void sim_serial_set_baud(struct sim *sim, double baud);
/** Bytes written whose stop bit has not ended. */
size_t sim_serial_unsent(const struct sim *sim);
size_t sim_serial_lines(const struct sim *sim);
size_t sim_serial_framing_errors(const struct sim *sim);

/* -- The report port's line, from the controller only; at first at the rate of the other -------------------- */

/** As sim_serial_read. */
size_t sim_report_read(struct sim *sim, uint8_t *bytes, int64_t *start_ps, size_t size);
void sim_report_set_baud(struct sim *sim, double baud);
size_t sim_report_framing_errors(const struct sim *sim);

/* -- Records ----------------------------------------------------------------------------------------------- */

/** Record every change of these pins from now on; 0 stops. */
void sim_set_recording(struct sim *sim, uint32_t signals);
/** The levels of all pins now. */
uint32_t sim_levels(const struct sim *sim);
/** Take up to `size` changes, oldest first, in order of time; returns how many. */
size_t sim_take_changes(struct sim *sim, struct sim_change *changes, size_t size);

/** Sample the stage's motion every `period_ps` from now on; 0 stops. */
void sim_set_sampling(struct sim *sim, int64_t period_ps);
size_t sim_take_samples(struct sim *sim, struct sim_sample *samples, size_t size);

/** `sync` clocks so far, and how many of them the CPU was awake for. */
void sim_clocks(const struct sim *sim, uint64_t *sync, uint64_t *awake);

#ifdef __cplusplus
}
#endif

#endif
