/* SPDX-License-Identifier: BSD-2-Clause */
#include "closed_loop.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/settings.h"
#include "host/mmio.h"
#include "interlock_model.h"
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
    bool inverted;
} decoders[4];

static unsigned phase_of(unsigned axis)
{
    const struct board_pins *pins = board_pins(board);
    unsigned a = pins->enc_a >> axis & 1, b = pins->enc_b >> axis & 1;

    return b ? 3 - a : a;
}

static void decode(int64_t at_ps)
{
    for (unsigned axis = 0; axis < 4; axis++) {
        struct decoder *d = &decoders[axis];
        unsigned phase = phase_of(axis), way = (phase - d->phase) % 4;

        d->phase = phase;
        if (way == 2)
            interlock_model_illegal(axis, at_ps);
        if (way % 2 == 0)
            continue;
        d->count += (way == 1) != d->inverted ? 1 : -1;
        interlock_model_count(axis, at_ps, d->count);
    }
}

static void write_encoder(void *context, uintptr_t address, uint32_t value)
{
    unsigned offset = (unsigned)(address - REG_QUADRATURE_CONFIG);

    (void)context;
    if (offset % REG_QUADRATURE_STRIDE == 0)
        decoders[offset / REG_QUADRATURE_STRIDE].inverted = (value & REG_QUADRATURE_CONFIG_INVERT_MASK) != 0;
}

static void connect_encoders(void)
{
    int32_t counts[4];

    mmio_model_hook((struct mmio_hook){
        .first = REG_QUADRATURE_CONFIG,
        .last = REG_QUADRATURE_CONFIG + REG_QUADRATURE_COUNT * REG_QUADRATURE_STRIDE - 4,
        .write = write_encoder});
    for (unsigned axis = 0; axis < 4; axis++) {
        counts[axis] = (int32_t)board_count(board, axis);
        decoders[axis] = (struct decoder){phase_of(axis), counts[axis], false};
    }
    interlock_model_start(counts);
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

/* The drives of this tick, and the hands on the stage; off: the interlock has taken the drive away. */
static struct {
    double motor, hand;
    bool off;
} driven[4];

static void take_duties(void)
{
    for (unsigned axis = 0; axis < 4; axis++) {
        const int32_t steps = pwm_duty_read(axis);

        interlock_model_drive(axis, now_ps, steps);
        driven[axis].off = interlock_model_off(axis);
        driven[axis].motor = driven[axis].off ? 0 : (reversed[axis] ? -1 : 1) * steps / 2500.0;
        driven[axis].hand = push[axis];
        board_drive(board, now_ps, axis, driven[axis].motor + driven[axis].hand);
    }
}

static void take_faults(void)
{
    for (unsigned axis = 0; axis < 4; axis++)
        if (interlock_model_off(axis) && !driven[axis].off) {
            driven[axis].off = true;
            board_drive(board, now_ps, axis, driven[axis].hand);
        }
}

/* Encoder edges, and faults that take a drive off, in the order of their times. */
static void run_until(int64_t end_ps)
{
    for (;;) {
        const int64_t edge_ps = board_next_ps(board), fault_ps = interlock_model_next_ps();

        now_ps = edge_ps < fault_ps ? edge_ps : fault_ps;
        if (now_ps > end_ps)
            break;
        if (edge_ps <= fault_ps) {
            if (board_next(board, NULL))
                decode(edge_ps);
        } else {
            board_advance(board, fault_ps);
            interlock_model_run(fault_ps);
        }
        take_faults();
    }
    now_ps = end_ps;
}

static void tick(void)
{
    decode(now_ps); /* hands on the wires since the last tick */
    run_until(now_ps + TICK_PS);
    board_advance(board, now_ps);
    interlock_model_run(now_ps);
    take_duties();
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
    memset(driven, 0, sizeof driven);
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

int64_t closed_loop_now_ps(void)
{
    return now_ps;
}

double closed_loop_position(unsigned axis)
{
    return latched[axis];
}
