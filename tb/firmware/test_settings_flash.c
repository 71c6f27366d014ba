/* SPDX-License-Identifier: BSD-2-Clause */
/* The settings in flash: what comes back, what does not, and what it costs. Power cuts: tb/powercut. */
#include "check.h"

#include <math.h>
#include <stdlib.h>

#include "../powercut/chip.h"
#include "hal/flash_map.h"
#include "random.h"
#include "store/settings_flash.h"

enum { KEYS = 200, REGION = FLASH_MAP_SETTINGS, REGION_SIZE = FLASH_MAP_SETTINGS_SECTORS * FLASH_SECTOR };

static struct chip *chip;
static const struct settings_store *store;

static void power_up(void)
{
    store = settings_flash();
}

/* A chip as delivered. */
static void start(void)
{
    free(chip);
    chip = calloc(1, sizeof *chip);
    chip_deliver(chip, 0, NOR_BYTES);
    chip_fit(chip);
    chip_on_step(NULL);
    flash_on_wait(NULL);
    power_up();
}

static bool keep_all(double first)
{
    for (uint32_t key = 1; key <= KEYS; key++)
        if (!store->write(key, first + key))
            return false;
    return store->commit();
}

/* Values 1 to KEYS are those of keep_all. */
static bool has_all(double first)
{
    double value;

    for (uint32_t key = 1; key <= KEYS; key++)
        if (!store->read(key, &value) || value != first + key)
            return false;
    return true;
}

static bool has_none(void)
{
    double value;

    for (uint32_t key = 1; key <= KEYS; key++)
        if (store->read(key, &value))
            return false;
    return true;
}

TEST(a_chip_as_delivered_holds_nothing_and_is_not_written_at_a_start)
{
    start();
    CHECK(!store->damaged() && has_none());
    CHECK_INT(chip->steps, 0);
    CHECK(keep_all(0));
    power_up();
    CHECK(!store->damaged() && has_all(0));
}

TEST(a_board_without_a_chip_keeps_nothing)
{
    chip_fit(NULL);
    power_up();
    CHECK(store->damaged());
    CHECK(!keep_all(0));
}

/* Against an array: some values change, some are forgotten, now and then the power goes. */
TEST(what_was_kept_comes_back_and_nothing_else)
{
    double now[KEYS], kept[KEYS], value;

    start();
    for (unsigned key = 0; key < KEYS; key++)
        now[key] = kept[key] = NAN;
    for (unsigned round = 0; round < 500; round++) {
        for (unsigned n = random_below(20); n > 0; n--) {
            const unsigned key = random_below(KEYS);

            now[key] = random_below(5) == 0 ? NAN : random_below(1000000) / 64.0 - 5000;
            CHECK(store->write(key, now[key]));
        }
        if (random_below(3) != 0) {
            CHECK(store->commit());
            memcpy(kept, now, sizeof kept);
        }
        if (random_below(4) != 0)
            continue;
        power_up();
        CHECK(!store->damaged());
        memcpy(now, kept, sizeof now);
        for (unsigned key = 0; key < KEYS; key++) {
            CHECK(store->read(key, &value) == !isnan(kept[key]));
            CHECK(isnan(kept[key]) || value == kept[key]);
        }
    }
}

TEST(a_full_store_keeps_what_it_has)
{
    double value;

    start();
    for (uint32_t key = 0; key < SETTINGS_MAX; key++)
        CHECK(store->write(key, key));
    CHECK(!store->write(SETTINGS_MAX, 1));
    CHECK(store->commit());
    power_up();
    CHECK(!store->damaged());
    CHECK(store->read(SETTINGS_MAX - 1, &value) && value == SETTINGS_MAX - 1);
}

/* Where the file is: its first bytes, in the sector that was written last. */
static uint32_t file_address(void)
{
    for (uint32_t at = REGION; at < REGION + REGION_SIZE; at += FLASH_SECTOR)
        if (chip->bytes[at] == 'A' && chip->bytes[at + 1] == 'B' && chip->bytes[at + 2] == 'S')
            return at;
    return 0;
}

enum { FILE_SIZE = 8 + KEYS * 12 + 4 };

TEST(a_flipped_bit_anywhere_in_the_file_is_found_and_the_next_save_mends_it)
{
    start();
    for (unsigned n = 0; n < FILE_SIZE; n++) {
        if (n % 16 == 0) {
            start();
            CHECK(keep_all(n));
        }
        chip->bytes[file_address() + n] ^= (uint8_t)(1 << n % 8);
        power_up();
        CHECK(store->damaged() && has_none());
        chip->bytes[file_address() + n] ^= (uint8_t)(1 << n % 8);
    }
    chip->bytes[file_address() + 100] ^= 1;
    power_up();
    CHECK(keep_all(7) && !store->damaged());
    power_up();
    CHECK(!store->damaged() && has_all(7));
}

/* CRC-32 bit by bit, complemented at its beginning only. */
static uint32_t crc_of(const uint8_t *bytes, size_t size)
{
    uint32_t crc = UINT32_MAX;

    for (size_t n = 0; n < size; n++) {
        crc ^= bytes[n];
        for (unsigned bit = 0; bit < 8; bit++)
            crc = crc >> 1 ^ ((crc & 1) != 0 ? 0xedb88320u : 0);
    }
    return crc;
}

