/* SPDX-License-Identifier: BSD-2-Clause */
/* Ring, events, fault log, actions and settings, through the sample module that uses them all. */
#include "core/events.h"
#include "core/fault.h"
#include "core/ring.h"
#include "core/settings.h"

#include "check.h"
#include "port.h"
#include "sample.h"

static void start(void)
{
    port_start(sample_modules);
}

TEST(ring_keeps_order_and_refuses_when_full)
{
    static uint8_t bytes[4];
    struct ring ring = {.bytes = bytes, .mask = 3};
    uint8_t next_in = 0, next_out = 0, byte;

    ring.head = ring.tail = UINT32_MAX - 5; /* wraps on the way */
    for (int round = 0; round < 100; round++) {
        for (int i = 0; i < round % 4 + 1; i++)
            next_in = (uint8_t)(next_in + ring_put(&ring, next_in));
        CHECK(ring_used(&ring) + ring_free(&ring) == 4);
        for (int i = 0; i < round % 3 + 1; i++)
            if (ring_take(&ring, &byte)) {
                CHECK_INT(byte, next_out);
                next_out++;
            }
    }
    while (ring_put(&ring, next_in))
        next_in++;
    CHECK_INT(ring_used(&ring), 4);
    while (ring_take(&ring, &byte))
        CHECK_INT(byte, next_out++);
    CHECK_INT(next_in, next_out);
    CHECK(!ring_take(&ring, &byte));
    ring_put(&ring, 1);
    ring_clear(&ring);
    CHECK_INT(ring_used(&ring), 0);
}

TEST(interrupt_hooks_run_at_once_with_name_argument_and_time)
{
    start();
    events_publish_from_interrupt(EVENT_SERVO_TURN, 7, UINT64_C(0x123456789A));
    CHECK_INT(sample_ticks, 1);
    CHECK_INT(sample_last_argument, 7);
    CHECK(sample_last_time == UINT64_C(0x123456789A));
}

TEST(main_hooks_run_later_in_order)
{
    start();
    log_error(85);
    log_error(86);
    CHECK_INT(sample_faults, 0);
    events_poll();
    CHECK_INT(sample_faults, 2);
    CHECK_INT(sample_last_argument, 86);
}

TEST(an_event_without_subscribers_goes_nowhere)
{
    start();
    for (int i = 0; i < 1000; i++)
        events_publish(EVENT_MOVE_DONE, 0, 0);
    events_poll();
    CHECK_INT(fault_read(0), FAULT_NONE);
}

TEST(a_full_event_queue_is_logged)
{
    start();
    for (int i = 0; i < EVENT_QUEUE + 1; i++)
        events_publish(EVENT_FAULT, 1, 0);
    events_poll();
    CHECK_INT(sample_faults, EVENT_QUEUE);
    CHECK_INT(fault_read(0), FAULT_TASK_OVERTIME);
}

static uint64_t noon(void)
{
    return 12;
}

TEST(core_stamps_its_events_with_the_clock_it_was_given)
{
    start();
    CHECK(events_now() == 0);
    events_set_clock(noon);
    CHECK(events_now() == 12);
    events_set_clock(NULL);
}

static void nothing(const struct event *event)
{
    (void)event;
}

TEST(too_many_hooks_of_one_event_are_refused)
{
    static struct subscription many[EVENT_HOOKS_MAX + 1];
    static const struct module first = {.subscriptions = many};
    static const struct module second = {.subscriptions = many + EVENT_HOOKS_MAX - 1};
    const struct module *one[] = {&first, NULL}, *two[] = {&first, &second, NULL};

    for (unsigned n = 0; n < EVENT_HOOKS_MAX; n++)
        many[n] = (struct subscription){EVENT_RESET, EVENT_IN_MAIN, nothing};
    CHECK(events_init(one));
    CHECK(!events_init(two));
}

TEST(fault_log_shows_the_newest_first_and_keeps_sixty_four)
{
    start();
    for (uint16_t code = 1; code <= 70; code++)
        log_error(code);
    CHECK_INT(fault_read(0), 70);
    CHECK_INT(fault_read(63), 7);
    CHECK_INT(fault_read(64), FAULT_NONE);
    fault_clear();
    CHECK_INT(fault_read(0), FAULT_NONE);
}

TEST(faults_from_interrupts_reach_the_log_in_order)
{
    start();
    log_error_from_interrupt(FAULT_RUNAWAY + 2);
    log_error_from_interrupt(FAULT_AXIS_DEAD + 1);
    CHECK_INT(fault_read(0), FAULT_NONE);
    fault_poll();
    CHECK_INT(fault_read(0), 21);
    CHECK_INT(fault_read(1), 32);
}

static int asked;

static bool refuse(void)
{
    asked++;
    return false;
}

TEST(the_first_claim_that_takes_an_action_gets_it)
{
    static const struct claim claims[] = {
        {ACTION_AT_SHORT, refuse}, {ACTION_AT_SHORT, sample_take_button},
        {ACTION_AT_SHORT, refuse}, {0},
    };

    start();
    action_init(claims);
    port_send("LAMP S");
    asked = 0;
    CHECK(action_perform(ACTION_AT_SHORT));
    CHECK_INT(asked, 1);
    CHECK(!action_perform(ACTION_AT_SHORT)); /* no longer lit: all refuse */
    CHECK_INT(asked, 3);
    CHECK(!action_perform(ACTION_LOCK));
    action_init(NULL);
}

