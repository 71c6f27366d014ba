/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/info.h"

#include <math.h>
#include <stddef.h>

#include "modules/axis.h"
#include "modules/coordinates.h"
#include "modules/joystick.h"
#include "modules/lookup.h"
#include "modules/low_level.h"
#include "modules/motion.h"
#include "modules/settling.h"
#include "modules/status.h"
#include "modules/tuning.h"

enum {
    COLUMN = 33,       /* where the second half of a line begins: hosts cut there */
    LABEL = 13,        /* characters before the colon */
    VALUE = 10,        /* characters of the value, right-justified */
    UNIT = 7,          /* characters of command and unit, after a blank */
    LINES_AT_ONCE = 4, /* what fits REPLY_MAX */
};

/* What a field is printed from: one axis, as of one tick. */
struct page {
    unsigned axis;
    struct axis_view view;
};

/*
 * A field. The value is that of a setting unless it has a function. The command in brackets tells
 * hosts what to ask for the value alone, so it is printed only when that command is built.
 */
struct field {
    const char *label;
    const char *command; /* long name, or NULL */
    double absent;       /* value of a setting that is not built: what the axis does without it */
    unsigned decimals;
    const char *unit;
    double (*number)(const struct page *page);
    const char *(*text)(const struct page *page);
};

/* --- Values ---------------------------------------------------------------------------------- */

static double speed_counts_per_s(const struct page *page)
{
    return tuning_speed_mm_per_s(page->axis) * coordinates_counts_per_mm(page->axis);
}

static double ramp_s(const struct page *page)
{
    return tuning_ramp_ms(page->axis) / 1e3;
}

/* Counts that settings in mm come to are cut off, as the original does. */
static double whole_counts(const struct page *page, const char *command)
{
    return floor(lookup_value(command, page->axis, 0) * coordinates_counts_per_mm(page->axis));
}

static double drift_counts(const struct page *page)
{
    return tuning_drift_counts(page->axis);
}

static double finish_counts(const struct page *page)
{
    return tuning_finish_counts(page->axis);
}

static double backlash_counts(const struct page *page)
{
    return whole_counts(page, "BACKLASH");
}

static double overshoot_counts(const struct page *page)
{
    return whole_counts(page, "OVERSHOOT");
}

/* Way of both ramps together. */
static double ramp_counts(const struct page *page)
{
    return speed_counts_per_s(page) * ramp_s(page);
}

static double vmax_enc_64(const struct page *page)
{
    return speed_counts_per_s(page) * AXIS_TICK_US / 1e6 * 64;
}

/* Change of speed in a servo step while ramping, in the unit of vmax_enc. */
static double dv_enc(const struct page *page)
{
    const double ticks = ramp_s(page) * 1e6 / AXIS_TICK_US;

    return ticks > 0 ? vmax_enc_64(page) / ticks : 0;
}

static double loop_ms(const struct page *page)
{
    (void)page;
    return AXIS_TICK_US / 1e3;
}

static double low_level_id(const struct page *page)
{
    return low_level_address(page->axis);
}

static double ki_16(const struct page *page)
{
    return 16 * lookup_value("KI", page->axis, 0);
}

static double enabled(const struct page *page)
{
    return motion_enabled(page->axis);
}

static double driven(const struct page *page)
{
    return !page->view.off && page->view.mode != LOOP_IDLE && page->view.mode != LOOP_FREE;
}

static int32_t target_counts(const struct page *page)
{
    return motion_target_counts(page->axis);
}

static double position_mm(const struct page *page)
{
    return coordinates_counts_to_mm(page->axis, page->view.position_counts);
}

static double target_mm(const struct page *page)
{
    return coordinates_counts_to_mm(page->axis, target_counts(page));
}

/* Counts from the user's origin, in the user's direction, so that they agree with the mm. */
static double position_enc(const struct page *page)
{
    return position_mm(page) * coordinates_counts_per_mm(page->axis);
}

static double target_enc(const struct page *page)
{
    return target_mm(page) * coordinates_counts_per_mm(page->axis);
}

static double error_counts(const struct page *page)
{
    return page->view.error_counts;
}

static double error_sum(const struct page *page)
{
    return settling_of(page->axis)->error_sum_counts;
}

static double settle_last_ms(const struct page *page)
{
    return settling_of(page->axis)->last_ms;
}

