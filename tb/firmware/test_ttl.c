/* SPDX-License-Identifier: BSD-2-Clause */
/* TTL and the outputs, down to the routes of the pins. */
#include "check.h"

#include "host/mmio.h"
#include "modules/pins.h"
#include "modules/ttl_in.h"
#include "port.h"
#include "regs.h"
#include "stage.h"

#define ACKNOWLEDGED ":A \r\n"
#define SEND(text, reply) CHECK_TEXT(port_send(text), reply)

enum source { LOW, HIGH, LINE, PIXEL, DIRECT }; /* as docs/registers.md numbers them */

/* A route: its source, and 16 more when it is inverted. */
static uint32_t route(uintptr_t address)
{
    const uint32_t value = mmio_model_get(address);
    const uint32_t source =
        (value & REG_ROUTER_OUT0_SOURCE_MASK) >> REG_ROUTER_OUT0_SOURCE_SHIFT;

    return source + ((value & REG_ROUTER_OUT0_INVERT_MASK) != 0 ? 16 : 0);
}

#define ROUTES(out0, encoder)                                                                      \
    do {                                                                                           \
        CHECK_INT(route(REG_ROUTER_OUT0), out0);                                                   \
        CHECK_INT(route(REG_ROUTER_ENCODER), encoder);                                             \
    } while (0)

TEST(queries_name_their_letters)
{
    stage_start();
    SEND("TTL X?", ":A X=0\r\n");
    SEND("TTL X? Y? F?", ":A X=0 Y=1 F=1\r\n");
    SEND("ttl  x=1 y=0  f=-1", ACKNOWLEDGED);
    SEND("TTL F? Y? X?", ":A X=1 Y=0 F=-1\r\n");
}

TEST(bare_ttl_tells_the_level_of_the_pin)
{
    stage_start();
    SEND("TTL", ":A 1\r\n");
    SEND("TTL Y=0", ACKNOWLEDGED);
    SEND("TTL", ":A 0\r\n");
    SEND("TTL F=-1", ACKNOWLEDGED);
    SEND("TTL", ":A 1\r\n");
    SEND("TTL Y=1", ACKNOWLEDGED);
    SEND("TTL", ":A 0\r\n");
}

TEST(level_and_polarity_reach_the_pins)
{
    stage_start();
    ROUTES(HIGH, PIXEL);
    SEND("TTL Y=0", ACKNOWLEDGED);
    ROUTES(LOW, PIXEL);
    SEND("TTL F=-1", ACKNOWLEDGED);
    ROUTES(LOW + 16, PIXEL + 16);
    SEND("TTL Y=1", ACKNOWLEDGED);
    ROUTES(HIGH + 16, PIXEL + 16);
    SEND("TTL F=1", ACKNOWLEDGED);
    ROUTES(HIGH, PIXEL);
}

TEST(raw_channel_is_never_inverted)
{
    stage_start();
    SEND("SCANR M=1", ACKNOWLEDGED);
    ROUTES(HIGH, DIRECT);
    SEND("TTL F=-1", ACKNOWLEDGED);
    ROUTES(HIGH + 16, DIRECT);
    SEND("SCANR M=0", ACKNOWLEDGED);
    ROUTES(HIGH + 16, PIXEL + 16);
}

TEST(out0_shows_encoder_as_the_original_is_wired)
{
    stage_start();
    SEND("SCAN W=1", ACKNOWLEDGED);
    ROUTES(PIXEL, PIXEL);
    SEND("TTL Y=0", ACKNOWLEDGED); /* has no pin now */
    ROUTES(PIXEL, PIXEL);
    SEND("TTL F=-1", ACKNOWLEDGED);
    ROUTES(PIXEL + 16, PIXEL + 16);
    SEND("SCANR M=1", ACKNOWLEDGED);
    ROUTES(DIRECT, DIRECT);
    SEND("SCAN W=0", ACKNOWLEDGED);
    ROUTES(LOW + 16, DIRECT);
}

TEST(raw_channel_is_that_of_the_fast_axis_or_as_jumpered)
{
    stage_start();
    CHECK_INT(mmio_model_get(REG_DIVIDER_AXIS), 0);
    SEND("SCAN X=2 Y=1 Z=0", ACKNOWLEDGED);
    CHECK_INT(mmio_model_get(REG_DIVIDER_AXIS), 1);
    SEND("SCANV M=3", ACKNOWLEDGED);
    CHECK_INT(mmio_model_get(REG_DIVIDER_AXIS), 2);
    SEND("SCAN X=1 Y=2 Z=0", ACKNOWLEDGED);
    CHECK_INT(mmio_model_get(REG_DIVIDER_AXIS), 2);
    SEND("SCANV M=0", ACKNOWLEDGED);
    CHECK_INT(mmio_model_get(REG_DIVIDER_AXIS), 0);
}

/* Which TTL lines BUILD X has. */
static unsigned names(void)
{
    const char *text = port_send("BU X");

    return (strstr(text, "\rIN0_INT") != NULL ? 1u : 0) + (strstr(text, "\rENC_INT") != NULL ? 2u : 0) +
           (strstr(text, "\rTTL_REPORT_INT") != NULL ? 4u : 0);
}

