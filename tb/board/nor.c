/* SPDX-License-Identifier: BSD-2-Clause */
/* Valid as C and as C++: firmware tests compile it as the one, the simulator as the other. */
#define _DEFAULT_SOURCE
#include "nor.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

enum command {
    PAGE_PROGRAM = 0x02,
    READ = 0x03,
    WRITE_DISABLE = 0x04,
    READ_STATUS = 0x05,
    WRITE_ENABLE = 0x06,
    SECTOR_ERASE = 0x20,
    READ_ID = 0x9f,
};

enum { HEADER = 4 }; /* opcode and address */

static const uint8_t identification[] = {0xef, 0x40, 0x18}; /* Winbond, 2^0x18 bytes */

void nor_init(struct nor *nor, uint8_t *bytes)
{
    memset(nor, 0, sizeof *nor);
    nor->bytes = bytes;
    nor->program_ps = INT64_C(700000000);
    nor->erase_ps = INT64_C(45000000000);
    nor->random = 1;
    nor->pins.cs_n = true;
}

/* All of a new file, erased. */
static bool erase_all(int file)
{
    uint8_t sector[NOR_SECTOR];

    memset(sector, 0xff, sizeof sector);
    for (unsigned n = 0; n < NOR_SECTORS; n++)
        if (write(file, sector, sizeof sector) != (ssize_t)sizeof sector)
            return false;
    return true;
}