static double settle_mean_ms(const struct page *page)
{
    return settling_of(page->axis)->mean_ms;
}

static double duty_steps(const struct page *page)
{
    return page->view.duty_steps;
}

static double counts_per_mm(const struct page *page)
{
    return coordinates_counts_per_mm(page->axis);
}

static const char *axis_name(const struct page *page)
{
    static char name[2];

    name[0] = axis_letter(page->axis);
    return name;
}

static const char *profile(const struct page *page)
{
    (void)page;
    return "STANDARD";
}

static const char *input_device(const struct page *page)
{
    return joystick_device_name(page->axis);
}

static const char *command_state(const struct page *page)
{
    return motion_axis_busy(page->axis) ? "MOVE" : "NO_MOVE";
}

static const char *move_state(const struct page *page)
{
    static const char *const modes[] = {
        [LOOP_FREE] = "OFF", [LOOP_SPIN] = "SPIN", [LOOP_HOLD] = "HOLD", [LOOP_IDLE] = "IDLE", [LOOP_TRACK] = "CONSTANT",
        [LOOP_SETTLE] = "SETTLE", [LOOP_WAIT] = "PAUSE",
    };

    if (page->view.planned && page->view.ramping)
        return page->view.ramping_up ? "RAMP_UP" : "RAMP_DOWN";
    return modes[page->view.mode];
}

/* --- The page -------------------------------------------------------------------------------- */

/* Two to a line, after the first line. */
static const struct field fields[] = {
    {.label = "Input Device", .command = "JOYSTICK", .text = input_device},
    {.label = "Axis Profile", .text = profile},
    {.label = "Max Lim", .command = "SETUP", .decimals = 3, .unit = "mm"},
    {.label = "Min Lim", .command = "SETLOW", .decimals = 3, .unit = "mm"},
    {.label = "Ramp Time", .command = "ACCEL", .decimals = 2, .unit = "ms"},
    {.label = "Ramp Length", .number = ramp_counts, .unit = "enc"},
    {.label = "Run Speed", .command = "SPEED", .decimals = 5, .unit = "mm/s"},
    {.label = "vmax_enc*64", .number = vmax_enc_64},
    {.label = "Servo Lp Time", .number = loop_ms, .decimals = 2, .unit = "ms"},
    {.label = "Enc Polarity", .command = "EPOLARITY"},
    {.label = "dv_enc", .number = dv_enc},
    {.label = "LL Axis ID", .number = low_level_id},
    {.label = "Drift Error", .command = "ERROR", .decimals = 6, .unit = "mm"},
    {.label = "enc_drift_err", .number = drift_counts},
    {.label = "Finish Error", .command = "PCROS", .decimals = 6, .unit = "mm"},
    {.label = "enc_finsh_err", .number = finish_counts},
    {.label = "Backlash", .command = "BACKLASH", .decimals = 6, .unit = "mm"},
    {.label = "enc_backlash", .number = backlash_counts},
    {.label = "Overshoot", .command = "OVERSHOOT", .decimals = 6, .unit = "mm"},
    {.label = "enc_overshoot", .number = overshoot_counts},
    {.label = "Kp", .command = "KP"},
    {.label = "Ki(*16)", .command = "KI", .number = ki_16},
    {.label = "Kv", .command = "KV"},
    {.label = "Kd", .command = "KD"},
    {.label = "Ka", .command = "KADC"},
    {.label = "Kadc"},
    {.label = "Axis Enable", .command = "MOTCTRL", .number = enabled},
    {.label = "Motor Enable", .number = driven},
    {.label = "CMD_stat", .text = command_state},
    {.label = "Move_stat", .text = move_state},
    {.label = "Current pos", .number = position_mm, .decimals = 4, .unit = "mm"},
    {.label = "enc position", .number = position_enc},
    {.label = "Target pos", .number = target_mm, .decimals = 4, .unit = "mm"},
    {.label = "enc target", .number = target_enc},
    {.label = "enc pos error", .number = error_counts},
    {.label = "EEsum", .number = error_sum},
    {.label = "Lst Stle Time", .number = settle_last_ms, .unit = "ms"},
    {.label = "Av Settle Tim", .number = settle_mean_ms, .unit = "ms"},
    {.label = "Home position", .command = "SETHOME", .absent = 1000, .decimals = 2, .unit = "mm"},
    {.label = "Motor Signal", .number = duty_steps},
    {.label = "mm/sec/DAC_ct", .command = "DACK", .decimals = 5},
    {.label = "Enc Cnts/mm", .command = "CNTS", .decimals = 2, .number = counts_per_mm},
    {.label = "Wait Time", .command = "WAIT"},
    {.label = "Maintain code", .command = "MAINTAIN"},
};

