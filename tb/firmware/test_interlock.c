/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The interlock on the board model, by its contract (interlock_model.c) and the firmware's limits: what breaks is found
 * in time and moves little, what is well is left alone, and the user is told.
 */
#include "check.h"

#include <math.h>
#include <stdlib.h>

#include "closed_loop.h"
#include "core/fault.h"
#include "hal/interlock.h"
#include "hal/interrupts.h"
#include "hal/watchdog.h"
#include "host/interrupts.h"
#include "host/mmio.h"
#include "interlock_model.h"
#include "modules/application.h"
#include "modules/axis.h"
#include "modules/interlock.h"
#include "modules/motion.h"
#include "random.h"
#include "regs.h"

#define DONE ":A \r\n"
#define SEND(line) CHECK_TEXT(closed_loop_send(line), DONE)

enum { X, Y, TICKS_PER_MS = 1000 / CLOSED_LOOP_TICK_US, TRIALS = 400 };

static const double COUNTS_PER_MM = 45396, US = 1e6;

static void start(const struct closed_loop_change *changes)
{
    closed_loop_start(changes);
    fault_clear();
}

/* Bits 0 and 1: A and B break; bits 2 and 3: the levels they then have. */
static void stick(unsigned wires)
{
    for (unsigned n = 0; n < 2; n++)
        if ((wires >> n & 1) != 0)
            board_stick_wire(closed_loop_board(), X, n == 0 ? BOARD_WIRE_A : BOARD_WIRE_B, wires >> (2 + n) & 1);
}

static void mend(void)
{
    board_stick_wire(closed_loop_board(), X, BOARD_WIRE_A, -1);
    board_stick_wire(closed_loop_board(), X, BOARD_WIRE_B, -1);
}

/* What a broken wire came to. */
struct outcome {
    double us; /* from the break, or from the last change of the drive if that came later, to off; or -1: never */
    double mm; /* from the break until it stood */
};

static struct outcome after_break(unsigned wires)
{
    struct outcome r = {-1, 0};
    const double at = closed_loop_position(X);
    int64_t from_ps = closed_loop_now_ps();
    bool illegal;

    stick(wires);
    for (int n = 0; n < 2000 * TICKS_PER_MS && !interlock_model_off(X); n++)
        closed_loop_tick();
    if (interlock_model_driven_ps(X) > from_ps)
        from_ps = interlock_model_driven_ps(X);
    if (interlock_model_off(X))
        r.us = fmax(0, (double)(interlock_model_off_ps(X) - from_ps) / US);
    closed_loop_run(60 * TICKS_PER_MS);
    r.mm = fabs(closed_loop_position(X) - at) / COUNTS_PER_MM;
    /* Both wires at once may also be an illegal transition. */
    illegal = fault_read(0) == FAULT_ENCODER && (wires & 3) == 3;
    if (r.us >= 0 && fault_read(0) != FAULT_AXIS_DEAD + X && !illegal)
        r.us = -1;
    mend();
    return r;
}

static double worst(double before, double now)
{
    return now > before ? now : before;
}

/* Open loop at a constant drive, in the open: time in ms from its start to the break. */
static struct outcome spin(int32_t steps, double after_ms, unsigned wires)
{
    start(NULL);
    axis_spin(X, steps);
    closed_loop_run((unsigned)(after_ms * TICKS_PER_MS));
    return after_break(wires);
}

TEST(a_broken_wire_at_strong_drive_is_off_within_a_millisecond)
{
    double us = 0, mm = 0;

    for (int n = 0; n < TRIALS; n++) {
        const int32_t steps = (int32_t)(random_below(2) != 0 ? 1 : -1) * (int32_t)(1250 + random_below(1251));
        const struct outcome r = spin(steps, 3 + random_below(200) / 5.0, 1 + random_below(3) + 4 * random_below(4));

        CHECK(r.us >= 0 && r.us <= 1000);
        us = worst(us, r.us);
        mm = worst(mm, r.mm);
    }
    printf("# %d breaks at 50 to 100 %% of drive: off after %.0f us at most, standing after %.4f mm\n", TRIALS, us, mm);
    CHECK(mm < 0.06);
}