uint8_t *nor_map(const char *path)
{
    const int file = path != NULL ? open(path, O_RDWR | O_CREAT, 0666) : -1;
    struct stat status;
    void *bytes = MAP_FAILED;

    if (path == NULL) {
        bytes = mmap(NULL, NOR_BYTES, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (bytes != MAP_FAILED)
            memset(bytes, 0xff, NOR_BYTES);
    } else if (file >= 0 && fstat(file, &status) == 0 && (status.st_size != 0 || erase_all(file))) {
        if (status.st_size == 0 || status.st_size == NOR_BYTES)
            bytes = mmap(NULL, NOR_BYTES, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
        else
            errno = EINVAL;
    }
    if (file >= 0) {
        const int why = errno;

        close(file);
        errno = why;
    }
    return bytes != MAP_FAILED ? (uint8_t *)bytes : NULL;
}

/* --- Chance ------------------------------------------------------------------------------------------------ */

static uint32_t random_below(struct nor *nor, uint32_t limit)
{
    uint32_t x = nor->random;

    x ^= x << 13;
    x ^= x >> 17;
    x ^= x << 5;
    nor->random = x;
    return (x >> 8) % limit;
}

/* A byte in which each bit is 1 with a probability, in 256ths. */
static uint8_t random_bits(struct nor *nor, uint32_t share)
{
    unsigned bits = 0;

    for (unsigned bit = 0; bit < 8; bit++)
        bits |= (random_below(nor, 256) < share ? 1u : 0u) << bit;
    return (uint8_t)bits;
}

/* --- Changes ----------------------------------------------------------------------------------------------- */

void nor_read(struct nor *nor, uint32_t address, uint8_t *to, size_t size)
{
    memcpy(to, nor->bytes + address, size);
    for (size_t n = 0; n < size; n++) {
        const uint8_t share = nor->unstable[(address + n) / NOR_SECTOR];

        if (share != 0)
            to[n] = (uint8_t)(to[n] | random_bits(nor, share));
    }
}

static void begin(struct nor *nor, enum nor_kind kind, uint32_t page, uint32_t first, uint32_t size)
{
    nor->work.kind = kind;
    nor->work.page = page;
    nor->work.first = first;
    nor->work.size = size;
    nor->work.done = 0;
}

void nor_program(struct nor *nor, uint32_t address, const uint8_t *from, uint32_t size)
{
    begin(nor, NOR_PROGRAMS, address / NOR_PAGE * NOR_PAGE, address % NOR_PAGE, size);
    memcpy(nor->work.before, nor->bytes + nor->work.page, NOR_PAGE);
    for (uint32_t n = 0; n < size; n++)
        nor->work.to[(nor->work.first + n) % NOR_PAGE] = from[n];
}

void nor_erase(struct nor *nor, uint32_t address)
{
    begin(nor, NOR_ERASES, address / NOR_SECTOR * NOR_SECTOR, 0, NOR_ERASE_STEPS);
}

void nor_step(struct nor *nor)
{
    if (nor->work.kind == NOR_RESTS)
        return;
    if (nor->work.kind == NOR_PROGRAMS) {
        const uint32_t at = (nor->work.first + nor->work.done) % NOR_PAGE;

        nor->bytes[nor->work.page + at] &= nor->work.to[at];
    }
    if (++nor->work.done < nor->work.size)
        return;
    if (nor->work.kind == NOR_ERASES) {
        memset(nor->bytes + nor->work.page, 0xff, NOR_SECTOR);
        nor->unstable[nor->work.page / NOR_SECTOR] = 0;
    }
    nor->work.kind = NOR_RESTS;
    nor->enabled = false;
}

void nor_advance(struct nor *nor, int64_t time_ps)
{
    const int64_t takes_ps = nor->work.kind == NOR_ERASES ? nor->erase_ps : nor->program_ps;
    const int64_t since_ps = time_ps - nor->work.since_ps;

    while (nor->work.kind != NOR_RESTS && since_ps >= takes_ps * (nor->work.done + 1) / nor->work.size)
        nor_step(nor);
}

static void cut_page(struct nor *nor)
{
    const uint32_t size = nor->work.size, done = nor->work.done;
    const bool in_order = random_below(nor, 2) == 0;
    const uint32_t share = 256 * (done + 1) / (size + 1);

    for (uint32_t n = 0; n < size; n++) {
        const uint32_t at = (nor->work.first + n) % NOR_PAGE;
        const unsigned moved = !in_order ? random_bits(nor, share) : n < done ? 0xffu : n > done ? 0u : random_bits(nor, 128);

        nor->bytes[nor->work.page + at] = (uint8_t)(nor->work.before[at] & (nor->work.to[at] | ~moved));
    }
}

static void cut_erase(struct nor *nor)
{
    static const struct {
        uint8_t least, most;
    } shares[NOR_ERASE_STEPS] = {{1, 8}, {30, 220}, {248, 255}};
    const unsigned least = shares[nor->work.done].least, most = shares[nor->work.done].most;

    nor->unstable[nor->work.page / NOR_SECTOR] = (uint8_t)(least + random_below(nor, most - least + 1));
}

void nor_cut(struct nor *nor, uint32_t seed)
{
    nor->random = seed * 2654435761u | 1; /* small seeds far apart */
    if (nor->work.kind == NOR_PROGRAMS)
        cut_page(nor);
    else if (nor->work.kind == NOR_ERASES)
        cut_erase(nor);
    nor->work.kind = NOR_RESTS;
    nor->enabled = nor->frame.selected = false;
}

/* --- Bytes ------------------------------------------------------------------------------------------------- */

void nor_select(struct nor *nor, int64_t time_ps)
{
    nor_advance(nor, time_ps);
    nor->frame.selected = true;
    nor->frame.count = nor->frame.address = 0;
    nor->frame.refused = nor->work.kind != NOR_RESTS;
}

/* The byte that comes next, if the selection has one. */
static uint8_t output(struct nor *nor, int64_t time_ps)
{
    const uint32_t count = nor->frame.count;
    uint8_t byte = 0xff;

    if (!nor->frame.selected || count == 0)
        return 0xff;
    if (nor->frame.command == READ_STATUS) {
        nor_advance(nor, time_ps);
        return (uint8_t)((nor->work.kind != NOR_RESTS ? 1 : 0) | (nor->enabled ? 2 : 0));
    }
    if (nor->frame.refused)
        return 0xff;
    if (nor->frame.command == READ_ID)
        return identification[(count - 1) % sizeof identification];
    if (nor->frame.command == READ && count >= HEADER)
        nor_read(nor, (nor->frame.address + count - HEADER) % NOR_BYTES, &byte, 1);
    return byte;
}

static void input(struct nor *nor, uint8_t byte)
{
    const uint32_t count = nor->frame.count++;

    if (count == 0)
        nor->frame.command = byte;
    else if (count < HEADER)
        nor->frame.address = nor->frame.address << 8 | byte;
    else
        nor->frame.page[(nor->frame.address + count - HEADER) % NOR_PAGE] = byte;
}

uint8_t nor_exchange(struct nor *nor, int64_t time_ps, uint8_t byte)
{
    const uint8_t out = output(nor, time_ps);

    if (nor->frame.selected)
        input(nor, byte);
    return out;
}

/* Of a page that was sent beyond its end, the last that came for each byte counts. */
static void program_sent(struct nor *nor)
{
    const uint32_t sent = nor->frame.count - HEADER, size = sent < NOR_PAGE ? sent : (uint32_t)NOR_PAGE;
    uint8_t bytes[NOR_PAGE];

    for (uint32_t n = 0; n < size; n++)
        bytes[n] = nor->frame.page[(nor->frame.address + n) % NOR_PAGE];
    nor_program(nor, nor->frame.address, bytes, size);
}

void nor_deselect(struct nor *nor, int64_t time_ps)
{
    const uint32_t count = nor->frame.count;

    nor_advance(nor, time_ps);
    if (!nor->frame.selected)
        return;
    nor->frame.selected = false;
    if (nor->frame.refused || count == 0)
        return;
    nor->work.since_ps = time_ps;
    if (nor->frame.command == WRITE_ENABLE && count == 1)
        nor->enabled = true;
    else if (nor->frame.command == WRITE_DISABLE && count == 1)
        nor->enabled = false;
    else if (nor->frame.command == PAGE_PROGRAM && count > HEADER && nor->enabled)
        program_sent(nor);
    else if (nor->frame.command == SECTOR_ERASE && count == HEADER && nor->enabled)
        nor_erase(nor, nor->frame.address);
}

/* --- Pins -------------------------------------------------------------------------------------------------- */

static void edge_of_select(struct nor *nor, int64_t time_ps, bool cs_n)
{
    if (!cs_n) {
        nor_select(nor, time_ps);
        nor->pins.bits = 0;
        nor->pins.out = 0xff;
    } else {
        if (nor->pins.bits % 8 != 0)
            nor->frame.selected = false; /* within a byte: nothing was asked */
        nor_deselect(nor, time_ps);
    }
}

static void edge_of_clock(struct nor *nor, int64_t time_ps, bool rises, bool mosi)
{
    if (rises) {
        nor->pins.in = (uint8_t)(nor->pins.in << 1 | (mosi ? 1 : 0));
        if (++nor->pins.bits % 8 == 0)
            input(nor, nor->pins.in);
    } else if (nor->pins.bits % 8 == 0) {
        nor->pins.out = output(nor, time_ps);
    } else {
        nor->pins.out = (uint8_t)(nor->pins.out << 1 | 1);
    }
}

int nor_pins(struct nor *nor, int64_t time_ps, int cs_n, int sck, int mosi)
{
    const bool deselected = cs_n != 0, high = sck != 0;

    if (deselected != nor->pins.cs_n)
        edge_of_select(nor, time_ps, deselected);
    else if (!deselected && high != nor->pins.sck)
        edge_of_clock(nor, time_ps, high, mosi != 0);
    nor->pins.cs_n = deselected;
    nor->pins.sck = high;
    return nor->frame.selected ? nor->pins.out >> 7 : 1;
}
