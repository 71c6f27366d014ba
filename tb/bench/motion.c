/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * How fast and how well the firmware moves a stage: the whole firmware on the host, its servo closed
 * over the board model. Prints one line "name=value ..." for each trial; tb/bench/__main__.py judges.
 *
 *     motion <pitch mm> [<x.parameter>*=<factor> ...] [/<command> ...] [@<file>]
 *
 * The first are changes of the board model beside those of the screw, the second are commands sent
 * before the moves, and the file gets a line for every 200 us of the short move.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "closed_loop.h"
#include "hal/interlock.h"
#include "interlock_model.h"
#include "modules/axis.h"
#include "modules/motion.h"
#include "modules/screw.h"

enum { CHANGES_MAX = 12, LIMIT_TICKS = 200000 };

static const double ONE = 4294967296.0;
static const double TICK_MS = CLOSED_LOOP_TICK_US / 1000.0;

static FILE *trace;

static void fail(const char *what)
{
    fprintf(stderr, "motion: %s\n", what);
    exit(1);
}

static void send(const char *format, double value)
{
    char line[80];

    snprintf(line, sizeof line, format, value);
    if (strncmp(closed_loop_send(line), ":A", 2) != 0)
        fail(line);
}

static double setpoint(void)
{
    struct axis_view view;

    axis_read(0, &view);
    return (double)view.setpoint.position_q32 / ONE;
}

/* What a move comes to. Errors are of the true position, in counts. */
struct result {
    double ms;      /* from the command's reply to the first "not busy" */
    double error;   /* then */
    double later;   /* the largest in the 50 ms after it */
};

static struct result move(double target_mm, double counts_per_mm)
{
    struct result r = {0, 0, 0};
    double target = target_mm * counts_per_mm, from = closed_loop_position(0);

    send("M X=%.6f", target_mm * 10000);
    for (int n = 0; motion_busy(); n++) {
        if (n > LIMIT_TICKS)
            fail("a move did not end");
        closed_loop_tick();
        r.ms += TICK_MS;
        if (trace != NULL)
            fprintf(trace, "%.1f %.3f %.3f\n", r.ms, setpoint() - from,
                    closed_loop_position(0) - from);
    }
    /* A count is as wide as its edges are apart, its middle half a count on. */
    r.error = fabs(closed_loop_position(0) - floor(target + 0.5) - 0.5);
    for (int n = 0; n < 250; n++) {
        closed_loop_tick();
        r.later = fmax(r.later, fabs(closed_loop_position(0) - floor(target + 0.5) - 0.5));
    }
    return r;
}

/* The true position less a straight line of exactly the speed commanded, its offset free. */
static double following_rms(double speed_counts_per_ms, double ms)
{
    unsigned count = (unsigned)(ms / TICK_MS);
    double start = closed_loop_position(0), sum = 0, squares = 0;

    for (unsigned n = 1; n <= count; n++) {
        double error;

        closed_loop_tick();
        /* From the start on, so that the squares of small errors are not lost among great numbers. */
        error = closed_loop_position(0) - start - speed_counts_per_ms * TICK_MS * n;
        sum += error;
        squares += error * error;
    }
    return sqrt(fmax(0, squares / count - sum / count * (sum / count)));
}

/* Constant speed on a way of 9 mm, from a place on. */
static double follow(double speed_mm_per_s, double ramp_ms, double ms, double from_mm,
                     double counts_per_mm)
{
    double rms;

    send("S X=%.6f", speed_mm_per_s);
    send("M X=%.3f", from_mm * 10000 + 90000);
    closed_loop_run((unsigned)((ramp_ms + 60) / TICK_MS));
    rms = following_rms(speed_mm_per_s * counts_per_mm / 1000, ms);
    closed_loop_send("\\");
    closed_loop_run(1000);
    return rms;
}

int main(int argc, char **argv)
{
    struct closed_loop_change changes[CHANGES_MAX] = {{0}};
    const struct screw *screw;
    struct result far, near;
    unsigned used = 3;
    double slow, fast;
    struct interlock_nearness interlock;
    FILE *file = NULL;

    if (argc < 2)
        fail("expected a pitch in mm");
    screw = screw_of_pitch(atof(argv[1]));
    if (screw == NULL)
        fail("expected the pitch of a screw that the firmware knows");
    /* Relative to plant.toml's 6.35 mm. */
    changes[0] = (struct closed_loop_change){"x.pitch_mm", screw->pitch_mm / 6.35};
    changes[1] = (struct closed_loop_change){"x.counts_per_mm", screw->counts_per_mm / 45396};
    changes[2] = (struct closed_loop_change){"x.maximum_speed_mm_per_s",
                                             screw->speed_max_mm_per_s / 6.8};
    for (int i = 2; i < argc; i++) {
        char *factor = strstr(argv[i], "*=");

        if (argv[i][0] == '@')
            file = fopen(argv[i] + 1, "w");
        if (factor == NULL)
            continue;
        if (used == CHANGES_MAX - 1)
            fail("too many changes");
        *factor = '\0';
        changes[used++] = (struct closed_loop_change){argv[i], atof(factor + 2)};
    }
    closed_loop_start(changes);
    send("SCREW X=%.4f", screw->pitch_mm);
    send("S X=%.6f", screw->speed_max_mm_per_s);
    send("PC X=%.6f", screw->resolution_mm);
    send("E X=%.6f", 2 * screw->resolution_mm);
    for (int i = 2; i < argc; i++)
        if (argv[i][0] == '/')
            send(argv[i] + 1, 0);

    far = move(9, screw->counts_per_mm);
    trace = file;
    near = move(9.2, screw->counts_per_mm);
    trace = NULL;
    fast = follow(screw->speed_max_mm_per_s, 20, 0.6 * 9000 / screw->speed_max_mm_per_s - 80, 9.2,
                  screw->counts_per_mm);
    slow = follow(0.0776 * screw->speed_max_mm_per_s, 20, 1000, 20, screw->counts_per_mm);
    interlock = interlock_model_nearness();
    printf("far_ms=%.1f far_error=%.2f far_later=%.2f near_ms=%.1f near_error=%.2f near_later=%.2f "
           "fast_rms=%.3f slow_rms=%.3f strong=%.2f drive=%.2f speed=%.2f following=%.3f faults=%u\n",
           far.ms, far.error, far.later, near.ms, near.error, near.later, fast, slow,
           interlock.strong, interlock.drive, interlock.speed, interlock.following,
           (unsigned)interlock_faults());
    if (file != NULL)
        fclose(file);
    return 0;
}