/* The modes of the input in a profile, and those in which a scan has pixel pulses. */
static void modes(const char *profile, uint32_t *valid, uint32_t *pixels)
{
    char line[20];

    *valid = *pixels = 0;
    SEND(profile, ACKNOWLEDGED);
    for (int mode = 0; mode < 32; mode++) {
        snprintf(line, sizeof line, "TTL X=%d", mode);
        if (strcmp(port_send(line), ACKNOWLEDGED) != 0)
            continue;
        *valid |= 1u << mode;
        if (pins_pixels_enabled())
            *pixels |= 1u << mode;
    }
    SEND("TTL X=0", ACKNOWLEDGED);
}

TEST(a_profile_has_the_modes_and_the_names_of_a_build)
{
    uint32_t valid, pixels;

    stage_start();
    modes("BU F=0", &valid, &pixels);
    CHECK_INT(valid & 0x1477, 0x1477); /* 0 1 2 4 5 6 10 12 */
    CHECK_INT(pixels & 0x1477, 0x42);  /* 1 6 */
    CHECK_INT(names(), 3);
    modes("BU F=1", &valid, &pixels);
    CHECK_INT(valid & 0x1477, 0x1477);
    CHECK_INT(pixels, 0);
    CHECK_INT(names(), 1);
    modes("BU F=2", &valid, &pixels);
    CHECK_INT(valid, 0x03);
    CHECK_INT(pixels, 0x02);
    CHECK_INT(names(), 2);
    SEND("BU F=3", ACKNOWLEDGED);
    CHECK_INT(names(), 4);
    SEND("BU F=4", ":N-4\r\n");
}

TEST(a_profile_is_saved_and_ends_a_mode_that_it_lacks)
{
    stage_start();
    SEND("TTL X=4", ACKNOWLEDGED);
    SEND("BU F=1", ACKNOWLEDGED);
    SEND("TTL X?", ":A X=4\r\n");
    SEND("BU F=2", ACKNOWLEDGED);
    SEND("TTL X?", ":A X=0\r\n");
    SEND("TTL X=4", ":N-4\r\n");
    SEND("TTL X=1", ACKNOWLEDGED);
    SEND("SS Z", ACKNOWLEDGED);
    stage_start();
    SEND("BU F?", ":A 2\r\n");
    SEND("TTL X?", ":A X=1\r\n");
    CHECK(pins_pixels_enabled());
    SEND("BU F=0", ACKNOWLEDGED);
    SEND("TTL X=0", ACKNOWLEDGED);
    SEND("SS Z", ACKNOWLEDGED);
}

TEST(a_module_may_take_the_input_and_gives_it_back)
{
    stage_start();
    SEND("TTL X=1", ACKNOWLEDGED);
    ttl_in_force(10);
    SEND("TTL X?", ":A X=10\r\n");
    CHECK(!pins_pixels_enabled());
    SEND("RM", ACKNOWLEDGED); /* toggles OUT0 */
    SEND("TTL", ":A 0\r\n");
    SEND("SS Z", ACKNOWLEDGED); /* keeps what the user set */
    SEND("TTL X=6", ACKNOWLEDGED);
    SEND("TTL X?", ":A X=10\r\n");
    ttl_in_restore();
    SEND("TTL X?", ":A X=6\r\n");
    CHECK(pins_pixels_enabled());
    ttl_in_restore();
    SEND("TTL X?", ":A X=6\r\n");
    stage_start();
    SEND("TTL X?", ":A X=1\r\n");
    SEND("TTL X=0", ACKNOWLEDGED);
    SEND("SS Z", ACKNOWLEDGED);
}

TEST(modes_that_are_not_built_are_refused)
{
    stage_start();
    SEND("TTL X=3", ":N-4\r\n");
    SEND("TTL X=-1", ":N-4\r\n");
    SEND("TTL X=99", ":N-4\r\n");
    SEND("TTL Y=7", ":N-4\r\n");
    SEND("TTL Y=-1", ":N-4\r\n");
    SEND("TTL Y=1 40", ":N-2\r\n");
    SEND("TTL F=0", ":N-4\r\n");
    SEND("TTL F=2", ":N-4\r\n");
    SEND("TTL Q=1", ":N-2\r\n");
    SEND("TTL Y=0 X=7", ":N-4\r\n"); /* all or nothing */
    SEND("TTL X? Y? F?", ":A X=0 Y=1 F=1\r\n");
    ROUTES(HIGH, PIXEL);
}

TEST_MAIN(RUN(queries_name_their_letters); RUN(bare_ttl_tells_the_level_of_the_pin);
          RUN(level_and_polarity_reach_the_pins); RUN(raw_channel_is_never_inverted);
          RUN(out0_shows_encoder_as_the_original_is_wired);
          RUN(raw_channel_is_that_of_the_fast_axis_or_as_jumpered);
          RUN(a_profile_has_the_modes_and_the_names_of_a_build);
          RUN(a_profile_is_saved_and_ends_a_mode_that_it_lacks);
          RUN(a_module_may_take_the_input_and_gives_it_back);
          RUN(modes_that_are_not_built_are_refused))