TEST(a_broken_wire_above_breakaway_is_off_within_twenty_milliseconds)
{
    double us = 0, mm = 0;

    for (int n = 0; n < TRIALS / 2; n++) {
        const int32_t steps = (int32_t)(random_below(2) != 0 ? 1 : -1) * (int32_t)(380 + random_below(1250 - 380));
        const struct outcome r = spin(steps, random_below(300) / 5.0, 1 + random_below(3) + 4 * random_below(4));

        CHECK(r.us >= 0 && r.us <= 20000);
        us = worst(us, r.us);
        mm = worst(mm, r.mm);
    }
    printf("# %d breaks at 15 to 50 %% of drive: off after %.0f us at most, standing after %.4f mm\n", TRIALS / 2, us, mm);
    CHECK(mm < 0.12);
}

/* As it starts from rest the break itself may look like its first step, and the time begins anew with the second. */
TEST(a_wire_that_breaks_as_the_axis_starts_is_found_too)
{
    double us = 0, mm = 0;
    int late = 0;

    for (int n = 0; n < TRIALS; n++) {
        const struct outcome r = spin(1250 + (int32_t)random_below(1251), random_below(16) / 5.0,
                                      1 + random_below(3) + 4 * random_below(4));

        CHECK(r.us >= 0 && r.us <= 1800);
        late += r.us > 1000;
        us = worst(us, r.us);
        mm = worst(mm, r.mm);
    }
    printf("# %d breaks within 3 ms of the order to start: off after %.0f us at most, %d after more than a "
           "millisecond, standing after %.4f mm\n", TRIALS, us, late, mm);
    CHECK(late < TRIALS / 5 && mm < 0.02);
}

/* Moves under the servo, broken anywhere: whatever the loop makes of it, and however it drives. */
TEST(a_broken_wire_in_a_move_moves_little)
{
    double mm = 0;

    for (int n = 0; n < TRIALS; n++) {
        char line[40];
        struct outcome r;

        start(NULL);
        snprintf(line, sizeof line, "S X=%.3f", 0.01 + random_below(680) / 100.0);
        SEND(line);
        snprintf(line, sizeof line, "AC X=%u", 10 + random_below(60));
        SEND(line);
        SEND(random_below(2) != 0 ? "M X=60000" : "M X=-60000");
        closed_loop_run(random_below(400));
        r = after_break(1 + random_below(3) + 4 * random_below(4));
        CHECK(r.us >= 0 || !motion_axis_busy(X));
        mm = worst(mm, r.mm);
    }
    printf("# %d breaks in moves: standing after %.4f mm at most\n", TRIALS, mm);
    CHECK(mm < 0.3);
}

TEST(the_user_is_told_and_takes_it_back_when_the_cause_is_gone)
{
    struct board *board = closed_loop_board();
    const struct board_pins *pins;

    start(NULL);
    board = closed_loop_board();
    SEND("M X=40000 Y=40000");
    closed_loop_run(500);
    CHECK_TEXT(closed_loop_send("MC X+"), DONE);
    pins = board_pins(board);
    board_stick_wire(board, X, BOARD_WIRE_A, !(pins->enc_a & 1));
    board_stick_wire(board, X, BOARD_WIRE_B, !(pins->enc_b & 1));
    closed_loop_run(2);
    mend();
    closed_loop_tick();
    CHECK_INT(fault_read(0), FAULT_ENCODER);
    CHECK_TEXT(closed_loop_send("RS X-"), ":A D\r\n");
    CHECK_TEXT(closed_loop_send("MC X?"), ":A 0\r\n");
    /* It counts for 10 ms. */
    CHECK_TEXT(closed_loop_send("MC Y+ X+"), ":N-5\r\n");
    CHECK_TEXT(closed_loop_send("MC X?"), ":A 0\r\n");
    closed_loop_run(20 * TICKS_PER_MS);
    SEND("MC X+");
    CHECK_TEXT(closed_loop_send("MC X?"), ":A 1\r\n");
    closed_loop_run(40 * TICKS_PER_MS);
    SEND("R X=1000");
    CHECK(closed_loop_wait(5000) > 0);
    CHECK(interlock_faults() == 0);
}

