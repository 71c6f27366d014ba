/* SPDX-License-Identifier: BSD-2-Clause */
#include "image_file.h"

#include <stdio.h>
#include <stdlib.h>

size_t image_file_read(const char *name, uint8_t bytes[IMAGE_FILE_BYTES])
{
    char path[1024];
    FILE *file;
    size_t size;

    snprintf(path, sizeof path, IMAGES "/%s.bin", name);
    file = fopen(path, "rb");
    if (file == NULL) {
        perror(path);
        exit(2);
    }
    size = fread(bytes, 1, IMAGE_FILE_BYTES, file);
    fclose(file);
    return size;
}