enum { LINES = 1 + (int)(sizeof fields / sizeof fields[0]) / 2 };

_Static_assert(sizeof fields / sizeof fields[0] % 2 == 0, "two fields to a line");

static void print_label(struct reply *reply, const char *label, unsigned start)
{
    reply_text(reply, label);
    reply_pad_to(reply, start + LABEL);
    reply_char(reply, ':');
}

/* The command in brackets, then the unit at the right end of what both share. */
static void print_unit(struct reply *reply, const struct field *field, unsigned start)
{
    const struct command *command = field->command != NULL ? command_find(field->command) : NULL;
    const bool right = start != 0;
    size_t used = 0;

    if (command == NULL && (field->unit == NULL || right)) {
        if (field->unit != NULL) {
            reply_char(reply, ' ');
            reply_text(reply, field->unit);
        }
        return;
    }
    reply_char(reply, ' ');
    if (command != NULL) {
        const char *name = command->shortcut != NULL ? command->shortcut : command->name;

        reply_char(reply, '[');
        reply_text(reply, name);
        reply_char(reply, ']');
        while (name[used] != '\0')
            used++;
        used += 2;
    }
    if (field->unit != NULL)
        reply_text_right(reply, field->unit, (unsigned)(UNIT - used));
}

static void print_field(struct reply *reply, const struct page *page, const struct field *field,
                        unsigned start)
{
    print_label(reply, field->label, start);
    if (field->text != NULL)
        reply_text_right(reply, field->text(page), VALUE);
    else if (field->number != NULL)
        reply_number_right(reply, field->number(page), field->decimals, VALUE);
    else if (field->command != NULL)
        reply_number_right(reply, lookup_value(field->command, page->axis, field->absent),
                           field->decimals, VALUE);
    else
        reply_number_right(reply, field->absent, field->decimals, VALUE);
    print_unit(reply, field, start);
}

static void print_line(struct reply *reply, const struct page *page, unsigned line)
{
    if (line == 0) {
        reply_text(reply, "Axis Name Ch");
        reply_text(reply, axis_name(page));
        reply_char(reply, ':');
        reply_text_right(reply, axis_name(page), VALUE);
        reply_pad_to(reply, COLUMN);
        reply_text(reply, "Limits Status: ");
        reply_char(reply, status_limit_letter(page->axis));
        return;
    }
    print_field(reply, page, &fields[2 * (line - 1)], 0);
    reply_pad_to(reply, COLUMN);
    print_field(reply, page, &fields[2 * (line - 1) + 1], COLUMN);
}

/* The n-th fitted axis that the request names, in hardware order; false: it names fewer. */
static bool named_axis(const struct request *request, unsigned n, unsigned *axis)
{
    for (*axis = 0; *axis < AXIS_COUNT; (*axis)++)
        if (request_argument(request, axis_letter(*axis)) != NULL && n-- == 0)
            return true;
    return false;
}

/* `step` counts lines over all pages. */
static enum status info(const struct request *request, struct reply *reply)
{
    struct page page;

    if (!named_axis(request, reply->step / LINES, &page.axis))
        return STATUS_SILENT;
    axis_read(page.axis, &page.view);
    for (unsigned n = 0; n < LINES_AT_ONCE; n++) {
        unsigned next;

        print_line(reply, &page, reply->step % LINES);
        reply->step++;
        if (reply->step % LINES != 0) {
            reply_end_line(reply);
            continue;
        }
        if (!named_axis(request, reply->step / LINES, &next))
            return STATUS_OK;
        reply_end_line(reply);
        break;
    }
    return STATUS_PENDING;
}

static const struct command commands[] = {
    {
        .name = "INFO", .shortcut = "I", .run = info, .flags = COMMAND_NEEDS_ARGUMENT,
        .accepts = ARGUMENT_BARE, .letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZ",
        .summary = "A page of settings and state of each axis named; nothing for one not fitted.",
    },
    {0},
};

const struct module info_module = {
    .name = "info", .commands = commands, .init = settling_init, .poll = settling_poll,
};
