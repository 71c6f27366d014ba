/* SPDX-License-Identifier: BSD-2-Clause */
/* modules/identity and modules/settings: what hosts read out of the replies, to the byte. */
#include "modules/identity.h"
#include "modules/settings.h"

#include <regex.h>

#include "boot/handover.h"
#include "check.h"
#include "host/mmio.h"
#include "port.h"
#include "regs.h"
#include "sample.h"

static const struct module *const modules[] = {&identity_module, &settings_module, &sample_module,
                                               NULL};

static bool matches(const char *text, const char *pattern)
{
    regex_t regex;

    if (regcomp(&regex, pattern, REG_EXTENDED | REG_NOSUB) != 0)
        return false;
    bool found = regexec(&regex, text, 0, NULL, 0) == 0;
    regfree(&regex);
    return found;
}

TEST(version_starts_at_offset_sixteen_and_ends_at_a_blank)
{
    port_start(modules);
    CHECK_TEXT(port_send("V"), ":A Version: USB-9.2k \r\n");
    CHECK(strncmp(port_send("VERSION") + 16, "9.2k ", 5) == 0);
}

TEST(version_reported_is_a_setting)
{
    port_start(modules);
    CHECK_TEXT(port_send("V X=5 Z=53"), ":A \r\n");
    CHECK_TEXT(port_send("V"), ":A Version: USB-9.55 \r\n");
    CHECK_TEXT(port_send("V X? Z?"), ":A X=5 Z=53\r\n");
    CHECK_TEXT(port_send("V X=10"), ":N-4\r\n");
    CHECK_TEXT(port_send("V Z=64"), ":N-4\r\n"); /* no digit or small letter */
    CHECK_TEXT(port_send("V T"), ":A v9.55\r\n"); /* whatever is reported */
    CHECK_TEXT(port_send("V Q"), ":N-2\r\n");
}

TEST(who_names_us_and_our_axes)
{
    char pattern[64];

    port_start(modules);
    snprintf(pattern, sizeof pattern, "^:A ASI-MS2000-%.*s-Abbe-[^ ]+\r\n$", AXIS_COUNT,
             AXIS_LETTERS);
    CHECK(matches(port_send("N"), pattern));
    CHECK(matches(port_send("WHO"), pattern));
}

TEST(date_is_month_day_year_and_time)
{
    port_start(modules);
    CHECK(matches(port_send("CD"), "^[A-Z][a-z]{2} [ 0-9][0-9] 20[0-9]{2}:[0-9:]{8}\r\n$"));
}

TEST(build_is_one_line_and_build_x_lists_axes_and_modules)
{
    port_start(modules);
    CHECK_TEXT(port_send("BU"), "ABBE_XYZF\r\n");
    mmio_model_set(REG_WATCHDOG_SCRATCH, handover_started(1, -1));
    CHECK_TEXT(port_send("bu x"), "ABBE_XYZF\rMotor Axes: X Y Z F  \rCMDs: XYZFTR\rBootLdr V:1\r"
                                  "Hdwr REV.A\rSAMPLE MODULE\r\n");
    mmio_model_set(REG_WATCHDOG_SCRATCH, 0); /* no boot program started this */
    CHECK_TEXT(port_send("bu x"), "ABBE_XYZF\rMotor Axes: X Y Z F  \rCMDs: XYZFTR\rBootLdr V:0\r"
                                  "Hdwr REV.A\rSAMPLE MODULE\r\n");
    CHECK_TEXT(port_send("BU Q"), ":N-2\r\n");
}

