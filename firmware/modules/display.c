/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/display.h"

#include <stddef.h>
#include <string.h>

static char text[DISPLAY_COLUMNS + 1];
static bool inches;

const char *display_text(void)
{
    return text;
}

bool display_inches(void)
{
    return inches;
}

/* Anything but a text in quotes clears the line; LCD ? too, so this is no query. */
static enum status lcd(const struct request *request, struct reply *reply)
{
    (void)reply;
    memset(text, 0, sizeof text);
    if (request->text != NULL && request->text_closed)
        memcpy(text, request->text,
               request->text_length < DISPLAY_COLUMNS ? request->text_length : DISPLAY_COLUMNS);
    return STATUS_OK;
}

static enum status units(const struct request *request, struct reply *reply)
{
    (void)request;
    (void)reply;
    inches = !inches;
    return STATUS_OK;
}

static void init(void)
{
    memset(text, 0, sizeof text);
    inches = false;
}

static const struct command commands[] = {
    {
        .name = "LCD", .flags = COMMAND_TAKES_TEXT, .run = lcd, .letters = LETTERS_ALL,
        .accepts = ARGUMENT_BARE | ARGUMENT_VALUE | ARGUMENT_QUERY | ARGUMENT_PLUS | ARGUMENT_MINUS,
        .summary = "Text in double quotes for the bottom line of the display; without it, clear.",
    },
    {
        .name = "UNITS", .shortcut = "UN", .run = units,
        .summary = "Switch the display between mm and inches.",
    },
    {0},
};

const struct module display_module = {
    .name = "display", .commands = commands, .init = init,
};
