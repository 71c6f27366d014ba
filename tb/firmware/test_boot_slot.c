/* SPDX-License-Identifier: BSD-2-Clause */
/* boot/slot, boot/counter, boot/start: which image is started, also when the power goes. Expected: the rules of docs/boot.md. */
#include "boot/slot.h"

#include "boot/counter.h"
#include "boot/start.h"
#include "boot_images.h"
#include "check.h"
#include "nor_flash.h"
#include "random.h"

static struct image image;

static int start(void)
{
    return start_load(boot_memory, &image);
}

/* Slot 0 confirmed with 1.0.0, slot 1 holding 1.0.1, not selected. */
static void two_images(void)
{
    nor_flash_reset();
    boot_image_put("good", 0);
    boot_image_put("newer", 1);
    slot_select(0, true);
}

TEST(starts_nothing_from_an_empty_flash)
{
    nor_flash_reset();
    CHECK_INT(start(), SLOT_NONE);
    boot_image_put("good", 0);
    CHECK_INT(start(), SLOT_NONE); /* not selected */
}

TEST(tests_once_and_reverts)
{
    two_images();
    CHECK_INT(start(), 0);
    CHECK(slot_select(1, false));
    CHECK_INT(slot_read(1).state, SLOT_PENDING);
    CHECK_INT(start(), 1);
    CHECK_INT(image.version.revision, 1);
    CHECK_INT(slot_read(1).state, SLOT_TRIED);
    CHECK_INT(start(), 0);
    CHECK_INT(start(), 0);
    CHECK(slot_select(1, false)); /* and again */
    CHECK_INT(start(), 1);
}

TEST(stays_with_what_was_confirmed)
{
    two_images();
    CHECK(slot_select(1, false));
    CHECK_INT(start(), 1);
    CHECK(slot_confirm(1));
    for (int n = 0; n < 3; n++)
        CHECK_INT(start(), 1);
    CHECK(slot_select(0, true)); /* back, but the counter has 1.0.1 */
    CHECK_INT(start(), 1);
}

TEST(starts_the_other_when_one_is_spoilt)
{
    two_images();
    CHECK(slot_select(1, false));
    nor_flash[slot_address(1) + 5000] ^= 1;
    CHECK_INT(start(), 0);
    nor_flash[slot_address(0) + 5000] ^= 1;
    CHECK_INT(start(), SLOT_NONE);
}

TEST(of_two_confirmed_the_last_selected_counts_not_the_version)
{
    nor_flash_reset();
    boot_image_put("good", 0);
    boot_image_put("rebuilt", 1); /* the same version, built again */
    slot_select(1, true);
    slot_select(0, true);
    CHECK_INT(start(), 0);
    slot_select(1, true);
    CHECK_INT(start(), 1);
}

TEST(takes_trailers_that_imgtool_makes)
{
    static const uint8_t magic[] = {0x77, 0xc2, 0x95, 0xf3, 0x60, 0xd2, 0xef, 0x7f,
                                    0x35, 0x52, 0x50, 0x0f, 0x2c, 0xb6, 0x79, 0x80};
    uint8_t *end = nor_flash + slot_address(0) + FLASH_MAP_SLOT_SIZE;

    nor_flash_reset();
    boot_image_put("good", 0);
    memcpy(end - 16, magic, 16); /* imgtool sign --pad --test */
    CHECK_INT(slot_read(0).state, SLOT_PENDING);
    end[-24] = 1; /* --confirm */
    CHECK_INT(slot_read(0).state, SLOT_CONFIRMED);
    CHECK_INT(start(), 0);
}

/* As an erase leaves it that was cut: some bits of the generation are set again, the rest is as it was. */
TEST(does_not_believe_a_generation_that_is_not_whole)
{
    two_images();
    slot_select(1, true);
    CHECK_INT(start(), 1);
    nor_flash[slot_address(1) + FLASH_MAP_SLOT_SIZE - 48 + 1] = 0xff;
    CHECK_INT(slot_read(1).state, SLOT_UNSELECTED);
}