TEST(bu_y_keeps_a_text_of_twenty_characters)
{
    port_start(modules);
    CHECK_TEXT(port_send("BU Y?"), ":A \r\n");
    CHECK_TEXT(port_send("BU Y=31"), ":N-4\r\n");
    CHECK_TEXT(port_send("BU Y=127"), ":N-4\r\n");
    for (int n = 0; n < 20; n++) {
        char line[20];

        snprintf(line, sizeof line, "BU Y=%d", n == 7 ? 126 : 'a' + n);
        CHECK_TEXT(port_send(line), ":A \r\n");
    }
    CHECK_TEXT(port_send("BU Y=97"), ":N-5\r\n");
    CHECK_TEXT(port_send("bu y?"), ":A abcdefg~ijklmnopqrst\r\n");
    CHECK_TEXT(port_send("SS Z"), ":A \r\n");
    CHECK_TEXT(port_send("BU Y-"), ":A \r\n");
    CHECK_TEXT(port_send("BU Y?"), ":A \r\n");
    port_start(modules);
    CHECK_TEXT(port_send("BU Y?"), ":A abcdefg~ijklmnopqrst\r\n");
    CHECK_TEXT(port_send("BU Y+"), ":N-4\r\n");
    CHECK_TEXT(port_send("BU X Y?"), ":N-4\r\n");
    CHECK_TEXT(port_send("BU X?"), ":N-4\r\n");
}

TEST(bu_z_counts_and_wraps_and_is_forgotten)
{
    port_start(modules);
    CHECK_TEXT(port_send("BU Z?"), ":A 0\r\n");
    CHECK_TEXT(port_send("BU Z-"), ":A \r\n");
    CHECK_TEXT(port_send("BU Z?"), ":A 65535\r\n");
    CHECK_TEXT(port_send("BU Z+"), ":A \r\n");
    CHECK_TEXT(port_send("BU Z=12 "), ":A \r\n");
    CHECK_TEXT(port_send("BU Z+"), ":A \r\n");
    CHECK_TEXT(port_send("BU Z?"), ":A 13\r\n");
    CHECK_TEXT(port_send("BU Z=65536"), ":N-4\r\n");
    CHECK_TEXT(port_send("SS Z"), ":A \r\n");
    port_start(modules);
    CHECK_TEXT(port_send("BU Z?"), ":A 0\r\n");
}

TEST(build_x_comes_whole_through_a_port_that_takes_a_byte_at_a_time)
{
    static const char expected[] = "ABBE_XYZF\rMotor Axes: X Y Z F  \rCMDs: XYZFTR\rBootLdr V:0\r"
                                   "Hdwr REV.A\rSAMPLE MODULE\r\nN\r\n";
    char all[300] = "";

    port_start(modules);
    port_hold();
    port_queue("BU X\rLAMP\r");
    for (int i = 0; i < 250 && strlen(all) < 200; i++)
        strcat(all, port_take(1));
    CHECK_TEXT(all, expected);
}

TEST(saveset_saves_restores_and_goes_back_to_factory)
{
    port_start(modules);
    CHECK_TEXT(port_send("G X=41"), ":A \r\n");
    CHECK_TEXT(port_send("SS Z"), ":A \r\n");
    CHECK_TEXT(port_send("SS X"), ":A \r\n");
    port_start(modules);
    CHECK_TEXT(port_send("G X?"), ":X=50 A\r\n");
    CHECK_TEXT(port_send("ss y"), ":A \r\n");
    CHECK_TEXT(port_send("G X?"), ":X=41 A\r\n");
}

TEST(saveset_refuses_other_letters)
{
    port_start(modules);
    CHECK_TEXT(port_send("SS"), ":N-3\r\n");
    CHECK_TEXT(port_send("SS Q"), ":N-4\r\n");
    CHECK_TEXT(port_send("SS X Z"), ":N-4\r\n");
    CHECK_TEXT(port_send("SS Z=1"), ":N-4\r\n");
}

TEST_MAIN(RUN(version_starts_at_offset_sixteen_and_ends_at_a_blank);
          RUN(version_reported_is_a_setting); RUN(who_names_us_and_our_axes);
          RUN(date_is_month_day_year_and_time);
          RUN(bu_y_keeps_a_text_of_twenty_characters);
          RUN(bu_z_counts_and_wraps_and_is_forgotten);
          RUN(build_is_one_line_and_build_x_lists_axes_and_modules);
          RUN(build_x_comes_whole_through_a_port_that_takes_a_byte_at_a_time);
          RUN(saveset_saves_restores_and_goes_back_to_factory);
          RUN(saveset_refuses_other_letters))
