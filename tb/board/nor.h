/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * A serial NOR flash of 16 MiB: its bits, its commands, its time, and what a power cut leaves of them.
 *
 * Bits go from 1 to 0 by programming, at most a page at once, and to 1 by erasing a sector. It is seen at four levels, each
 * by the one below it: pins (SPI mode 0), bytes of a selection, whole changes, steps of a change. A step is one byte
 * programmed, or one of the three moments of an erase: begin, middle, end.
 *
 * Commands, with 3-byte addresses (JEDEC JESD216; Winbond W25Q128JV): 0x9f identification, 0x03 read, 0x05 status (bit 0
 * busy, bit 1 write enable), 0x06 and 0x04 write enable and disable, 0x02 program a page, within which it wraps, 0x20 erase a
 * sector, 0xab wake, which it always is. Others are ignored, and while it is busy all but the status. A change is one only
 * if write enable is set, which its end clears, and if the selection ends where the command does.
 *
 * Times are picoseconds since power-up, and never go back. All state is in the struct, which has one pointer: to the
 * contents. No heap, but for nor_map.
 */
#ifndef BOARD_NOR_H
#define BOARD_NOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { NOR_PAGE = 256, NOR_SECTOR = 4096, NOR_BYTES = 16 << 20, NOR_SECTORS = NOR_BYTES / NOR_SECTOR, NOR_ERASE_STEPS = 3 };

/** What is in work. */
enum nor_kind { NOR_RESTS, NOR_PROGRAMS, NOR_ERASES };

struct nor {
    uint8_t *bytes;                 /**< NOR_BYTES, as a perfect reading has them. */
    uint8_t unstable[NOR_SECTORS];  /**< Share of readings, in 256, that a 0 of the sector is taken for 1. */
    int64_t program_ps, erase_ps;   /**< How long a change takes, of a page or a sector. */
    uint32_t random;                /**< xorshift32 (Marsaglia 2003), never 0. */
    bool enabled;                   /**< Write enable. */

    struct {
        enum nor_kind kind;
        uint32_t page, first, size, done;       /* bytes of the page, from `first` on and wrapping; steps */
        uint8_t before[NOR_PAGE], to[NOR_PAGE]; /* of the whole page */
        int64_t since_ps;
    } work;

    struct {
        bool selected, refused; /* refused: it began while something was in work */
        uint8_t command;
        uint32_t count, address; /* bytes received; of the next one that is read, or of the change */
        uint8_t page[NOR_PAGE];
    } frame;

    struct {
        bool cs_n, sck;
        uint8_t in, out;
        unsigned bits;
    } pins;
};

/** As delivered by its maker but for the contents, powered up. Typical times: 0.7 ms a page, 45 ms a sector. */
void nor_init(struct nor *nor, uint8_t *bytes);

/**
 * Contents that live in a file, which is made, erased, when there is none; NULL: in memory, erased. For the life of the
 * process. NULL with `errno` when that cannot be done; EINVAL: the file does not have NOR_BYTES.
 */
uint8_t *nor_map(const char *path);

/* -- Pins and bytes ------------------------------------------------------------------------------------------- */

/** The pins are like this from `time_ps` on; returns the level of MISO from then on, 1 when it is not driven. */
int nor_pins(struct nor *nor, int64_t time_ps, int cs_n, int sck, int mosi);

void nor_select(struct nor *nor, int64_t time_ps);

/** A byte to it; returns the one that comes from it meanwhile, 0xff when none does. `time_ps`: of the byte's begin. */
uint8_t nor_exchange(struct nor *nor, int64_t time_ps, uint8_t byte);

/** Changes begin here. */
void nor_deselect(struct nor *nor, int64_t time_ps);

/* -- Changes and steps ---------------------------------------------------------------------------------------- */

/** What a reading has; never beyond the end. */
void nor_read(struct nor *nor, uint32_t address, uint8_t *to, size_t size);

/** Begin to program up to a page, in the page of `address` and wrapping there; nothing is in work. */
void nor_program(struct nor *nor, uint32_t address, const uint8_t *from, uint32_t size);

/** Begin to erase the sector of `address`; nothing is in work. */
void nor_erase(struct nor *nor, uint32_t address);

/** Do the next step of what is in work. */
void nor_step(struct nor *nor);

/** Do the steps that are done by then. */
void nor_advance(struct nor *nor, int64_t time_ps);

/**
 * The power is cut where the work stands, and comes back. Of a page, the bytes before the step are there and a random subset
 * of the bits of its own, or a random subset of the bits of the whole page; a sector reads unstably until it is erased
 * again: few of its 0 read as 1 when it was cut at the beginning, nearly all at the end. `seed` chooses.
 */
void nor_cut(struct nor *nor, uint32_t seed);

#ifdef __cplusplus
}
#endif

#endif