TEST(writes_the_counter_only_when_it_grows)
{
    nor_flash_reset();
    for (unsigned n = 0; n < 2000; n++)
        counter_raise(7);
    CHECK_INT(nor_flash_changes(), 8);
}

TEST(never_starts_an_older_one)
{
    nor_flash_reset();
    boot_image_put("newer", 0);
    boot_image_put("good", 1);
    CHECK_INT(counter_read(), 0);
    slot_select(0, false);
    CHECK_INT(start(), 0);
    CHECK_INT(counter_read(), 0); /* only tried */
    CHECK(slot_confirm(0));
    CHECK_INT(start(), 0);
    CHECK_INT(counter_read(), 0x01000001);
    slot_select(1, true);
    CHECK_INT(start(), 0);
}

TEST(counts_through_both_sectors)
{
    nor_flash_reset();
    for (uint32_t value = 1; value <= 1200; value++) {
        counter_raise(value);
        counter_raise(value - 1);
        CHECK_INT(counter_read(), value);
    }
}

TEST(does_not_count_below_the_guard)
{
    nor_flash_reset();
    counter_raise(5);
    flash_lock();
    counter_raise(6);
    CHECK_INT(counter_read(), 5);
}

/* Each step on a flash as it was before, with the power cut at each change, twice. */
static uint8_t before[NOR_FLASH_BYTES];

static bool raise_to_513(void)
{
    counter_raise(513);
    return counter_read() == 513;
}
static bool select_for_test(void) { return slot_select(1, false); }
static bool select_for_good(void) { return slot_select(1, true); }
static bool start_pending(void) { return start() == 1; }
static bool confirm_tried(void) { return slot_confirm(1); }

static unsigned cuts;

/* After a cut in `step` the start is slot 0's image or slot 1's, and after the step it is slot 1's. */
static bool survives(bool (*step)(void), int after)
{
    memcpy(before, nor_flash, sizeof before);
    for (unsigned long at = 0;; at++) {
        bool done;
        int slot;

        nor_flash_put(before);
        nor_flash_cut_after(at);
        done = step();
        nor_flash_power_up();
        if (done)
            return start() == after;
        cuts++;
        slot = start();
        if (slot != 0 && slot != 1)
            return false;
        /* Whatever was left, the next start is one again, and the step can be done again. */
        slot = start();
        if (slot != 0 && slot != 1)
            return false;
    }
}

TEST(a_valid_image_runs_after_every_cut)
{
    two_images();
    cuts = 0;
    CHECK(survives(select_for_test, 1));
    CHECK(survives(select_for_good, 1));
    two_images();
    slot_select(1, false);
    CHECK(survives(start_pending, 0)); /* the next start after the one that is tried reverts */
    two_images();
    slot_select(1, false);
    start();
    CHECK(survives(confirm_tried, 1));
    CHECK(cuts > 50);
}

TEST(the_counter_survives_every_cut)
{
    nor_flash_reset();
    for (uint32_t value = 1; value <= 512; value++)
        counter_raise(value);
    memcpy(before, nor_flash, sizeof before);
    for (unsigned long at = 0; at < 9; at++) {
        nor_flash_put(before);
        nor_flash_cut_after(at);
        (void)raise_to_513();
        nor_flash_power_up();
        CHECK(counter_read() == 512 || counter_read() == 513);
        counter_raise(514);
        CHECK_INT(counter_read(), 514);
    }
}

TEST_MAIN(RUN(starts_nothing_from_an_empty_flash); RUN(tests_once_and_reverts); RUN(stays_with_what_was_confirmed);
          RUN(starts_the_other_when_one_is_spoilt); RUN(of_two_confirmed_the_last_selected_counts_not_the_version);
          RUN(takes_trailers_that_imgtool_makes);
          RUN(does_not_believe_a_generation_that_is_not_whole); RUN(writes_the_counter_only_when_it_grows);
          RUN(never_starts_an_older_one); RUN(counts_through_both_sectors);
          RUN(does_not_count_below_the_guard); RUN(a_valid_image_runs_after_every_cut);
          RUN(the_counter_survives_every_cut))
