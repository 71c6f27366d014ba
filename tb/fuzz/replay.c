/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Runs a fuzz target without libFuzzer.
 *
 *     replay COUNT SEED FILE...     each file as it is, then COUNT inputs made of pieces of them
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "random.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { INPUT_MAX = 2048, PIECE_MAX = 64 };

struct text {
    uint8_t *bytes;
    size_t size;
};

static struct text read_file(const char *path)
{
    struct text text = {malloc(INPUT_MAX), 0};
    FILE *file = fopen(path, "rb");

    if (file == NULL || text.bytes == NULL) {
        perror(path);
        exit(2);
    }
    text.size = fread(text.bytes, 1, INPUT_MAX, file);
    fclose(file);
    return text;
}

/* Pieces of files one behind the other, here and there a byte changed. */
static size_t make_input(const struct text *texts, uint32_t count, uint8_t *input)
{
    size_t size = 0;

    for (uint32_t pieces = 1 + random_below(8); pieces > 0; pieces--) {
        const struct text *from = &texts[random_below(count)];

        if (from->size == 0)
            continue;
        size_t start = random_below((uint32_t)from->size);
        size_t length = 1 + random_below(PIECE_MAX);

        if (length > from->size - start)
            length = from->size - start;
        if (length > INPUT_MAX - size)
            length = INPUT_MAX - size;
        memcpy(input + size, from->bytes + start, length);
        size += length;
    }
    for (uint32_t changes = random_below(4); changes > 0 && size > 0; changes--)
        input[random_below((uint32_t)size)] = (uint8_t)random_below(256);
    return size;
}

int main(int argc, char **argv)
{
    const uint32_t files = argc > 3 ? (uint32_t)argc - 3 : 0;
    static uint8_t input[INPUT_MAX];

    if (files == 0) {
        fprintf(stderr, "usage: replay COUNT SEED FILE...\n");
        return 2;
    }
    struct text *texts = calloc(files, sizeof *texts);

    random_state = (uint32_t)strtoul(argv[2], NULL, 10) * 2654435761u + 1;
    for (uint32_t n = 0; n < files; n++) {
        texts[n] = read_file(argv[n + 3]);
        LLVMFuzzerTestOneInput(texts[n].bytes, texts[n].size);
    }
    for (long n = 0; n < atol(argv[1]); n++)
        LLVMFuzzerTestOneInput(input, make_input(texts, files, input));
    printf("%u files and %s inputs made of them\n", files, argv[1]);
    for (uint32_t n = 0; n < files; n++)
        free(texts[n].bytes);
    free(texts);
    return 0;
}