/* Change the version in place, and what it is checked by. */
static void set_version(uint8_t version)
{
    const uint32_t at = file_address();
    uint8_t image[FILE_SIZE];
    uint32_t crc;

    (void)flash_read(at, image, sizeof image);
    image[4] = version;
    crc = crc_of(image, FILE_SIZE - 4);
    memcpy(image + FILE_SIZE - 4, &crc, 4);
    for (unsigned n = 0; n < FILE_SIZE; n++)
        chip->bytes[at + n] = image[n];
}

TEST(a_file_of_a_later_version_is_not_taken_for_ours)
{
    start();
    CHECK(keep_all(0));
    set_version(2);
    power_up();
    CHECK(store->damaged() && has_none());
    set_version(1);
    power_up();
    CHECK(!store->damaged() && has_all(0));
}

TEST(noise_instead_of_a_directory_is_found_and_the_next_save_begins_anew)
{
    for (unsigned round = 0; round < 20; round++) {
        start();
        CHECK(keep_all(0));
        for (unsigned n = 0; n < 2 * FLASH_SECTOR; n++)
            chip->bytes[REGION + n] = (uint8_t)random_below(256);
        power_up();
        CHECK(store->damaged() && has_none());
        CHECK(keep_all(1));
        power_up();
        CHECK(!store->damaged() && has_all(1));
    }
}

TEST(a_chip_that_fails_in_a_save_has_what_was_before)
{
    for (int operations = 0;; operations++) {
        start();
        CHECK(keep_all(0));
        chip_wear_out(operations);
        if (keep_all(1))
            break;
        chip_wear_out(-1);
        power_up();
        CHECK(!store->damaged() && has_all(0));
        CHECK(keep_all(2));
        power_up();
        CHECK(has_all(2));
        CHECK(operations < 100);
    }
}

static void change_meanwhile(void)
{
    for (uint32_t key = 1; key <= KEYS; key++)
        (void)store->write(key, 1000 + key);
}

TEST(what_changes_while_it_saves_waits_for_the_next)
{
    start();
    CHECK(keep_all(0));
    flash_on_wait(change_meanwhile);
    CHECK(keep_all(100));
    flash_on_wait(NULL);
    CHECK(has_all(1000));
    power_up();
    CHECK(!store->damaged() && has_all(100));
}

/* docs/settings.md has the figures. */
TEST(wear_is_spread_and_a_start_reads_little)
{
    enum { SAVES = 10000 };
    uint64_t reads_most = 0, bytes_most = 0;
    uint32_t all = 0, least = UINT32_MAX, most = 0;

    start();
    for (unsigned n = 0; n < SAVES; n++) {
        CHECK(keep_all(n));
        if (n % 10 != 0)
            continue;
        const uint64_t steps = chip->steps, reads = chip->reads, bytes = chip->bytes_read;

        power_up();
        CHECK(has_all(n));
        CHECK_INT(chip->steps, steps);
        reads_most = chip->reads - reads > reads_most ? chip->reads - reads : reads_most;
        bytes_most = chip->bytes_read - bytes > bytes_most ? chip->bytes_read - bytes : bytes_most;
    }
    for (uint32_t n = REGION / FLASH_SECTOR; n < (REGION + REGION_SIZE) / FLASH_SECTOR; n++) {
        all += chip->erases[n];
        least = chip->erases[n] < least ? chip->erases[n] : least;
        most = chip->erases[n] > most ? chip->erases[n] : most;
    }
    for (uint32_t n = 0; n < NOR_SECTORS; n++)
        CHECK(chip->erases[n] == 0 || (n >= REGION / FLASH_SECTOR && n < (REGION + REGION_SIZE) / FLASH_SECTOR));
    printf("# %d saves: %u erases, %.2f a save, %.0f a sector, at least %u, at most %u; %.1f pages a save; a start: %u bytes in %u reads\n",
           SAVES, all, (double)all / SAVES, (double)all / FLASH_MAP_SETTINGS_SECTORS, least, most, (double)chip->pages / SAVES,
           (unsigned)bytes_most, (unsigned)reads_most);
    CHECK(all < 1.5 * SAVES);
    CHECK(most < 2.5 * all / FLASH_MAP_SETTINGS_SECTORS);
    CHECK(bytes_most <= 8000 && reads_most <= 100);
}

TEST_MAIN(RUN(a_chip_as_delivered_holds_nothing_and_is_not_written_at_a_start); RUN(a_board_without_a_chip_keeps_nothing);
          RUN(what_was_kept_comes_back_and_nothing_else); RUN(a_full_store_keeps_what_it_has);
          RUN(a_flipped_bit_anywhere_in_the_file_is_found_and_the_next_save_mends_it);
          RUN(a_file_of_a_later_version_is_not_taken_for_ours);
          RUN(noise_instead_of_a_directory_is_found_and_the_next_save_begins_anew);
          RUN(a_chip_that_fails_in_a_save_has_what_was_before); RUN(what_changes_while_it_saves_waits_for_the_next);
          RUN(wear_is_spread_and_a_start_reads_little))
