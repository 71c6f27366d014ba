/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Cuts the power of a controller at every step of something it does to its flash, and looks what is left.
 *
 *     powercut                                  the names of the scenarios
 *     powercut SCENARIO PART PARTS PAIRS SEED   one of them
 *
 * Of all cuts, numbered in order, this makes those that are PART modulo PARTS. After each, a controller powers up and
 * tells its state, which has to be the one before or the one after; then it does the thing again, which has to succeed.
 * Of PAIRS steps of this second time, spread evenly from a random one on, each is cut too, and looked at the same way.
 * Where there are few steps each is cut several times, as what a cut leaves is random.
 *
 * Prints `passed N failed M` now and then and at the end, and a line for each failure. Every controller is a process
 * of its own, so that nothing but the flash outlives a cut: this one only forks.
 */
#define _GNU_SOURCE
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "chip.h"
#include "scenario.h"

enum { REPORT_EVERY = 100, LEAST_CUTS = 256 };

/* What processes tell each other. */
static struct told {
    char state[SCENARIO_STATE_MAX];
} *told;

static const struct scenario *scenario;
static char before[SCENARIO_STATE_MAX], between[SCENARIO_STATE_MAX], after[SCENARIO_STATE_MAX];
static unsigned passed, failed;
static uint64_t pair_stride; /* 0: no pairs */
static uint64_t times;       /* that each step is cut */
static uint64_t part, parts;
static uint32_t seed;

static void give_up(const char *why)
{
    perror(why);
    exit(2);
}

/* --- Chips that processes share ---------------------------------------------------------------- */

static struct chip *map(int file, int flags)
{
    struct chip *chip = mmap(NULL, sizeof *chip, PROT_READ | PROT_WRITE, flags, file, 0);

    if (chip == MAP_FAILED)
        give_up("mmap");
    return chip;
}

static int new_file(void)
{
    const int file = memfd_create("chip", 0);

    if (file < 0 || ftruncate(file, sizeof(struct chip)) != 0)
        give_up("memfd_create");
    return file;
}

/* Only what is in use is copied: nobody touches the rest. */
static int copy_of(const struct chip *chip)
{
    const int file = new_file();
    struct chip *copy = map(file, MAP_SHARED);

    memcpy(copy->bytes + SCENARIO_FIRST, chip->bytes + SCENARIO_FIRST, SCENARIO_END - SCENARIO_FIRST);
    memcpy(&copy->nor, &chip->nor, sizeof *chip - offsetof(struct chip, nor));
    munmap(copy, sizeof *copy);
    return file;
}

/* --- Controllers, each in its process ------------------------------------------------------------ */

