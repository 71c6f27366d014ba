/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The boot program's decisions on the host, over a flash in a file.
 *
 *     boot-server FILE start           decide what to start; prints "slot major.minor.revision" or "none"
 *     boot-server FILE serve RUNNING   the update server on standard input and output, until it is told to reset
 *     boot-server FILE confirm SLOT    what an application does that finds itself well
 *
 * The file is read at the beginning and written at the end. RUNNING is the slot whose application asked for the update, or -1.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "boot/frame.h"
#include "boot/smp.h"
#include "boot/start.h"
#include "nor_flash.h"

static uint8_t memory[IMAGE_RAM_BYTES];

static void load(const char *path)
{
    FILE *file = fopen(path, "rb");

    nor_flash_reset();
    if (file == NULL)
        return;
    if (fread(nor_flash, 1, sizeof nor_flash, file) != sizeof nor_flash)
        exit(2);
    fclose(file);
}

static void store(const char *path)
{
    FILE *file = fopen(path, "wb");

    if (file == NULL || fwrite(nor_flash, 1, sizeof nor_flash, file) != sizeof nor_flash || fclose(file) != 0)
        exit(2);
}

static void start(void)
{
    struct image image;
    const int slot = start_load(memory, &image);

    if (slot == SLOT_NONE)
        puts("none");
    else
        printf("%d %u.%u.%u\n", slot, image.version.major, image.version.minor, image.version.revision);
}

static void put(uint8_t byte)
{
    if (write(STDOUT_FILENO, &byte, 1) != 1)
        exit(2);
}

static void serve(int running)
{
    static struct frame frame;
    static uint8_t response[FRAME_PACKET_BYTES];
    uint8_t byte;

    smp_init(memory, running);
    while (!smp_reset_wanted() && read(STDIN_FILENO, &byte, 1) == 1) {
        const uint8_t *packet;
        size_t size = frame_take(&frame, byte, &packet);

        if (size != 0)
            size = smp_handle(packet, size, response, sizeof response);
        if (size != 0)
            frame_send(response, size, put);
    }
}

int main(int argc, char **argv)
{
    if (argc < 3)
        return 2;
    load(argv[1]);
    if (strcmp(argv[2], "start") == 0)
        start();
    else if (argc == 4 && strcmp(argv[2], "serve") == 0)
        serve(atoi(argv[3]));
    else if (argc != 4 || strcmp(argv[2], "confirm") != 0 || !slot_confirm(atoi(argv[3])))
        return 2;
    store(argv[1]);
    return 0;
}
