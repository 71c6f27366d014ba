/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Random bytes through line, parser and dispatcher, under sanitizers. Claims: the console never
 * stops, every reply is one of the language, and the next good command works. Fixed seeds.
 */
#include <stdint.h>
#include <stdlib.h>

#include "check.h"
#include "core/events.h"
#include "modules/identity.h"
#include "modules/settings.h"
#include "port.h"
#include "random.h"
#include "sample.h"

static const struct module *const modules[] = {&identity_module, &settings_module, &sample_module,
                                               NULL};

/* Every line of the output ends in CR LF and begins as a reply can. */
static bool is_language(const char *text)
{
    while (*text != '\0') {
        const char *end = strstr(text, "\r\n");

        if (end == NULL)
            return false;
        bool error = text[0] == ':' && text[1] == 'N' && text[2] == '-';
        bool known = strncmp(text, ":A ", 3) == 0 || (text[0] == ':' && text[2] == '=') ||
                     text[1] == '=' || strchr("NBlAJFMSOD", text[0]) != NULL || error;

        for (const char *at = text; at < end; at++)
            if ((*at < ' ' && *at != '\r') || *at > '~')
                return false;
        if (!known)
            return false;
        text = end + 2;
    }
    return true;
}

static bool works_again(void)
{
    (void)port_bytes("\r\377A\r", 4); /* may end a line of noise */
    return strcmp(port_send("G X=3 Y=4"), ":A \r\n") == 0 &&
           strcmp(port_send("G X? Y?"), ":X=3 Y=4 A\r\n") == 0;
}

TEST(survives_a_million_random_bytes)
{
    port_start(modules);
    random_state = 0x41626265;
    for (int block = 0; block < 100; block++) {
        for (int i = 0; i < 10000; i += 50) {
            uint8_t bytes[50];

            for (int k = 0; k < 50; k++)
                bytes[k] = (uint8_t)random_below(256);
            const char *reply = port_bytes(bytes, sizeof bytes);

            if (!is_language(reply))
                CHECK_FAIL("block %d, byte %d: \"%s\"", block, i, reply);
        }
        if (!works_again())
            CHECK_FAIL("the good command after block %d failed", block);
    }
}

/* Noise made of pieces of the language goes deeper than white noise. */
TEST(survives_a_million_bytes_of_broken_commands)
{
    static const char *const pieces[] = {
        "L", "G", "LEVEL", "TINT", "FENCE", "OFFSET", "W", "WHERE", "LAMP", "HALT", "\\", "/", "V",
        "BU X", "N", "CD", "SS", "VB", "STORY", "FAIL", "FLOOD", "SILENT", " ", " ", " ", "X", "Y",
        "Z", "F", "R", "T", "S", "P", "=", "=", "?", "?", "+", "-", "1", "0", "9", ".", "e", "E-",
        "1e308", "99999999999999999999", "-0.0", "0.0000001", "\"", "\r", "\r", "\r", "\n", "\b",
        "\033", "\377", "\377A", "\377T", "\377H", "VX=4.69", "XYZ", "=0", "\\r",
    };
    unsigned long total = 0;

    port_start(modules);
    random_state = 20260101;
    for (unsigned round = 0; total < 1000000; round++) {
        char text[256] = "";

        for (uint32_t n = 1 + random_below(16); n > 0; n--)
            strcat(text, pieces[random_below(sizeof pieces / sizeof *pieces)]);
        total += strlen(text);
        const char *reply = port_text(text);

        if (!is_language(reply))
            CHECK_FAIL("round %u: \"%s\" gives \"%s\"", round, text, reply);
        if (round % 1000 == 0 && !works_again())
            CHECK_FAIL("the good command after round %u failed", round);
    }
    CHECK(works_again());
}

/* One reply for each line that is not empty, whatever is in it. */
TEST(answers_every_line_exactly_once)
{
    port_start(modules);
    random_state = 7;
    for (unsigned round = 0; round < 20000; round++) {
        char text[200];
        uint32_t length = 1 + random_below(140);
        unsigned replies = 0;

        for (uint32_t i = 0; i < length; i++)
            text[i] = (char)('!' + random_below(94));
        text[length] = '\0';
        if (text[0] == '\\')
            text[0] = 'x';
        for (const char *at = port_send(text); (at = strstr(at, "\r\n")) != NULL; at += 2)
            replies++;
        if (replies != 1)
            CHECK_FAIL("round %u: %u replies to \"%s\"", round, replies, text);
    }
}

TEST_MAIN(RUN(survives_a_million_random_bytes); RUN(survives_a_million_bytes_of_broken_commands);
          RUN(answers_every_line_exactly_once))