/* False: it came to a bad end. */
static bool ended_well(pid_t process)
{
    int status;

    return waitpid(process, &status, 0) == process && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

static pid_t start(void)
{
    const pid_t process = fork();

    if (process < 0)
        give_up("fork");
    return process;
}

/* The state that a controller with this chip tells, powered up; NULL: it crashed. The chip stays as it is. */
static const char *state_of(int file)
{
    const pid_t process = start();

    if (process == 0) {
        chip_fit(map(file, MAP_PRIVATE));
        scenario->tell(told->state);
        _exit(0);
    }
    return ended_well(process) ? told->state : NULL;
}

static bool run(int file, bool (*what)(void))
{
    const pid_t process = start();

    if (process == 0) {
        chip_fit(map(file, MAP_SHARED));
        _exit(what() ? 0 : 1);
    }
    return ended_well(process);
}

/* --- Cuts ------------------------------------------------------------------------------------------ */

/* A controller at work, which stops before each step that is to be cut. */
static struct worker {
    int asks[2], goes_on[2];
    uint64_t step, stride, phase;
} worker;

static void before_step(void)
{
    char go;

    if (++worker.step % worker.stride != worker.phase)
        return;
    if (write(worker.asks[1], &worker.step, sizeof worker.step) < 0 || read(worker.goes_on[0], &go, 1) != 1)
        _exit(1);
}

struct cut {
    const char *before, *between, *after; /* the states that are right */
    uint64_t first;                       /* the step of the first cut of a pair, or 0 */
    uint64_t time;                        /* of the first step's */
};

static void count(bool good, const struct cut *cut, uint64_t step, const char *why, const char *what)
{
    if (good)
        passed++;
    else
        failed++;
    if (!good)
        printf("%s: cut before step %llu, then %llu, time %llu, seed %u: %s: %s\n", scenario->name,
               (unsigned long long)(cut->first ? cut->first : step), (unsigned long long)(cut->first ? step : 0),
               (unsigned long long)cut->time, seed, why, what != NULL ? what : "it crashed");
    if ((passed + failed) % REPORT_EVERY == 0)
        printf("passed %u failed %u\n", passed, failed);
    fflush(stdout);
}

static bool explore(int file, uint64_t stride, uint64_t phase, const struct cut *cut);

/* `file`: a chip in a step. */
static void look(int file, uint64_t step, const struct cut *cut)
{
    struct chip *at_work = map(file, MAP_PRIVATE);
    char found[SCENARIO_STATE_MAX];
    const char *state;
    int left;

    chip_cut(at_work, seed + (uint32_t)(step * 31 + cut->first * 1009 + cut->time * 100003));
    left = copy_of(at_work);
    munmap(at_work, sizeof *at_work);
    state = state_of(left);
    if (state == NULL || (strcmp(state, cut->before) != 0 && strcmp(state, cut->between) != 0 &&
                          strcmp(state, cut->after) != 0)) {
        count(false, cut, step, "neither before nor after", state);
    } else {
        bool done;

        strcpy(found, state);
        done = cut->first == 0 && pair_stride > 0
                   ? explore(left, pair_stride, (seed + step * 7919 + cut->time) % pair_stride, &(struct cut){found, between, cut->after, step, cut->time})
                   : run(left, scenario->act);
        state = state_of(left);
        count(done && state != NULL && strcmp(state, cut->after) == 0, cut, step, "not done when tried again", state);
    }
    close(left);
}

/* The cuts of a step that are this part's. */
static void look_at_ours(int file, uint64_t step, const struct cut *cut)
{
    for (uint64_t time = 0; time < times; time++)
        if ((step * times + time) % parts == part)
            look(file, step, &(struct cut){cut->before, cut->between, cut->after, 0, time});
}

/* Do the thing on the chip, to the end, and look at cuts on the way. False: it did not succeed. */
static bool explore(int file, uint64_t stride, uint64_t phase, const struct cut *cut)
{
    struct worker outer = worker;
    uint64_t step;
    pid_t process;

    worker = (struct worker){.stride = stride, .phase = phase};
    if (pipe(worker.asks) != 0 || pipe(worker.goes_on) != 0)
        give_up("pipe");
    process = start();
    if (process == 0) {
        close(worker.asks[0]);
        close(worker.goes_on[1]);
        chip_fit(map(file, MAP_SHARED));
        chip_on_step(before_step);
        _exit(scenario->act() ? 0 : 1);
    }
    close(worker.asks[1]);
    close(worker.goes_on[0]);
    while (read(worker.asks[0], &step, sizeof step) == sizeof step) {
        if (cut->first != 0)
            look(file, step, cut);
        else
            look_at_ours(file, step, cut);
        if (write(worker.goes_on[1], "", 1) != 1)
            give_up("write");
    }
    close(worker.asks[0]);
    close(worker.goes_on[1]);
    worker = outer;
    return ended_well(process);
}

static const struct scenario *const lists[] = {scenario_settings, scenario_update};

static const struct scenario *find(const char *name)
{
    for (size_t n = 0; n < sizeof lists / sizeof *lists; n++)
        for (const struct scenario *at = lists[n]; at->name != NULL; at++)
            if (strcmp(at->name, name) == 0)
                return at;
    return NULL;
}

/* Their names, one a line. */
static int list(void)
{
    for (size_t n = 0; n < sizeof lists / sizeof *lists; n++)
        for (const struct scenario *at = lists[n]; at->name != NULL; at++)
            puts(at->name);
    return 0;
}

static unsigned erases_of(const struct chip *chip)
{
    unsigned sum = 0;

    for (unsigned sector = 0; sector < NOR_SECTORS; sector++)
        sum += chip->erases[sector];
    return sum;
}

/* Run it, and note the state that is then told. */
static void note(int file, bool (*what)(void), char *to)
{
    const char *state = NULL;

    if (run(file, what))
        state = state_of(file);
    if (state == NULL) {
        fprintf(stderr, "it does not succeed without a cut\n");
        exit(2);
    }
    strcpy(to, state);
}

/* A chip as it is before, and the states without a cut; its steps. */
static uint64_t prepare(int file)
{
    struct chip *const chip = map(file, MAP_SHARED);
    const struct chip *done;
    int whole;
    uint64_t steps;

    chip_deliver(chip, SCENARIO_FIRST, SCENARIO_END - SCENARIO_FIRST);
    note(file, scenario->prepare, before);
    whole = copy_of(chip);
    done = map(whole, MAP_SHARED);
    note(whole, scenario->act, after);
    steps = done->steps - chip->steps;
    if (strstr(before, scenario->before) == NULL || strstr(after, scenario->after) == NULL || strcmp(before, after) == 0 ||
        erases_of(done) - erases_of(chip) < scenario->erases) {
        fprintf(stderr, "not what its name says: %u erases, %s, then %s\n", erases_of(done) - erases_of(chip), before,
                after);
        exit(2);
    }
    strcpy(between, after);
    if (scenario->first != NULL)
        note(whole, scenario->first, between);
    return steps;
}

int main(int argument_count, char **arguments)
{
    uint64_t pairs, steps;

    if (argument_count == 1)
        return list();
    if (argument_count != 6 || (scenario = find(arguments[1])) == NULL) {
        fprintf(stderr, "usage: powercut SCENARIO PART PARTS PAIRS SEED\n");
        return 2;
    }
    part = strtoull(arguments[2], NULL, 10);
    parts = strtoull(arguments[3], NULL, 10);
    pairs = strtoull(arguments[4], NULL, 10);
    seed = (uint32_t)strtoul(arguments[5], NULL, 10);
    told = mmap(NULL, sizeof *told, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (told == MAP_FAILED)
        give_up("mmap");
    const int file = new_file();
    steps = prepare(file);
    times = LEAST_CUTS / steps + 1;
    pair_stride = pairs > 0 ? steps / pairs + 1 : 0;
    if (!explore(file, 1, 0, &(struct cut){before, before, after, 0, 0}))
        give_up("without a cut");
    printf("passed %u failed %u\n", passed, failed);
    return failed > 0;
}
