/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The whole firmware on the host, application and all, over the board model: a controller whose
 * serial port is standard input and output (a pty, in test_transcripts.py).
 *
 *     controller [SETTINGS]        SETTINGS: file that keeps what is saved; default: memory
 *
 * For tests of what it says. Time is not real: while something moves, ticks follow each other as
 * fast as they can be computed; at rest about five pass each millisecond.
 */
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "../board/board.h"
#include "core/settings.h"
#include "host/interrupts.h"
#include "host/mmio.h"
#include "host/settings_file.h"
#include "hal/interrupts.h"
#include "modules/application.h"
#include "modules/axis.h"
#include "modules/motion.h"
#include "regs.h"

enum { TICKS_AT_REST = 5, BUFFER = 4096 };

static const int64_t tick_ps = INT64_C(1000000) * AXIS_TICK_US;

static const char plant[] =
#include "plant.h"
    ;

static struct board *board;
static int64_t now_ps;

/* --- The serial port --------------------------------------------------------------------------- */

static uint8_t received[BUFFER], sent[BUFFER];
static size_t received_length, received_at, sent_length;
static bool over;

static void flush(void)
{
    for (size_t at = 0; at < sent_length;) {
        ssize_t count = write(STDOUT_FILENO, sent + at, sent_length - at);

        if (count <= 0)
            exit(0); /* nobody is there */
        at += (size_t)count;
    }
    sent_length = 0;
}

/* Bytes from the host, after waiting for them at most so long. */
static void receive(int patience_ms)
{
    struct pollfd port = {.fd = STDIN_FILENO, .events = POLLIN};

    if (received_at < received_length || poll(&port, 1, patience_ms) <= 0)
        return;
    ssize_t count = read(STDIN_FILENO, received, sizeof received);

    received_at = 0;
    received_length = count > 0 ? (size_t)count : 0;
    over = count <= 0;
}

static uint32_t read_serial(void *context, uintptr_t address)
{
    (void)context;
    switch (address) {
    case REG_SERIAL_DATA:
        return received_at < received_length
                   ? REG_SERIAL_DATA_VALID_MASK | received[received_at++]
                   : 0;
    case REG_SERIAL_STATUS:
        return REG_SERIAL_STATUS_TX_READY_MASK | REG_SERIAL_STATUS_TX_IDLE_MASK;
    case REG_SERIAL_ERRORS:
        return 0;
    default:
        return mmio_model_get(address);
    }
}

static void write_serial(void *context, uintptr_t address, uint32_t value)
{
    (void)context;
    if (address != REG_SERIAL_DATA) {
        mmio_model_set(address, value);
        return;
    }
    if (sent_length == sizeof sent)
        flush();
    sent[sent_length++] = (uint8_t)value;
}

static bool serial_requests(void)
{
    return received_at < received_length ||
           (mmio_model_get(REG_SERIAL_INTERRUPT_ENABLE) &
            REG_SERIAL_INTERRUPT_ENABLE_TX_LOW_MASK) != 0;
}

/* --- The axes ---------------------------------------------------------------------------------- */

static void latch(void)
{
    const struct board_pins *pins = board_pins(board);
    uint64_t time_fast = (uint64_t)(now_ps / 5000);

    for (unsigned axis = 0; axis < BOARD_AXES; axis++) {
        uint32_t count = (uint32_t)(int32_t)board_count(board, axis);

        mmio_model_set(REG_SNAPSHOT_TICK_POSITION0 + 4 * axis, count);
        mmio_model_set(REG_SNAPSHOT_SAMPLE_POSITION0 + 4 * axis, count);
    }
    mmio_model_set(REG_SNAPSHOT_TICK_TIME_LOW, (uint32_t)time_fast);
    mmio_model_set(REG_SNAPSHOT_TICK_TIME_HIGH, (uint32_t)(time_fast >> 32));
    mmio_model_set(REG_INPUTS_LEVELS,
                   (uint32_t)pins->limit_lower << REG_INPUTS_LEVELS_LIMIT_LOWER_SHIFT |
                       (uint32_t)pins->limit_upper << REG_INPUTS_LEVELS_LIMIT_UPPER_SHIFT |
                       (uint32_t)pins->estop << REG_INPUTS_LEVELS_ESTOP_SHIFT);
}

/* The duties are taken half a tick after it. */
static void tick(void)
{
    now_ps += tick_ps;
    board_advance(board, now_ps);
    latch();
    host_interrupts_set(INTERRUPTS_TICK | (serial_requests() ? INTERRUPTS_SERIAL : 0));
    application_interrupt();
    host_interrupts_set(0);
    board_advance(board, now_ps + tick_ps / 2);
    for (unsigned axis = 0; axis < BOARD_AXES; axis++)
        board_drive(board, now_ps + tick_ps / 2, axis, pwm_duty_read(axis) / 2500.0);
    application_poll();
}

int main(int argc, char **argv)
{
    char error[200];

    board = board_create(plant, error, sizeof error);
    if (board == NULL) {
        fprintf(stderr, "board model: %s\n", error);
        return 2;
    }
    if (argc > 1)
        settings_init(settings_file(argv[1]));
    mmio_model_hook((struct mmio_hook){REG_SERIAL_DATA, REG_SERIAL_INTERRUPT_ENABLE, read_serial,
                                       write_serial, NULL});
    mmio_model_set(REG_IDENTITY_MAGIC, REG_MAGIC);
    mmio_model_set(REG_IDENTITY_MAP_VERSION, REG_MAP_VERSION);
    mmio_model_set(REG_IDENTITY_CLOCK_HZ, 50000000);
    latch();
    if (!application_init())
        return 2;
    while (!over) {
        bool busy = motion_busy() || application_busy();

        receive(busy ? 0 : 1);
        for (int n = busy ? 1 : TICKS_AT_REST; n > 0; n--)
            tick();
        flush();
    }
    return 0;
}