TEST(start_gives_every_parameter_its_initial_value)
{
    start();
    CHECK_TEXT(port_send("L X=77"), ":A \r\n");
    start();
    CHECK_TEXT(port_send("L X?"), ":A X=5.000000\r\n");
}

TEST(settings_survive_when_saved_and_only_then)
{
    start();
    port_send("G X=11");
    CHECK(settings_save());
    port_send("G X=12 Y=13");
    port_send("OFFSET X=99");
    start();
    CHECK_TEXT(port_send("G X? Y?"), ":X=11 Y=50 A\r\n");
    CHECK_TEXT(port_send("OFFSET X?"), ":A 0.0 \r\n"); /* of class never */
    CHECK_INT(sample_sets, 0);
}

TEST(restores_saved_settings_without_a_restart)
{
    start();
    port_send("G X=21");
    CHECK(settings_save());
    port_send("G X=22");
    CHECK(settings_restore());
    CHECK_TEXT(port_send("G X?"), ":X=21 A\r\n");
}

TEST(factory_values_come_at_the_next_start_until_restored)
{
    start();
    port_send("G X=31");
    CHECK(settings_save());
    CHECK(settings_factory_next());
    CHECK_TEXT(port_send("G X?"), ":X=31 A\r\n");
    start();
    CHECK_TEXT(port_send("G X?"), ":X=50 A\r\n");
    CHECK(settings_restore());
    CHECK_TEXT(port_send("G X?"), ":X=31 A\r\n");
    start();
    CHECK_TEXT(port_send("G X?"), ":X=31 A\r\n");
}

TEST(keeps_parameters_of_class_at_once_without_being_asked)
{
    start();
    port_send("TINT R=2.5 Z=7");
    start();
    CHECK_TEXT(port_send("TINT R? Z?"), "Z=24 R=2.500 :A\r\n");
}

static double memory;

static bool read_wrong(uint32_t key, double *value)
{
    *value = memory;
    return key != 0;
}

static bool write_full(uint32_t key, double value)
{
    (void)key;
    (void)value;
    return false;
}

static bool commit_not(void)
{
    return false;
}

TEST(ignores_saved_values_that_are_out_of_range_and_reports_a_full_store)
{
    static const struct settings_store broken = {
        .read = read_wrong, .write = write_full, .commit = commit_not};

    settings_init(&broken);
    memory = 1e12;
    start();
    CHECK_TEXT(port_send("G X?"), ":X=50 A\r\n");
    CHECK_INT(fault_read(0), FAULT_NOT_LOADED);
    memory = 60;
    fault_clear();
    start();
    CHECK_TEXT(port_send("G X?"), ":X=60 A\r\n");
    CHECK(!settings_save());
    settings_init(&settings_ram);
}

static unsigned commits;
static bool commits_fail;

static bool commit_counted(void)
{
    commits++;
    settings_poll(); /* as the main loop does, which goes on meanwhile */
    return !commits_fail;
}

TEST(a_store_is_written_once_for_a_line_and_not_for_what_it_has)
{
    struct settings_store counted = settings_ram;

    counted.commit = commit_counted;
    settings_init(&counted);
    start();
    settings_poll();
    commits = 0;
    port_send("TINT R=3.5 Z=9");
    CHECK_INT(commits, 1);
    port_send("TINT R=3.5 Z=9");
    CHECK_INT(commits, 1);
    commits_fail = true;
    port_send("TINT R=4.5");
    CHECK_INT(commits, 2);
    CHECK(!settings_kept() && !settings_pending());
    commits_fail = false;
    port_send("TINT R=4.5");
    CHECK_INT(commits, 3);
    CHECK(settings_kept());
    CHECK(settings_write(12345, 1));
    CHECK(settings_pending() && !settings_kept());
    settings_poll();
    CHECK(!settings_pending() && settings_kept());
    settings_init(&settings_ram);
}

TEST(keys_of_settings_differ)
{
    const struct parameter *a, *b;

    for (a = sample_module.parameters; a->command != NULL; a++)
        for (unsigned i = 0; i < parameter_values(a); i++)
            for (b = sample_module.parameters; b->command != NULL; b++)
                for (unsigned j = 0; j < parameter_values(b); j++)
                    CHECK((a == b && i == j) || settings_key(a, i) != settings_key(b, j));
}

TEST_MAIN(RUN(ring_keeps_order_and_refuses_when_full);
          RUN(interrupt_hooks_run_at_once_with_name_argument_and_time);
          RUN(main_hooks_run_later_in_order); RUN(an_event_without_subscribers_goes_nowhere);
          RUN(a_full_event_queue_is_logged);
          RUN(core_stamps_its_events_with_the_clock_it_was_given);
          RUN(too_many_hooks_of_one_event_are_refused);
          RUN(fault_log_shows_the_newest_first_and_keeps_sixty_four);
          RUN(faults_from_interrupts_reach_the_log_in_order);
          RUN(the_first_claim_that_takes_an_action_gets_it);
          RUN(start_gives_every_parameter_its_initial_value);
          RUN(settings_survive_when_saved_and_only_then);
          RUN(restores_saved_settings_without_a_restart);
          RUN(factory_values_come_at_the_next_start_until_restored);
          RUN(keeps_parameters_of_class_at_once_without_being_asked);
          RUN(ignores_saved_values_that_are_out_of_range_and_reports_a_full_store);
          RUN(a_store_is_written_once_for_a_line_and_not_for_what_it_has);
          RUN(keys_of_settings_differ))
