/* SPDX-License-Identifier: BSD-2-Clause */
/* A save takes the flash up to a second. Whatever comes meanwhile does not wait for it, and one save does not begin another. */
#include "check.h"

#include <stdlib.h>

#include "../powercut/chip.h"
#include "core/settings.h"
#include "machine.h"
#include "modules/motion.h"
#include "port.h"
#include "store/settings_flash.h"

enum { TICKS = 100 }; /* in each wait: 20 ms */

static struct chip *chip;
static const char *in_wait[8]; /* sent in the first waits, one each */
static unsigned waits;
static char heard[400];
static size_t heard_in_waits;
static bool moved_on; /* an axis moved after the second wait */

static void main_loop(void)
{
    const char *text = waits < sizeof in_wait / sizeof *in_wait ? in_wait[waits] : NULL;

    if (text != NULL)
        port_queue(text);
    for (unsigned n = 0; n < TICKS / 10; n++) {
        machine_run(10);
        strncat(heard, port_take(200), sizeof heard - strlen(heard) - 1);
    }
    heard_in_waits = strlen(heard);
    if (waits >= 2)
        moved_on |= motion_busy();
    waits++;
}

static void power_up(void)
{
    flash_on_wait(NULL);
    chip_fit(chip);
    settings_init(settings_flash());
    machine_start();
    machine_run(200);
}

static void start(void)
{
    free(chip);
    chip = calloc(1, sizeof *chip);
    chip_deliver(chip, 0, NOR_BYTES);
    power_up();
    memset(in_wait, 0, sizeof in_wait);
    heard[0] = '\0';
    waits = 0;
    moved_on = false;
}

/* Everything that is said from here on, the waits included. */
static const char *say(const char *text)
{
    flash_on_wait(main_loop);
    port_hold();
    port_queue(text);
    for (unsigned n = 0; n < 100; n++) {
        const char *said;

        machine_run(1);
        said = port_take(200);
        strncat(heard, said, sizeof heard - strlen(heard) - 1);
    }
    flash_on_wait(NULL);
    return heard;
}

TEST(halt_acts_while_a_save_waits)
{
    start();
    CHECK_TEXT(machine_send("M X=500000"), ":A \r\n");
    machine_run(500);
    CHECK(motion_busy());
    in_wait[0] = "\\";
    CHECK_TEXT(say("SS Z\r"), ":A \r\n:N-21\r\n");
    CHECK(waits > 10 && !moved_on);
    CHECK(settings_kept());
}

TEST(a_query_is_answered_while_a_value_is_kept)
{
    start();
    in_wait[1] = "S X?\r";
    in_wait[2] = "BU Z=7\rBU Z?\r";
    CHECK_TEXT(say("SL X=-20\r"), ":A \r\n:A X=4.556000\r\n:A \r\n:A 7\r\n");
    CHECK_INT(heard_in_waits, strlen(heard));
    CHECK(waits > 10);
}

TEST(a_save_that_is_asked_for_meanwhile_comes_after_and_is_answered_then)
{
    start();
    in_wait[3] = "S X=2.5\rSS Z\r";
    CHECK_TEXT(say("SL X=-20\r"), ":A \r\n:A \r\n:A \r\n");
    CHECK(settings_kept());
    power_up();
    CHECK_TEXT(machine_send("S X?"), ":A X=2.500000\r\n");
    CHECK_TEXT(machine_send("SL X?"), ":A X=-20.000\r\n");
}

TEST(a_save_that_fails_says_so_once_and_the_next_succeeds)
{
    start();
    CHECK_TEXT(machine_send("S X=2.5"), ":A \r\n");
    chip_wear_out(3);
    CHECK_TEXT(say("SS Z\r"), ":N-5\r\n");
    chip_wear_out(-1);
    heard[0] = '\0';
    CHECK_TEXT(say("SS Z\r"), ":A \r\n");
    power_up();
    CHECK_TEXT(machine_send("S X?"), ":A X=2.500000\r\n");
}

/* Before anything can move, or it would be believed a second time at another place. */
TEST(positions_are_forgotten_by_the_start_that_uses_them)
{
    start();
    CHECK_TEXT(machine_send("H X=5000"), ":A \r\n");
    CHECK_TEXT(say("SP\r"), ":A \r\n");
    flash_on_wait(NULL);
    settings_init(settings_flash());
    machine_start();
    CHECK_TEXT(machine_send("W X"), ":A 5000.0 \r\n");
    power_up();
    CHECK_TEXT(machine_send("W X"), ":A 0.0 \r\n");
}

TEST(positions_that_cannot_be_forgotten_are_not_used)
{
    start();
    CHECK_TEXT(machine_send("H X=5000"), ":A \r\n");
    CHECK_TEXT(say("SP\r"), ":A \r\n");
    flash_on_wait(NULL);
    chip_wear_out(0);
    settings_init(settings_flash());
    machine_start();
    CHECK_TEXT(machine_send("W X"), ":A 0.0 \r\n");
}

TEST_MAIN(RUN(halt_acts_while_a_save_waits); RUN(a_query_is_answered_while_a_value_is_kept);
          RUN(a_save_that_is_asked_for_meanwhile_comes_after_and_is_answered_then);
          RUN(a_save_that_fails_says_so_once_and_the_next_succeeds);
          RUN(positions_are_forgotten_by_the_start_that_uses_them);
          RUN(positions_that_cannot_be_forgotten_are_not_used))
