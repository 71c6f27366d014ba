/* SPDX-License-Identifier: BSD-2-Clause */
#include "store/settings_flash.h"

#include <lfs.h>
#include <string.h>

#include "hal/flash_map.h"

enum {
    VERSION = 1,
    HEADER = 8,
    ENTRY = 12,
    CHECK = 4,
    IMAGE_MAX = HEADER + SETTINGS_MAX * ENTRY + CHECK,
};

static const char file_name[] = "settings";
static const char magic[4] = {'A', 'B', 'S', 'E'};

static uint8_t image[IMAGE_MAX];
static lfs_t lfs;
static bool mounted;
static bool unread; /* what is in the flash is not what the RAM has */

/* --- The flash, as littlefs sees it ------------------------------------------------------------ */

static uint32_t address_of(lfs_block_t block, lfs_off_t offset)
{
    return FLASH_MAP_SETTINGS + block * FLASH_SECTOR + offset;
}

static int read(const struct lfs_config *config, lfs_block_t block, lfs_off_t offset, void *to, lfs_size_t size)
{
    (void)config;
    return flash_read(address_of(block, offset), to, size) ? LFS_ERR_OK : LFS_ERR_IO;
}

static int program(const struct lfs_config *config, lfs_block_t block, lfs_off_t offset, const void *from,
                   lfs_size_t size)
{
    (void)config;
    return flash_program(address_of(block, offset), from, size) ? LFS_ERR_OK : LFS_ERR_IO;
}

static int erase(const struct lfs_config *config, lfs_block_t block)
{
    (void)config;
    return flash_erase(address_of(block, 0)) ? LFS_ERR_OK : LFS_ERR_IO;
}

/* Nothing is held back. */
static int sync(const struct lfs_config *config)
{
    (void)config;
    return LFS_ERR_OK;
}

static uint8_t read_buffer[FLASH_PAGE], program_buffer[FLASH_PAGE], file_buffer[FLASH_PAGE];
static uint8_t lookahead_buffer[FLASH_MAP_SETTINGS_SECTORS / 8];

static const struct lfs_config config = {
    .read = read, .prog = program, .erase = erase, .sync = sync,
    .read_size = 16,
    .prog_size = FLASH_PAGE, /* a cut leaves a page in doubt: no two commits share one */
    .cache_size = FLASH_PAGE,
    .block_size = FLASH_SECTOR,
    .block_count = FLASH_MAP_SETTINGS_SECTORS,
    .block_cycles = 100,                 /* erases until the directory moves on: wear */
    .metadata_max = FLASH_SECTOR / 4,    /* what a start has to read of the directory */
    .inline_max = (lfs_size_t)-1,        /* a directory of one short entry */
    .lookahead_size = sizeof lookahead_buffer,
    .read_buffer = read_buffer, .prog_buffer = program_buffer, .lookahead_buffer = lookahead_buffer,
};

static const struct lfs_file_config file_config = {.buffer = file_buffer};

/* --- The image --------------------------------------------------------------------------------- */

static uint32_t check_of(size_t length)
{
    return lfs_crc(UINT32_MAX, image, length);
}

/* Length of the image of all values. What was forgotten is left out. */
static size_t write_image(void)
{
    uint16_t version = VERSION, count = 0;
    size_t length = HEADER;
    uint32_t key, check;
    double value;

    for (unsigned n = 0; settings_ram_entry(n, &key, &value); n++) {
        if (value != value)
            continue;
        memcpy(image + length, &key, sizeof key);
        memcpy(image + length + sizeof key, &value, sizeof value);
        length += ENTRY;
        count++;
    }
    memcpy(image, magic, sizeof magic);
    memcpy(image + 4, &version, sizeof version);
    memcpy(image + 6, &count, sizeof count);
    check = check_of(length);
    memcpy(image + length, &check, sizeof check);
    return length + sizeof check;
}

/* Give RAM what the image holds. False: it is not whole, or of a later firmware. */
static bool read_image(size_t size)
{
    uint16_t version, count;
    uint32_t key, check;
    double value;

    if (size < HEADER + CHECK || memcmp(image, magic, sizeof magic) != 0)
        return false;
    memcpy(&version, image + 4, sizeof version);
    memcpy(&count, image + 6, sizeof count);
    if (version != VERSION || size != HEADER + (size_t)count * ENTRY + CHECK)
        return false;
    memcpy(&check, image + size - CHECK, sizeof check);
    if (check != check_of(size - CHECK))
        return false;
    for (size_t at = HEADER; at < size - CHECK; at += ENTRY) {
        memcpy(&key, image + at, sizeof key);
        memcpy(&value, image + at + sizeof key, sizeof value);
        if (!settings_ram.write(key, value))
            return false;
    }
    return true;
}

/* --- The file ---------------------------------------------------------------------------------- */

/*
 * Whether nothing was ever kept: behind the directory's two sectors, which the first save formats and may have been
 * cut in, every sector is as delivered. Files begin at the beginning of one.
 */
static bool is_blank(void)
{
    uint8_t first[16];

    for (uint32_t sector = 2; sector < FLASH_MAP_SETTINGS_SECTORS; sector++) {
        if (!flash_read(address_of(sector, 0), first, sizeof first))
            return false;
        for (size_t n = 0; n < sizeof first; n++)
            if (first[n] != 0xff)
                return false;
    }
    return true;
}

static int mount(void)
{
    const int status = mounted ? LFS_ERR_OK : lfs_mount(&lfs, &config);

    mounted = status == LFS_ERR_OK;
    return status;
}

static int format(void)
{
    const int status = lfs_format(&lfs, &config);

    mounted = false;
    return status == LFS_ERR_OK ? mount() : status;
}

/* False: there is a file, and it could not be read. One that is empty was about to be written for the first time. */
static bool load(void)
{
    lfs_file_t file;
    lfs_ssize_t size;
    int status;

    mounted = false;
    if (mount() != LFS_ERR_OK)
        return is_blank();
    status = lfs_file_opencfg(&lfs, &file, file_name, LFS_O_RDONLY, &file_config);
    if (status == LFS_ERR_NOENT)
        return true;
    if (status != LFS_ERR_OK)
        return false;
    size = lfs_file_read(&lfs, &file, image, sizeof image);
    (void)lfs_file_close(&lfs, &file);
    return size == 0 || (size > 0 && read_image((size_t)size));
}

/* The old file is the file until the new one is closed. */
static int save_image(size_t size)
{
    lfs_file_t file;
    lfs_ssize_t written;
    int status = lfs_file_opencfg(&lfs, &file, file_name, LFS_O_WRONLY | LFS_O_CREAT | LFS_O_TRUNC, &file_config);

    if (status != LFS_ERR_OK)
        return status;
    written = lfs_file_write(&lfs, &file, image, (lfs_size_t)size);
    status = lfs_file_close(&lfs, &file);
    return written < 0 ? (int)written : status;
}

/* A flash that does not answer is not formatted, nor is one that is only full. */
static bool commit(void)
{
    const size_t size = write_image();
    int status = mount();

    if (status == LFS_ERR_OK)
        status = save_image(size);
    if (status == LFS_ERR_CORRUPT || status == LFS_ERR_INVAL) {
        status = format();
        if (status == LFS_ERR_OK)
            status = save_image(size);
    }
    unread &= status != LFS_ERR_OK;
    return status == LFS_ERR_OK;
}

static bool damaged(void)
{
    return unread;
}

const struct settings_store *settings_flash(void)
{
    static struct settings_store store;

    settings_ram_clear();
    store = settings_ram;
    store.commit = commit;
    store.damaged = damaged;
    unread = !load();
    return &store;
}
