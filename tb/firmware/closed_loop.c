/* SPDX-License-Identifier: BSD-2-Clause */
#include "closed_loop.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/settings.h"
#include "host/mmio.h"
#include "modules/axis.h"
#include "modules/motion.h"
#include "port.h"
#include "regs.h"
#include "rig.h"

/* A servo tick. Duties are taken two PWM periods after theirs (DutyDelay of rtl/pwm.py): at the next. */
enum { TICK_PS = AXIS_TICK_US * 1000000 };
_Static_assert(AXIS_TICK_PWM_PERIODS == 2, "duties are taken at the next tick");

static const char plant[] =
#include "plant.h"
    ;

static struct board *board;
static int64_t now_ps;
static double push[4];
static bool reversed[4];
static double latched[4]; /* true positions at the last tick */

/* A decoder for each encoder, by its contract: the phase of the pins goes round by one. */
static struct decoder {
    unsigned phase;
    int32_t count;
    bool inverted, error;
} decoders[4];

static unsigned phase_of(unsigned axis)
{
    const struct board_pins *pins = board_pins(board);
    unsigned a = pins->enc_a >> axis & 1, b = pins->enc_b >> axis & 1;

    return b ? 3 - a : a;
}

static void decode(void)
{
    for (unsigned axis = 0; axis < 4; axis++) {
        struct decoder *d = &decoders[axis];
        unsigned phase = phase_of(axis), way = (phase - d->phase) % 4;

        d->phase = phase;
        d->error |= way == 2;
        if (way % 2 != 0)
            d->count += (way == 1) != d->inverted ? 1 : -1;
    }
}

static uint32_t read_status(void *context, uintptr_t address)
{
    unsigned offset = (unsigned)(address - REG_QUADRATURE_CONFIG);

    (void)context;
    if (offset % REG_QUADRATURE_STRIDE != REG_QUADRATURE_STATUS - REG_QUADRATURE_CONFIG)
        return mmio_model_get(address);
    return decoders[offset / REG_QUADRATURE_STRIDE].error ? REG_QUADRATURE_STATUS_ERROR_MASK : 0;
}

static void write_encoder(void *context, uintptr_t address, uint32_t value)
{
    unsigned offset = (unsigned)(address - REG_QUADRATURE_CONFIG);
    struct decoder *d = &decoders[offset / REG_QUADRATURE_STRIDE];

    (void)context;
    if (offset % REG_QUADRATURE_STRIDE == 0)
        d->inverted = (value & REG_QUADRATURE_CONFIG_INVERT_MASK) != 0;
    else if ((value & REG_QUADRATURE_STATUS_ERROR_MASK) != 0)
        d->error = false;
}

static void connect_encoders(void)
{
    mmio_model_hook((struct mmio_hook){
        .first = REG_QUADRATURE_CONFIG,
        .last = REG_QUADRATURE_CONFIG + REG_QUADRATURE_COUNT * REG_QUADRATURE_STRIDE - 4,
        .read = read_status, .write = write_encoder});
    for (unsigned axis = 0; axis < 4; axis++)
        decoders[axis] = (struct decoder){phase_of(axis), (int32_t)board_count(board, axis), 0, 0};
}

/* The parameters' text with some values multiplied. */
static void change(char *text, size_t size, const struct closed_loop_change *changes)
{
    const char *line = plant;
    size_t length = 0;

    while (*line != '\0') {
        size_t name = strcspn(line, "="), all = strcspn(line, "\n") + 1;
        double value = atof(line + name + 1);

        for (const struct closed_loop_change *c = changes; c != NULL && c->name != NULL; c++)
            if (strlen(c->name) == name && strncmp(c->name, line, name) == 0)
                value *= c->factor;
        length += (size_t)snprintf(text + length, size - length, "%.*s=%.17g\n", (int)name, line,
                                   value);
        line += all;
    }
}

/* The input pins and latched positions, as the firmware's registers. */
static void latch(void)
{
    const struct board_pins *pins = board_pins(board);
    int32_t counts[4];

    for (unsigned axis = 0; axis < 4; axis++) {
        latched[axis] = board_position_counts(board, axis, now_ps);
        counts[axis] = decoders[axis].count;
    }
    rig_latch((uint64_t)(now_ps / 5000), counts);
    mmio_model_set(REG_INPUTS_LEVELS,
                   (uint32_t)pins->limit_lower << REG_INPUTS_LEVELS_LIMIT_LOWER_SHIFT |
                       (uint32_t)pins->limit_upper << REG_INPUTS_LEVELS_LIMIT_UPPER_SHIFT |
                       (uint32_t)pins->estop << REG_INPUTS_LEVELS_ESTOP_SHIFT);
}

static void tick(void)
{
    now_ps += TICK_PS;
    decode(); /* hands on the wires since the last tick */
    while (board_next_ps(board) <= now_ps)
        if (board_next(board, NULL))
            decode();
    board_advance(board, now_ps);
    for (unsigned axis = 0; axis < 4; axis++)
        board_drive(board, now_ps, axis,
                    (reversed[axis] ? -1 : 1) * pwm_duty_read(axis) / 2500.0 + push[axis]);
    latch();
    axis_tick();
}

void closed_loop_tick(void)
{
    for (unsigned n = 0; n < CLOSED_LOOP_TICK_US / AXIS_TICK_US; n++)
        tick();
    rig_turn();
}

void closed_loop_run(unsigned ticks)
{
    while (ticks-- > 0)
        closed_loop_tick();
}

void closed_loop_start(const struct closed_loop_change *changes)
{
    static char text[16384];
    char error[200];

    change(text, sizeof text, changes);
    if (board != NULL)
        board_destroy(board);
    board = board_create(text, error, sizeof error);
    if (board == NULL) {
        printf("board model: %s\n", error);
        exit(2);
    }
    now_ps = 0;
    memset(push, 0, sizeof push);
    memset(reversed, 0, sizeof reversed);
    mmio_model_reset();
    connect_encoders();
    latch();
    settings_ram_clear();
    rig_start();
    closed_loop_run(2 * AXIS_REST_TURNS * AXIS_TURN_US / CLOSED_LOOP_TICK_US);
}

struct board *closed_loop_board(void)
{
    return board;
}

const char *closed_loop_send(const char *line)
{
    closed_loop_tick();
    return port_send(line);
}

const char *closed_loop_ask(const char *line, int limit)
{
    static char reply[200];
    size_t length = 0;

    port_queue(line);
    port_queue("\r");
    reply[0] = '\0';
    while (limit-- > 0 && strchr(reply, '\n') == NULL) {
        closed_loop_tick();
        length += (size_t)snprintf(reply + length, sizeof reply - length, "%s", port_take(0));
    }
    return reply;
}

int closed_loop_wait(int limit)
{
    for (int ticks = 0; ticks <= limit; ticks++) {
        if (!motion_busy())
            return ticks;
        closed_loop_tick();
    }
    return -1;
}

void closed_loop_push(unsigned axis, double drive)
{
    push[axis] = drive;
}

void closed_loop_reverse(unsigned axis, bool is_reversed)
{
    reversed[axis] = is_reversed;
}

double closed_loop_position(unsigned axis)
{
    return latched[axis];
}
