/* SPDX-License-Identifier: BSD-2-Clause */
/* Settings, by the whole firmware and its language, over memory for registers. */
#include <stdio.h>
#include <string.h>

#include "core/fault.h"
#include "core/settings.h"
#include "machine.h"
#include "scenario.h"
#include "store/settings_flash.h"

enum { WORN_SAVES = 391 }; /* a hundred directories */

static void power_up(void)
{
    settings_init(settings_flash());
    machine_start();
    machine_run(200);
}

/* False: one of them was not acknowledged. */
static bool say(const char *const *lines)
{
    for (; *lines != NULL; lines++)
        if (strncmp(machine_send(*lines), ":A", 2) != 0)
            return false;
    return true;
}

/* Of each value the firmware keeps, whatever the order. */
static uint32_t digest(unsigned *count)
{
    uint32_t sum = 0, key;
    double value;

    *count = 0;
    for (unsigned n = 0; settings_ram_entry(n, &key, &value); n++) {
        uint8_t bytes[sizeof key + sizeof value];
        uint32_t hash = 2166136261u;

        if (value != value)
            continue;
        memcpy(bytes, &key, sizeof key);
        memcpy(bytes + sizeof key, &value, sizeof value);
        for (size_t i = 0; i < sizeof bytes; i++)
            hash = (hash ^ bytes[i]) * 16777619u;
        sum += hash;
        ++*count;
    }
    return sum;
}

static void tell(char *state)
{
    static const char *const questions[] = {"S X? Y? Z? F?", "AC X?", "UM X? Y?", "V", "TTL X? Y?", "SCANR Z?", "SL X? Y?",
                                            "SU X?", "HM X?", "W X Y Z F"};
    unsigned count;
    size_t length;

    settings_init(settings_flash());
    const uint32_t sum = digest(&count);
    machine_start();
    length = (size_t)snprintf(state, SCENARIO_STATE_MAX, "%u values %08x, error %u, ", count, sum, fault_read(0));
    machine_run(200);
    for (size_t n = 0; n < sizeof questions / sizeof *questions; n++)
        length += (size_t)snprintf(state + length, SCENARIO_STATE_MAX - length, "%s", machine_send(questions[n]));
    for (char *at = state; *at != '\0'; at++)
        if (*at == '\r' || *at == '\n')
            *at = *at == '\r' ? ';' : ' ';
}

static const char *const before[] = {"S X=1.25 Y=1.5", "AC X=77", "UM Y=-10000", "V X=5 Z=53", "SL X=-20", "SU X=21",
                                     "SS Z", NULL};
static const char *const after[] = {"S X=2.25 Y=2.5", "AC X=88", "UM Y=10000", "V X=5 Z=52", "SCANR Z=12", "SS Z", NULL};

static bool prepare_nothing(void)
{
    return true;
}

static bool prepare_settings(void)
{
    power_up();
    return say(before);
}

static bool save_often(unsigned times)
{
    static char speed[32];
    const char *const lines[] = {speed, "SS Z", NULL};

    for (unsigned n = 0; n < times; n++) {
        snprintf(speed, sizeof speed, "S Z=%u.%03u", 1 + n % 2, n % 1000);
        if (!say(lines))
            return false;
    }
    return true;
}

/* The next save makes a new directory of the full one. */
static bool prepare_full(void)
{
    return prepare_settings() && save_often(3);
}

/* The next save lets the directory move on to other sectors, as worn ones. */
static bool prepare_worn(void)
{
    return prepare_settings() && save_often(WORN_SAVES);
}

static bool save(void)
{
    power_up();
    return say(after);
}


/* Kept at once, and together. */
static bool set_limits(void)
{
    static const char *const lines[] = {"SL X=-30 Y=-31", NULL};

    power_up();
    return say(lines);
}

static bool shut_down(void)
{
    static const char *const move[] = {"M X=7000 Z=-990", NULL}, *const store[] = {"SP", NULL};

    power_up();
    return say(move) && machine_wait() && say(store);
}

static bool prepare_shut_down(void)
{
    return prepare_settings() && shut_down();
}

static bool start_only(void)
{
    power_up();
    return settings_kept();
}

const struct scenario scenario_settings[] = {
    {"first save", prepare_nothing, save, tell, NULL, "0 values", "error 0, :A X=2.250000 Y=2.500000", 3},
    {"save", prepare_settings, save, tell, NULL, "error 0, :A X=1.250000 Y=1.500000", "error 0, :A X=2.250000 Y=2.500000", 1},
    {"save, directory full", prepare_full, save, tell, NULL, "error 0, :A X=1.250000", "error 0, :A X=2.250000", 2},
    {"save, directory worn", prepare_worn, save, tell, NULL, "error 0, :A X=1.250000", "error 0, :A X=2.250000", 3},
    {"limits", prepare_settings, set_limits, tell, NULL, ":A X=-20.000 Y=-110.000", ":A X=-30.000 Y=-31.000", 1},
    {"SAVEPOS", prepare_settings, shut_down, tell, start_only, ":A 0.0 0.0 0.0 0.0", ":A 7000.0 0.0 -990.0 0.0", 1},
    {"start after SAVEPOS", prepare_shut_down, start_only, tell, NULL, ":A 7000.0 0.0 -990.0 0.0", ":A 0.0 0.0 0.0 0.0", 1},
    {0},
};
