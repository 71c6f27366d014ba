/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/screw.h"

#include <math.h>
#include <stddef.h>

#include "core/axis.h"
#include "modules/coordinates.h"
#include "modules/tuning.h"

/* Advanced Applications manual of the original, array module: speed, encoder step, resolution of four
 * screws. 45396 counts/mm at 6.35 mm (its scan example) are 288265 counts a turn on all of them. */
static const struct screw screws[] = {
    {.pitch_mm = 1.5875, .counts_per_mm = 181584, .speed_max_mm_per_s = 1.7, .resolution_mm = 8e-5},
    {.pitch_mm = 6.35, .counts_per_mm = 45396, .speed_max_mm_per_s = 6.8, .resolution_mm = 2.5e-4},
    {.pitch_mm = 12.7, .counts_per_mm = 22698, .speed_max_mm_per_s = 13.5, .resolution_mm = 5e-4},
    {.pitch_mm = 25.4, .counts_per_mm = 11349, .speed_max_mm_per_s = 26, .resolution_mm = 1e-3},
};

static double pitch_mm[AXIS_COUNT];

const struct screw *screw_of_pitch(double mm)
{
    for (size_t i = 0; i < sizeof screws / sizeof screws[0]; i++)
        if (fabs(mm - screws[i].pitch_mm) <= 0.01 * screws[i].pitch_mm)
            return &screws[i];
    return NULL;
}

const struct screw *screw_of(unsigned axis)
{
    const struct screw *screw = screw_of_pitch(pitch_mm[axis]);

    return screw != NULL ? screw : &screws[1];
}

static enum status known(unsigned axis, double mm)
{
    (void)axis;
    return screw_of_pitch(mm) != NULL ? STATUS_OK : STATUS_RANGE;
}

/* Before CNTS and SPEED in the list of modules, so that saved ones of those win. */
static void changed(unsigned axis, double mm)
{
    const struct screw *screw = screw_of_pitch(mm);

    coordinates_set_scale(axis, screw->counts_per_mm);
    tuning_set_speed(axis, screw->speed_max_mm_per_s * TUNING_SPEED_SHARE);
}

static const struct parameter parameters[] = {
    {
        .command = "SCREW", .letter = PARAMETER_AXES, .type = PARAMETER_REAL, .decimals = 4,
        .unit = "mm", .summary = "Pitch of the lead screw; sets CNTS and SPEED with it.",
        .minimum = 0, .maximum = 100, .initial = 6.35, .saved = SAVED_BY_SS, .value = pitch_mm,
        .check = known, .taken = "1.5875, 6.35, 12.7, 25.4, each within a hundredth", .set = changed,
    },
    {0},
};

static const struct command commands[] = {
    {.name = "SCREW", .summary = "Lead screws.", .form = FORM_P},
    {0},
};

const struct module screw_module = {
    .name = "screw",
    .commands = commands,
    .parameters = parameters,
};