TEST(an_axis_that_is_too_fast_is_stopped)
{
    const struct closed_loop_change changes[] = {{"x.counts_per_mm", 4}, {NULL, 0}};

    start(changes);
    axis_spin(X, 2500);
    closed_loop_run(100 * TICKS_PER_MS);
    CHECK_INT(fault_read(0), FAULT_RUNAWAY + X);
    CHECK(interlock_model_off(X) && !interlock_model_off(Y));
    CHECK_TEXT(closed_loop_send("RS X-"), ":A D\r\n");
    SEND("MC X+");
    CHECK(!interlock_model_off(X));
}

TEST(an_axis_that_falls_too_far_behind_is_stopped)
{
    const struct closed_loop_change changes[] = {{"x.speed_scale", 0.2}, {NULL, 0}};

    start(changes);
    SEND("RU X=0.1"); /* 0.8 mm */
    SEND("S X=5");
    SEND("M X=100000");
    closed_loop_run(1000 * TICKS_PER_MS);
    CHECK_INT(fault_read(0), FAULT_ENCODER_OVERFLOW + X);
    CHECK(interlock_model_off(X));
    CHECK(closed_loop_position(X) < 2 * COUNTS_PER_MM);
    SEND("MC X+");
    closed_loop_run(100);
    CHECK(!interlock_model_off(X) && motion_ready(X));
}

/* Loads that come at once or slowly, stay, turn round and go, up to a part of full drive. */
static void load(double most)
{
    static double present;
    const double next = (random_below(2000) / 1000.0 - 1) * most;
    const unsigned ticks = 1 + random_below(1500);
    const bool slowly = random_below(3) == 0;

    for (unsigned n = 1; n <= ticks; n++) {
        closed_loop_push(X, slowly ? present + (next - present) * n / ticks : next);
        closed_loop_tick();
    }
    present = next;
}

static void start_holding(const struct closed_loop_change *changes)
{
    start(changes);
    closed_loop_send("MA X=2");
    closed_loop_send("M X=1000");
    (void)closed_loop_wait(5000);
}

TEST(a_load_is_held_without_a_fault)
{
    static const struct closed_loop_change frictions[][3] = {
        {{NULL, 0}},
        {{"x.running_friction", 1.3}, {"x.breakaway_friction", 1.3}, {NULL, 0}},
        {{"x.running_friction", 0.7}, {"x.breakaway_friction", 0.7}, {NULL, 0}},
    };

    for (int n = 0; n < 9; n++) {
        start_holding(frictions[n % 3]);
        CHECK(motion_in_position(X));
        for (int loads = 0; loads < 40; loads++)
            load(0.25);
        closed_loop_push(X, 0.25);
        closed_loop_run(1000 * TICKS_PER_MS);
        CHECK_INT(fault_read(0), FAULT_NONE);
        CHECK(fabs(closed_loop_position(X) - 4540) < 100);
    }
    for (int n = 0; n < 4; n++) {
        start_holding(NULL);
        for (int loads = 0; loads < 40; loads++)
            load(0.45);
        CHECK_INT(fault_read(0), FAULT_NONE);
    }
}

