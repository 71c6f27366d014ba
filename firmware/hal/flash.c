/* SPDX-License-Identifier: BSD-2-Clause */
/* Times: twice and more the maxima of Winbond's W25Q128JV (3 ms a page, 400 ms a sector) and ISSI's IS25LP128. */
#include "hal/flash.h"

#include "hal/timer.h"
#include "regs.h"

enum {
    PAGE_PROGRAM = 0x02,
    READ = 0x03,
    READ_STATUS = 0x05,
    WRITE_ENABLE = 0x06,
    SECTOR_ERASE = 0x20,
    READ_ID = 0x9f,
    WAKE = 0xab,

    READ_MOST = 0xfffc, /* bytes of a frame, in whole words */
    STATUS_BUSY = 1,
    NOBODY = 0xff, /* what a pin that is pulled up reads as: no status, no maker */

    SIZE_BITS_LEAST = 24, /* log2 of the bytes; in a smaller flash addresses wrap to the bitstreams */
    SIZE_BITS_MOST = 32,

    MS = CLOCK_HZ / 1000u,
    FRAME_CYCLES = 1 * MS, /* for a word of it, or its end: 4 us */
    WAKE_CYCLES = CLOCK_HZ / 200000u,
    PROGRAM_CYCLES = 10 * MS,
    ERASE_CYCLES = 1000 * MS,
};

static bool present;
static bool waiting;
static void (*on_wait)(void);

/* Wait until a bit of the frame's status is as wanted. */
static bool wait_frame(uint32_t mask, uint32_t wanted)
{
    const uint32_t begin = timer_now_cycles();

    for (;;) {
        /* In this order: an interrupt between them is no time-out. */
        const bool late = timer_now_cycles() - begin > FRAME_CYCLES;

        if ((flash_status_read() & mask) == wanted)
            return true;
        if (late) {
            flash_control_write(REG_FLASH_CONTROL_ABORT_MASK);
            return false;
        }
    }
}

static bool wait_ready(void)
{
    return wait_frame(REG_FLASH_STATUS_READY_MASK, REG_FLASH_STATUS_READY_MASK);
}

/* False: it was refused. */
static bool begin_frame(uint32_t opcode, uint32_t size)
{
    flash_frame_write(opcode | size << REG_FLASH_FRAME_SIZE_SHIFT);
    return (flash_status_read() & REG_FLASH_STATUS_REFUSED_MASK) == 0;
}

static bool end_frame(void)
{
    return wait_frame(REG_FLASH_STATUS_BUSY_MASK, 0);
}

/* A frame without data, with or without an address. */
static bool command(uint32_t opcode)
{
    return begin_frame(opcode, 0) && end_frame();
}

static bool read_frame(uint32_t opcode, uint8_t *to, uint32_t size)
{
    if (!begin_frame(opcode, size))
        return false;
    for (uint32_t n = 0; n < size; n += 4) {
        uint32_t word;

        if (!wait_ready())
            return false;
        word = flash_data_read();
        for (uint32_t lane = 0; lane < 4 && n + lane < size; lane++)
            to[n + lane] = (uint8_t)(word >> 8 * lane);
    }
    return end_frame();
}

static uint8_t read_status(void)
{
    uint8_t status;

    return read_frame(READ_STATUS, &status, sizeof status) ? status : NOBODY;
}

/* Wait until the flash itself is done. */
static bool wait_done(uint32_t most_cycles)
{
    const uint32_t begin = timer_now_cycles();

    for (;;) {
        const bool late = timer_now_cycles() - begin > most_cycles;
        const uint8_t status = read_status();

        if ((status & STATUS_BUSY) == 0)
            return true;
        if (status == NOBODY || late)
            return false;
        if (on_wait != NULL) {
            waiting = true;
            on_wait();
            waiting = false;
        }
    }
}

bool flash_present(void)
{
    uint8_t id[3]; /* maker, kind, size */
    uint32_t begin;

    if (waiting)
        return false;
    present = false;
    flash_control_write(REG_FLASH_CONTROL_ABORT_MASK);
    /* The FPGA's clock pin may swallow edges of the first frame after configuration: this one may be lost. */
    if (!end_frame() || !command(WAKE))
        return false;
    for (begin = timer_now_cycles(); timer_now_cycles() - begin < WAKE_CYCLES;)
        ;
    present = wait_done(ERASE_CYCLES) && read_frame(READ_ID, id, sizeof id) && id[0] != 0 && id[0] != NOBODY &&
              id[2] >= SIZE_BITS_LEAST && id[2] <= SIZE_BITS_MOST;
    return present;
}

static bool refuses(uint32_t address, size_t size)
{
    return !present || waiting || address > FLASH_BYTES || size > FLASH_BYTES - address;
}

bool flash_read(uint32_t address, void *to, size_t size)
{
    uint8_t *bytes = to;

    if (refuses(address, size))
        return false;
    while (size > 0) {
        const uint32_t part = size < READ_MOST ? (uint32_t)size : READ_MOST;

        flash_address_write(address);
        if (!read_frame(READ, bytes, part))
            return false;
        address += part;
        bytes += part;
        size -= part;
    }
    return true;
}

static bool program_page(uint32_t address, const uint8_t *from, uint32_t size)
{
    if (!command(WRITE_ENABLE))
        return false;
    flash_address_write(address);
    if (!begin_frame(PAGE_PROGRAM, size))
        return false;
    for (uint32_t n = 0; n < size; n += 4) {
        uint32_t word = 0;

        for (uint32_t lane = 0; lane < 4 && n + lane < size; lane++)
            word |= (uint32_t)from[n + lane] << 8 * lane;
        if (!wait_ready())
            return false;
        flash_data_write(word);
    }
    return end_frame() && wait_done(PROGRAM_CYCLES);
}

bool flash_program(uint32_t address, const void *from, size_t size)
{
    const uint8_t *bytes = from;

    if (refuses(address, size))
        return false;
    while (size > 0) {
        const uint32_t room = FLASH_PAGE - address % FLASH_PAGE, part = size < room ? (uint32_t)size : room;

        if (!program_page(address, bytes, part))
            return false;
        address += part;
        bytes += part;
        size -= part;
    }
    return true;
}

bool flash_erase(uint32_t address)
{
    if (refuses(address, 1) || !command(WRITE_ENABLE))
        return false;
    flash_address_write(address / FLASH_SECTOR * FLASH_SECTOR);
    return command(SECTOR_ERASE) && wait_done(ERASE_CYCLES);
}

void flash_lock(void)
{
    flash_control_write(REG_FLASH_CONTROL_LOCK_MASK);
}

void flash_on_wait(void (*poll)(void))
{
    on_wait = poll;
}
