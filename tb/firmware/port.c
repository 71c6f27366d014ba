/* SPDX-License-Identifier: BSD-2-Clause */
#include "port.h"

#include <string.h>

#include "core/events.h"
#include "core/fault.h"
#include "core/module.h"
#include "core/settings.h"
#include "dialect.h"

enum { OUTPUT = 8192, TURNS_MAX = 1000000 };

struct console port_console;

RING_DEFINE(receive, 2048);
RING_DEFINE(transmit, 256);

static char output[OUTPUT];
static size_t output_length;
static bool held;

void port_start(const struct module *const *modules)
{
    ring_clear(&receive);
    ring_clear(&transmit);
    held = false;
    (void)command_init(modules);
    (void)events_init(modules);
    fault_clear();
    settings_load();
    for (; *modules != NULL; modules++)
        if ((*modules)->init != NULL)
            (*modules)->init();
    console_init(&port_console, &receive, &transmit, NULL);
}

static void collect(size_t count)
{
    uint8_t byte;

    for (; count > 0 && output_length < OUTPUT - 1 && ring_take(&transmit, &byte); count--)
        output[output_length++] = (char)byte;
    output[output_length] = '\0';
}

static void turn(void)
{
    console_poll(&port_console);
    fault_poll();
    events_poll();
    settings_poll();
    if (!held)
        collect(OUTPUT);
}

static void settle(void)
{
    for (int turns = 0;
         turns < 2 || (!held && !console_idle(&port_console) && turns < TURNS_MAX); turns++)
        turn();
}

const char *port_bytes(const void *bytes, size_t length)
{
    output_length = 0;
    output[0] = '\0';
    for (size_t i = 0; i < length; i++) {
        ring_put(&receive, ((const uint8_t *)bytes)[i]);
        turn();
    }
    settle();
    return output;
}

const char *port_text(const char *text)
{
    return port_bytes(text, strlen(text));
}

const char *port_send(const char *line)
{
    char text[1100];

    return port_bytes(text, dialect_write(line, text, sizeof text));
}

const char *port_drain(void)
{
    return port_bytes("", 0);
}

void port_queue(const char *text)
{
    while (*text != '\0')
        ring_put(&receive, (uint8_t)*text++);
}

void port_hold(void)
{
    held = true;
}

const char *port_take(size_t count)
{
    output_length = 0;
    turn();
    collect(count);
    return output;
}
