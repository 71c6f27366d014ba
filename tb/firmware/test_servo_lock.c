/* SPDX-License-Identifier: BSD-2-Clause */
/* SERVOLOCK_TTL: decisions move the target, in order and within the fence; what else changes meanwhile. */
#include "check.h"

#include <math.h>
#include <stdlib.h>

#include "hal/classifier.h"
#include "host/mmio.h"
#include "machine.h"
#include "modules/axis.h"
#include "modules/motion.h"
#include "port.h"
#include "random.h"
#include "regs.h"

#define SEND(text, reply) CHECK_TEXT(machine_send(text), reply)
#define DONE ":A \r\n"
#define TICKS_PER_MS 5u
#define COUNTS_PER_UM 45.396

/* --- The registers of the classifier, from their contract -------------------------------------- */

enum { QUEUE = 4096 };
static uint16_t queue[QUEUE];
static unsigned queue_in, queue_out;

static uint32_t read_classifier(void *context, uintptr_t address)
{
    (void)context;
    if (address == REG_CLASSIFIER_DECISIONS)
        return queue_out != queue_in ? queue[queue_out++ % QUEUE] : 1;
    if (address == REG_CLASSIFIER_STATUS)
        return queue_in - queue_out;
    return mmio_model_get(address);
}

static void write_classifier(void *context, uintptr_t address, uint32_t value)
{
    (void)context;
    if (address == REG_CLASSIFIER_CONTROL && (value & REG_CLASSIFIER_CONTROL_CLEAR_MASK) != 0)
        queue_out = queue_in;
    else
        mmio_model_set(address, value);
}

static bool judging(void)
{
    return (mmio_model_get(REG_CLASSIFIER_CONFIG) & REG_CLASSIFIER_CONFIG_ENABLE_MASK) != 0;
}

/* Pulses: 's' a short one, 'l' a long one; each a batch of its own. */
static void pulses(const char *kinds)
{
    for (; *kinds != '\0' && judging(); kinds++)
        queue[queue_in++ % QUEUE] = *kinds == 'l' ? 3 : 2;
}

static void start(void)
{
    machine_start();
    queue_in = queue_out = 0;
    mmio_model_hook((struct mmio_hook){.first = REG_CLASSIFIER_THRESHOLD,
                                       .last = REG_CLASSIFIER_CONTROL,
                                       .read = read_classifier, .write = write_classifier});
    machine_run(200);
}

/* Set-point of an axis, counts with their fraction. */
static double target(unsigned axis)
{
    struct axis_view view;

    axis_read(axis, &view);
    return (double)view.setpoint.position_q32 / 0x1p32;
}

