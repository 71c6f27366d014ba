/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/scan.h"

#include <stddef.h>
#include <string.h>

#include "modules/scan_roles.h"
#include "modules/scan_run.h"
#include "modules/scan_settings.h"

static struct scan_wish present(void)
{
    return (struct scan_wish){.fast = scan_settings_fast(), .slow = scan_settings_slow()};
}

static enum status interpret(const struct request *request, struct scan_wish *wish)
{
    *wish = present();

    const enum status status = scan_roles_read(request, scan_settings_roles_only(), wish);
    if (wish->action == SCAN_TOGGLE)
        wish->action = scan_run_state() == SCAN_IDLE ? SCAN_BEGIN : SCAN_END;
    if (wish->action == SCAN_BEGIN && scan_run_state() != SCAN_IDLE)
        wish->action = SCAN_NOTHING;
    return status;
}

/* Before anything changes: a scan that could not start refuses the whole line. */
static enum status check_scan(const struct request *request)
{
    struct scan_wish wish;
    struct scan_setup setup;
    enum status status = interpret(request, &wish);

    if (status != STATUS_OK || wish.action != SCAN_BEGIN)
        return status;
    status = scan_settings_setup(wish.fast, wish.slow, &setup);
    return status == STATUS_OK ? scan_run_check(&setup) : status;
}

static int role(int axis)
{
    return axis == scan_settings_fast() ? 1 : axis == scan_settings_slow() ? 2 : 0;
}

static void print_query(struct reply *reply, char letter)
{
    if (letter == 'X') {
        reply_char(reply, (char)scan_run_state());
        return;
    }
    if (letter == 'Y' || letter == 'Z') {
        reply_integer(reply, role(letter - 'X'));
        return;
    }
    for (const struct parameter *row = scan_settings_rows; row->command != NULL; row++)
        if (row->letter == letter && strcmp(row->command, "SCAN") == 0)
            reply_integer(reply, (int32_t)parameter_value(row, 0));
}

/* Values without letters, those of parameter rows that were asked too in their places. */
static void print_queries(const struct request *request, struct reply *reply)
{
    reply_clear(reply);
    reply_open(reply, FORM_VALUES);
    for (const char *letter = "XYZFTRMCW"; *letter != '\0'; letter++) {
        const struct argument *argument = request_argument(request, *letter);

        if (argument == NULL || argument->kind != ARGUMENT_QUERY)
            continue;
        reply_field(reply, *letter);
        print_query(reply, *letter);
    }
    reply_close(reply);
}

static enum status start(int fast, int slow)
{
    struct scan_setup setup;
    const enum status status = scan_settings_setup(fast, slow, &setup);

    return status == STATUS_OK ? scan_run_start(&setup) : status;
}

static enum status run_scan(const struct request *request, struct reply *reply)
{
    struct scan_wish wish;
    enum status status = interpret(request, &wish);

    if (status != STATUS_OK)
        return status;
    scan_settings_set_axes(wish.fast, wish.slow);
    if (wish.action == SCAN_END)
        scan_run_stop();
    if (wish.action == SCAN_BEGIN) {
        status = start(wish.fast, wish.slow);
        if (status != STATUS_OK)
            return status;
    }
    print_queries(request, reply);
    return STATUS_OK;
}

bool scan_start(void)
{
    return start(scan_settings_fast(), scan_settings_slow()) == STATUS_OK;
}

bool scan_running(void)
{
    return scan_run_state() != SCAN_IDLE;
}

void scan_trigger(void)
{
    (void)scan_start();
}

bool scan_stop(void)
{
    if (scan_run_state() == SCAN_IDLE)
        return false;
    scan_run_stop();
    return true;
}

static const struct command commands[] = {
    {
        .name = "SCAN", .shortcut = "SN", .form = FORM_VALUES,
        .accepts = ARGUMENT_BARE | ARGUMENT_VALUE | ARGUMENT_QUERY, .letters = "XYZSP",
        .check = check_scan, .run = run_scan,
        .summary = "Starts and stops a scan; X=1 Y=2 Z=0 names the fast, the slow and no axis.",
    },
    {
        .name = "SCANR", .shortcut = "NR", .form = FORM_P, .summary = "The line of a scan.",
    },
    {
        .name = "SCANV", .shortcut = "NV", .form = FORM_P,
        .summary = "The lines of a scan, and what is around them.",
    },
    {0},
};

static const char *const build_lines[] = {"SCAN MODULE", NULL};

const struct module scan_module = {
    .name = "scan", .commands = commands, .parameters = scan_settings_rows,
    .build_lines = build_lines,
    .init = scan_run_init, .poll = scan_run_poll,
};