/* And while it is held a wire breaks: the drive then follows an error that does not change, slowly. */
TEST(a_wire_that_breaks_while_a_load_is_held_moves_little)
{
    double mm = 0;

    for (int n = 0; n < 60; n++) {
        start_holding(NULL);
        for (int loads = 0; loads < 4; loads++)
            load(0.25);
        closed_loop_push(X, random_below(500) / 1000.0 - 0.25);
        closed_loop_run(random_below(300));
        mm = worst(mm, after_break(1 + random_below(3) + 4 * random_below(4)).mm);
    }
    printf("# 60 breaks while loads up to 25 %% are held: standing after %.4f mm at most\n", mm);
    CHECK(mm < 1);
}

TEST(a_nanometre_a_second_is_no_standstill)
{
    for (int n = 0; n < 5; n++) {
        static const char *const speeds[] = {"S X=0.000001", "S X=0.00001", "S X=0.0001", "S X=0.001", "S X=0.01"};

        start(NULL);
        SEND(speeds[n]);
        SEND("M X=1000000");
        closed_loop_run(20000 * TICKS_PER_MS);
        CHECK_INT(interlock_faults(), 0);
        CHECK(motion_axis_busy(X));
        printf("# %s: nearest to a fault: strong %.2f, drive %.2f\n", speeds[n], interlock_model_nearness().strong,
               interlock_model_nearness().drive);
    }
}

static unsigned kicks;

static void count_kick(void *context, uintptr_t address, uint32_t value)
{
    (void)context;
    kicks += address == REG_WATCHDOG_KICK && value == WATCHDOG_KICK_WORD;
}

/* Each tick kicks the watchdog, for a second after the main loop came round last. */
TEST(a_main_loop_that_hangs_is_no_longer_covered_for)
{
    const unsigned a_second = 1000000 / AXIS_TICK_US;

    start(NULL);
    mmio_model_hook((struct mmio_hook){
        .first = REG_WATCHDOG_KICK, .last = REG_WATCHDOG_KICK, .write = count_kick});
    interrupts_enable(INTERRUPTS_TICK);
    host_interrupts_set(INTERRUPTS_TICK);
    application_alive();
    kicks = 0;
    for (unsigned n = 0; n < 2 * a_second; n++)
        application_interrupt();
    CHECK_INT(kicks, a_second);
    application_alive();
    application_interrupt();
    CHECK_INT(kicks, a_second + 1);
    host_interrupts_set(0);
    interrupts_enable(0);
}

/* After a reset of the processor the axes are released, and the user can see what happened. */
TEST(a_start_after_the_watchdog_is_logged)
{
    start(NULL);
    mmio_model_set(REG_WATCHDOG_STATUS, WATCHDOG_EXPIRED);
    interlock_model_reset_processor();
    CHECK(interlock_model_off(X) && interlock_model_off(Y));
    interlock_module.init();
    CHECK_INT(fault_read(0), FAULT_TASK_OVERTIME);
    CHECK(!interlock_model_off(X) && !interlock_model_off(Y));
    fault_clear();
    interlock_module.init();
    CHECK_INT(fault_read(0), FAULT_NONE);
}

TEST_MAIN(RUN(a_broken_wire_at_strong_drive_is_off_within_a_millisecond);
          RUN(a_broken_wire_above_breakaway_is_off_within_twenty_milliseconds);
          RUN(a_wire_that_breaks_as_the_axis_starts_is_found_too); RUN(a_broken_wire_in_a_move_moves_little);
          RUN(the_user_is_told_and_takes_it_back_when_the_cause_is_gone);
          RUN(an_axis_that_is_too_fast_is_stopped); RUN(an_axis_that_falls_too_far_behind_is_stopped);
          RUN(a_main_loop_that_hangs_is_no_longer_covered_for); RUN(a_start_after_the_watchdog_is_logged);
          RUN(a_load_is_held_without_a_fault);
          RUN(a_wire_that_breaks_while_a_load_is_held_moves_little); RUN(a_nanometre_a_second_is_no_standstill))