#define CHECK_COUNTS(actual, expected)                                                             \
    do {                                                                                           \
        double check_a = (actual), check_e = (expected);                                           \
        if (!(fabs(check_a - check_e) < 1e-3))                                                     \
            CHECK_FAIL("%s is %.4f, not %.4f", #actual, check_a, check_e);                         \
    } while (0)

/* --- Language ----------------------------------------------------------------------------------- */

TEST(locks_and_unlocks_by_code_and_by_toggling)
{
    start();
    SEND("LK X?", ":A I\r\n");
    SEND("LK", DONE);
    SEND("LK X?", ":A T\r\n");
    SEND("RS X+ Z+", ":A K \r\n");
    SEND("/", "N\r\n");
    SEND("LK", DONE);
    SEND("LK X?", ":A I\r\n");
    SEND("LK F=84", DONE);
    SEND("LK F=84", DONE);
    SEND("LK X?", ":A T\r\n");
    SEND("LOCK F=90", DONE);
    SEND("LOCK F=90", DONE);
    SEND("LK X?", ":A I\r\n");
    SEND("LK F=1", ":N-4\r\n");
    SEND("LK F?", ":N-4\r\n");
    SEND("LK X=1", ":N-4\r\n");
    SEND("LK X? F=84", ":N-4\r\n");
    SEND("LK Y=1", ":N-2\r\n");
    CHECK(strstr(machine_send("BU X"), "\rSERVOLOCK_TTL") != NULL);
}

TEST(has_the_input_for_itself)
{
    start();
    SEND("TTL X=11", ":N-4\r\n");
    SEND("TTL X=2", DONE);
    SEND("LK F=84", DONE);
    SEND("TTL X?", ":A X=11\r\n");
    SEND("TTL X=1", ":N-5\r\n");
    SEND("TTL X=2", ":N-5\r\n");
    SEND("TTL Y=0", DONE); /* OUT0 is free */
    SEND("SS Z", DONE);    /* keeps what the user had set */
    SEND("LK F=90", DONE);
    SEND("TTL X?", ":A X=2\r\n");
    SEND("TTL X=0", DONE);
    SEND("SS Z", DONE);
}

TEST(refuses_moves_and_takes_steps)
{
    static const struct motion_owner hand = {.name = "hand"};

    start();
    SEND("R X=10", DONE);
    CHECK(machine_wait());
    SEND("LK F=84", DONE);
    const double before = target(0);
    SEND("M X=100", ":N-5\r\n");
    SEND("M X=100 Z=100", ":N-5\r\n");
    SEND("! X", ":N-5\r\n");
    CHECK(!motion_claim(MOTION_AXIS(1), &hand)); /* nor joystick, ring buffer ... */
    SEND("R X=20 Y=-3", DONE);
    machine_run(50);
    CHECK_COUNTS(target(0), before);
    pulses("s");
    machine_run(1);
    CHECK_COUNTS(target(0), before + 2 * COUNTS_PER_UM);
    CHECK_COUNTS(target(1), -0.3 * COUNTS_PER_UM);
    SEND("M Z=100", DONE); /* an axis that does not respond */
    CHECK(machine_wait());
    SEND("LK R=5", DONE); /* both */
    SEND("LK R?", ":A R=5\r\n");
    pulses("l");
    machine_run(1);
    CHECK_COUNTS(target(0), before + 1.5 * COUNTS_PER_UM);
    CHECK_COUNTS(target(1), -0.8 * COUNTS_PER_UM);
    machine_run(100 * TICKS_PER_MS);
    CHECK(fabs(atof(machine_send("W X") + 3) - 25) < 1); /* readable */
    SEND("LK F=90", DONE);
    SEND("R X=10", DONE);
    CHECK(machine_wait());
    CHECK(target(0) > before + 2.4 * COUNTS_PER_UM);
}

TEST(threshold_is_kept_to_a_clock)
{
    start();
    SEND("RT R?", ":A R=0.75\r\n");
    SEND("LK F=84", DONE);
    CHECK_INT(mmio_model_get(REG_CLASSIFIER_THRESHOLD), 150000);
    CHECK_INT(mmio_model_get(REG_CLASSIFIER_CONFIG), 19 << 2 | 1);
    SEND("RT R=0.5", DONE);
    CHECK_INT(mmio_model_get(REG_CLASSIFIER_THRESHOLD), 100000);
    SEND("RT R=0.333335", DONE);
    SEND("RT R?", ":A R=0.333335\r\n");
    CHECK_INT(mmio_model_get(REG_CLASSIFIER_THRESHOLD), 66667);
    SEND("RT R=0.000005", DONE);
    CHECK_INT(mmio_model_get(REG_CLASSIFIER_THRESHOLD), 1);
    SEND("RT R=0", ":N-4\r\n");
    SEND("LK S=1 G=50", DONE);
    SEND("LK S? G?", ":A G=50 S=1\r\n");
    CHECK_INT(mmio_model_get(REG_CLASSIFIER_CONFIG), 10 << 2 | 3);
    SEND("LK G=156", ":N-4\r\n");
    SEND("LR Z=0.5", DONE);
    SEND("SS Z", DONE);
    SEND("LK F=90", DONE);
    CHECK_INT(mmio_model_get(REG_CLASSIFIER_CONFIG) & REG_CLASSIFIER_CONFIG_ENABLE_MASK, 0);
    SEND("RT R=0.75", DONE);
    SEND("LK S=0 G=95", DONE);
    SEND("LR Z=1", DONE);
    SEND("SS Y", DONE);
    SEND("RT R?", ":A R=0.000005\r\n");
    SEND("LK S? G?", ":A G=50 S=1\r\n");
    SEND("LR Z?", ":A Z=0.5\r\n");
    SEND("RT R=0.75", DONE);
    SEND("LK S=0 G=95", DONE);
    SEND("LR Z=1", DONE);
    SEND("SS Z", DONE);
}

/* --- Steps -------------------------------------------------------------------------------------- */

TEST(the_worked_example)
{
    start();
    SEND("R X=1 Y=0", DONE);
    SEND("RT R=0.75", DONE);
    SEND("LR Z=0.5", DONE);
    SEND("LK F=84", DONE);
    CHECK(machine_wait());
    const double before = target(0);
    for (int n = 0; n < 100; n++) {
        pulses("s");
        machine_run(TICKS_PER_MS);
    }
    CHECK_COUNTS(target(0), before + 10 * COUNTS_PER_UM);
    machine_run(100 * TICKS_PER_MS);
    CHECK(abs(motion_position_counts(0) - (int)target(0)) <= 3);
    SEND("LK N? C? L?", ":A C=0 L=0 N=100\r\n");
    SEND("LK F=90", DONE);
    SEND("LR Z=1", DONE);
}

TEST(decisions_count_in_their_order_at_the_fence)
{
    start();
    SEND("R X=10 Y=0", DONE);
    CHECK(machine_wait());
    SEND("LR Z=0.0025", DONE);
    SEND("LK F=84", DONE);
    const double origin = target(0);
    pulses("sss"); /* 1, 2, and 2.5 um: the last is cut short */
    machine_run(1);
    CHECK_COUNTS(target(0), origin + 2.5 * COUNTS_PER_UM);
    pulses("sl"); /* not the same as none */
    machine_run(1);
    CHECK_COUNTS(target(0), origin + 1.5 * COUNTS_PER_UM);
    pulses("lllll");
    machine_run(1);
    CHECK_COUNTS(target(0), origin - 2.5 * COUNTS_PER_UM);
    SEND("LK C? N?", ":A C=3 N=10\r\n");
    SEND("LR Z=1", DONE);
}

TEST(pulses_during_a_move_act_when_it_is_over)
{
    start();
    SEND("M X=1000 Y=1000", DONE);
    SEND("R X=10 Y=10", DONE);
    SEND("LK F=84", DONE);
    pulses("sss");
    machine_run(10);
    SEND("/", "B\r\n");
    CHECK(target(0) > 0 && target(0) < 50 * COUNTS_PER_UM); /* on its way, undisturbed */
    CHECK(machine_wait());
    CHECK(fabs(target(0) / COUNTS_PER_UM - 104) < 0.05);
    CHECK(fabs(target(1) / COUNTS_PER_UM - 104) < 0.05);
}

TEST(soft_limits_are_a_fence_too)
{
    start();
    SEND("SU X=0.002", DONE);
    SEND("R X=10", DONE);
    CHECK(machine_wait());
    SEND("LK F=84", DONE);
    pulses("sss");
    machine_run(1);
    CHECK(fabs(target(0) - 2 * COUNTS_PER_UM) < 1);
    SEND("LK C?", ":A C=2\r\n");
    SEND("LK F=90", DONE);
    SEND("SU X=1000", DONE);
}

TEST(whatever_stops_an_axis_ends_it)
{
    start();
    SEND("LK F=84", DONE);
    SEND("\\", DONE);
    SEND("LK X?", ":A I\r\n");
    CHECK(!judging());
    SEND("LK F=84", DONE);
    SEND("MC Y-", DONE);
    SEND("LK X?", ":A I\r\n");
    SEND("LK F=84", ":N-5\r\n");
    SEND("RM Y=1", DONE);
    SEND("LK F=84", DONE);
    SEND("LK F=90", DONE);
    SEND("RM Y=0", DONE);
    SEND("LK F=84", ":N-5\r\n");
    SEND("RM Y=3", DONE);
    SEND("MC Y+", DONE);
    machine_run(200);
    SEND("BU F=2", DONE); /* no mode 11 */
    SEND("LK F=84", ":N-5\r\n");
    SEND("BU F=0", DONE);
    SEND("M X=0", DONE);
}

TEST(pulses_before_the_end_count_and_those_after_do_not)
{
    start();
    SEND("R X=10", DONE);
    CHECK(machine_wait());
    SEND("LK F=84", DONE);
    const double before = target(0);
    for (int n = 0; n < 10; n++)
        pulses("ssssssssss"); /* more than a tick takes */
    SEND("LK F=90", DONE);
    machine_run(10);
    CHECK_COUNTS(target(0), before + 100 * COUNTS_PER_UM);
    pulses("s");
    machine_run(10);
    SEND("LK X?", ":A I\r\n");
    CHECK_COUNTS(target(0), before + 100 * COUNTS_PER_UM);
    SEND("LK F=84", DONE);
    machine_run(10);
    SEND("LK N?", ":A N=0\r\n");
}

/* The model: whole hundred-thousandths of a count, one decision after the other. */
enum { PARTS = 100000, FENCE_PARTS = 13618800 }; /* 3 um */
struct model {
    int64_t at, step, low, high;
};

static struct model model_of(unsigned axis, int64_t step)
{
    const int64_t origin = llround(target(axis)) * PARTS;

    return (struct model){origin, step, origin - FENCE_PARTS, origin + FENCE_PARTS};
}

static bool walk(struct model *model, bool longer)
{
    model->at += longer ? -model->step : model->step;
    const bool cut = model->at > model->high || model->at < model->low;
    if (model->at > model->high)
        model->at = model->high;
    if (model->at < model->low)
        model->at = model->low;
    return cut;
}

TEST(a_million_random_pulses_end_where_the_model_does)
{
    enum { PULSES = 1000000 };
    unsigned sent = 0, clipped = 0, most = 0;

    start();
    SEND("LR Z=0.003", DONE);
    SEND("R X=1.7 Y=-7.3", DONE);
    CHECK(machine_wait());
    SEND("LK F=84", DONE);
    struct model x = model_of(0, 771732), y = model_of(1, -3313908); /* 0.17 and -0.73 um */
    while (sent < PULSES) {
        /* 100 kHz: 20 in the 200 us of a turn, in batches as they come; a host that never rests. */
        for (unsigned n = 0; n < 20 && sent < PULSES;) {
            uint32_t batch = 1;
            for (unsigned count = random_below(4) == 0 ? 1 + random_below(8) : 1; count > 0; count--) {
                /* Runs of a kind, so that both ends of the fence are met. */
                const bool longer = random_below(8) < (sent / 500 % 2 != 0 ? 2u : 6u);
                const bool x_cut = walk(&x, longer), y_cut = walk(&y, longer);
                batch = batch << 1 | longer;
                clipped += x_cut || y_cut;
                sent++;
                n++;
            }
            queue[queue_in++ % QUEUE] = (uint16_t)batch;
        }
        if (queue_in - queue_out > most)
            most = queue_in - queue_out;
        if (random_below(3) == 0)
            CHECK(strncmp(machine_send("W X Y Z F"), ":A ", 3) == 0);
        else
            machine_run(1);
    }
    machine_run(10);
    printf("# at most %u batches waited; %u clipped\n", most, clipped);
    CHECK_COUNTS(target(0), (double)x.at / PARTS);
    CHECK_COUNTS(target(1), (double)y.at / PARTS);
    CHECK(clipped > PULSES / 20 && clipped < PULSES - PULSES / 20);
    char reply[64];
    snprintf(reply, sizeof reply, ":A C=%u N=%d\r\n", clipped, PULSES);
    SEND("LK N? C?", reply);
    SEND("LR Z=1", DONE);
}

TEST_MAIN(RUN(locks_and_unlocks_by_code_and_by_toggling); RUN(has_the_input_for_itself);
          RUN(refuses_moves_and_takes_steps); RUN(threshold_is_kept_to_a_clock);
          RUN(the_worked_example); RUN(decisions_count_in_their_order_at_the_fence);
          RUN(pulses_during_a_move_act_when_it_is_over); RUN(soft_limits_are_a_fence_too);
          RUN(whatever_stops_an_axis_ends_it);
          RUN(pulses_before_the_end_count_and_those_after_do_not);
          RUN(a_million_random_pulses_end_where_the_model_does))
