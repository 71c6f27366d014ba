/* SPDX-License-Identifier: BSD-2-Clause */
#include "host/settings_file.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>

static char path[1024];
static bool dropped; /* something in the file on disk was not understood */

/* Entries live in RAM; the file is their image. */
static bool commit(void)
{
    char beside[sizeof path + 4];
    uint32_t key;
    double value;

    snprintf(beside, sizeof beside, "%s.new", path);
    FILE *file = fopen(beside, "w");
    if (file == NULL)
        return false;
    for (unsigned n = 0; settings_ram_entry(n, &key, &value); n++)
        fprintf(file, "%08" PRIx32 " %a\n", key, value);
    bool written = ferror(file) == 0;
    if (fclose(file) != 0 || !written || rename(beside, path) != 0)
        return false;
    dropped = false;
    return true;
}

static bool damaged(void)
{
    return dropped;
}

const struct settings_store *settings_file(const char *name)
{
    static struct settings_store store;
    char line[100];
    uint32_t key;
    double value;

    store = settings_ram;
    store.commit = commit;
    store.damaged = damaged;
    snprintf(path, sizeof path, "%s", name);
    FILE *file = fopen(path, "r");
    dropped = file == NULL && errno != ENOENT;
    if (file == NULL)
        return &store;
    while (fgets(line, sizeof line, file) != NULL)
        if (sscanf(line, "%" SCNx32 " %la", &key, &value) != 2 || !store.write(key, value))
            dropped = true;
    fclose(file);
    return &store;
}
