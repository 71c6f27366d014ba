/* SPDX-License-Identifier: BSD-2-Clause */
/* The page of INFO: to the letter at rest, true in motion, in columns, and in parts. */
#include "check.h"

#include <stdlib.h>

#include "modules/motion.h"
#include "port.h"
#include "stage.h"

#define ACKNOWLEDGED ":A \r\n"
#define SEND(text, reply) CHECK_TEXT(port_send(text), reply)

/* Pages are long: tell where they part. */
#define SEND_FOR_PAGE(text, expected)                                                              \
    do {                                                                                           \
        const char *got = port_send(text), *wanted = (expected);                                   \
        size_t at = 0;                                                                             \
        while (got[at] == wanted[at] && got[at] != '\0')                                           \
            at++;                                                                                  \
        if (got[at] != wanted[at])                                                                 \
            CHECK_FAIL("%s: \"%.60s\", not \"%.60s\"", text, got + at, wanted + at);               \
    } while (0)

/* The value that follows a label in a page, or an impossible one. */
static double value(const char *page, const char *label)
{
    const char *at = strstr(page, label);

    return at != NULL && strchr(at, ':') != NULL ? strtod(strchr(at, ':') + 1, NULL) : -1e30;
}

/* Fitted axes have the same settings after power-up; name and number differ. */
static const char *page_at_rest(char letter, int id)
{
    const char *device = letter == 'X' ? "JS_X" : letter == 'Y' ? "JS_Y"
                         : letter == 'Z' ? "KNOB" : "F_WHEEL";
    static char text[4096];

    snprintf(text, sizeof text,
             "Axis Name Ch%c:         %c         Limits Status:  \r"
             "Input Device :%10s [J]     Axis Profile :  STANDARD\r"
             "Max Lim      :   110.000 [SU] mm Min Lim      :  -110.000 [SL] mm\r"
             "Ramp Time    :     50.00 [AC] ms Ramp Length  :     10341 enc\r"
             "Run Speed    :   4.55600 [S]mm/s vmax_enc*64  :      1324\r"
             "Servo Lp Time:      0.10      ms Enc Polarity :         1 [EP]\r"
             "dv_enc       :         3         LL Axis ID   :        %d\r"
             "Drift Error  :  0.000400 [E]  mm enc_drift_err:        18\r"
             "Finish Error :  0.000022 [PC] mm enc_finsh_err:         0\r"
             "Backlash     :  0.000000 [B]  mm enc_backlash :         0\r"
             "Overshoot    :  0.000000 [OS] mm enc_overshoot:         0\r"
             "Kp           :       800 [KP]    Ki(*16)      :      2400 [KI]\r"
             "Kv           :       106 [KV]    Kd           :       400 [KD]\r"
             "Ka           :        93 [KA]    Kadc         :         0\r"
             "Axis Enable  :         1 [MC]    Motor Enable :         0\r"
             "CMD_stat     :   NO_MOVE         Move_stat    :      IDLE\r"
             "Current pos  :    0.0000      mm enc position :         0\r"
             "Target pos   :    0.0000      mm enc target   :         0\r"
             "enc pos error:         0         EEsum        :         0\r"
             "Lst Stle Time:         0      ms Av Settle Tim:         0 ms\r"
             "Home position:   1000.00 [HM] mm Motor Signal :         0\r"
             "mm/sec/DAC_ct:   0.06494 [D]     Enc Cnts/mm  :  45396.00 [C]\r"
             "Wait Time    :         0 [WT]    Maintain code:         0 [MA]",
             letter, letter, device, id);
    return text;
}

TEST(page_is_as_documented)
{
    char expected[4200];

    stage_start();
    snprintf(expected, sizeof expected, "%s\r\n", page_at_rest('X', 24));
    SEND_FOR_PAGE("INFO X", expected);
    snprintf(expected, sizeof expected, "%s\r\n", page_at_rest('F', 27));
    SEND_FOR_PAGE("i f", expected);
}

TEST(several_axes_give_several_pages_in_hardware_order)
{
    static char expected[8400];
    size_t length;

    stage_start();
    length = (size_t)snprintf(expected, sizeof expected, "%s\r", page_at_rest('X', 24));
    snprintf(expected + length, sizeof expected - length, "%s\r\n", page_at_rest('Z', 26));
    SEND_FOR_PAGE("INFO Z X", expected);
    SEND_FOR_PAGE("INFO ZX", expected);
}

TEST(axes_not_fitted_are_passed_over_in_silence)
{
    char expected[4200];

    stage_start();
    SEND("INFO T", "");
    SEND("INFO A B", "");
    snprintf(expected, sizeof expected, "%s\r\n", page_at_rest('Y', 25));
    SEND_FOR_PAGE("INFO T Y", expected);
    SEND("/", "N\r\n");
}

TEST(wrong_forms_are_refused)
{
    stage_start();
    SEND("INFO", ":N-3\r\n");
    SEND("INFO X=1", ":N-4\r\n");
    SEND("INFO 5", ":N-2\r\n");
}

/* Hosts cut at column 33 and ask for each command they find in brackets. */
TEST(columns_hold_and_every_command_named_answers)
{
    static char page[4200];
    unsigned commands = 0;

    stage_start();
    strcpy(page, port_send("INFO X"));
    for (char *line = page; *line != '\0' && *line != '\n';) {
        char *end = strchr(line, '\r');

        CHECK(end != NULL && end - line > 33);
        CHECK_INT(line[13], ':');
        CHECK_INT(line[32], ' ');
        CHECK_INT(line[33 + 13], ':');
        for (char *at = line; at < end; at++) {
            char name[8], query[16];

            if (*at != '[' || sscanf(at, "[%7[A-Z]]", name) != 1)
                continue;
            snprintf(query, sizeof query, "%s X?", name);
            CHECK(strncmp(port_send(query), ":N", 2) != 0);
            commands++;
        }
        line = end + 1;
    }
    CHECK_INT(commands, 21);
}

TEST(page_is_true_in_motion)
{
    static char page[4200];

    stage_start();
    SEND("S X=2", ACKNOWLEDGED);
    SEND("M X=10000", ACKNOWLEDGED);
    for (int n = 0; n < 100; n++)
        stage_tick();
    strcpy(page, port_send("I X"));
    CHECK(strstr(page, "CMD_stat     :      MOVE         Move_stat    :   RAMP_UP\r") != NULL);
    for (int n = 0; n < 1000; n++)
        stage_tick();
    strcpy(page, port_send("I X"));
    CHECK(strstr(page, "CMD_stat     :      MOVE         Move_stat    :  CONSTANT\r") != NULL);
    CHECK_INT(value(page, "Motor Enable"), 1);
    CHECK_INT(value(page, "enc position"), motion_position_counts(0));
    CHECK(abs((int)(value(page, "Current pos") * 45396) - motion_position_counts(0)) <= 5);
    CHECK_INT(value(page, "enc target"), 45396);
    CHECK(value(page, "Run Speed") == 2);
    CHECK_INT(value(page, "vmax_enc*64"), 581); /* 2 * 45396 * 0.0001 * 64 = 581.07 */
    CHECK_INT(value(page, "Ramp Length"), 4540); /* 2 * 45396 * 0.05 = 4539.6 */
}

TEST(positions_are_in_the_users_frame)
{
    static char page[4200];

    stage_start();
    SEND("UM X=-10000", ACKNOWLEDGED);
    SEND("H X=5000", ACKNOWLEDGED);
    SEND("M X=15000", ACKNOWLEDGED);
    CHECK(stage_run(50000) > 0);
    CHECK_INT(stage_position[0], -45396);
    strcpy(page, port_send("I X"));
    CHECK(value(page, "Current pos") == 1.5);
    CHECK_INT(value(page, "enc position"), 68094);
    CHECK_INT(value(page, "enc target"), 68094);
}

TEST(disabled_axis_shows_it)
{
    static char page[4200];

    stage_start();
    SEND("MC X-", ACKNOWLEDGED);
    for (int n = 0; n < 3; n++)
        stage_tick();
    strcpy(page, port_send("I X"));
    CHECK(strstr(page, "Limits Status: D\r") != NULL);
    CHECK(strstr(page, "Move_stat    :       OFF\r") != NULL);
    CHECK_INT(value(page, "Axis Enable"), 0);
}

TEST(settling_times_are_measured)
{
    static char page[4200];

    stage_start();
    SEND("WT X=20", ACKNOWLEDGED);
    SEND("M X=10", ACKNOWLEDGED);
    CHECK(stage_run(50000) > 0);
    for (unsigned n = 0; n < AXIS_COUNT; n++)
        stage_tick();
    strcpy(page, port_send("I X"));
    /* A perfect stage: the loop's own delays, a few ms, and the pause. */
    CHECK(value(page, "Lst Stle Time") >= 20 && value(page, "Lst Stle Time") <= 26);
    CHECK(value(page, "Av Settle Tim") == value(page, "Lst Stle Time"));
    SEND("WT X=0", ACKNOWLEDGED);
    SEND("M X=20", ACKNOWLEDGED);
    CHECK(stage_run(50000) > 0);
    for (unsigned n = 0; n < AXIS_COUNT; n++)
        stage_tick();
    strcpy(page, port_send("I X"));
    CHECK(value(page, "Lst Stle Time") >= 1 && value(page, "Lst Stle Time") <= 6);
    CHECK(value(page, "Av Settle Tim") > value(page, "Lst Stle Time"));
}

TEST(acceleration_gain_is_a_setting_and_shown)
{
    stage_start();
    CHECK_TEXT(port_send("KA X? Y?"), ":A X=93 Y=93\r\n");
    CHECK_TEXT(port_send("KADC X=40.9"), ":A \r\n");
    CHECK_TEXT(port_send("KA X=-1"), ":N-4\r\n");
    CHECK_INT(value(port_send("INFO X"), "Ka  "), 40);
    CHECK_TEXT(port_send("SS Z"), ":A \r\n");
    stage_start();
    CHECK_TEXT(port_send("KA X? Y?"), ":A X=40 Y=93\r\n");
}

TEST(slow_port_gets_the_same_bytes)
{
    static char whole[8400], parts[8400];
    size_t length = 0;

    stage_start();
    strcpy(whole, port_send("INFO XYZF"));
    CHECK(strlen(whole) > 4 * 1300);
    port_hold();
    port_queue("INFO XYZF\r/\r");
    for (int n = 0; n < 4000; n++) {
        const char *part = port_take(3);

        CHECK(length + strlen(part) < sizeof parts);
        strcpy(parts + length, part);
        length += strlen(part);
    }
    CHECK_INT(strlen(parts), strlen(whole) + 3);
    CHECK(strncmp(parts, whole, strlen(whole)) == 0);
    CHECK_TEXT(parts + strlen(whole), "N\r\n");
}

TEST_MAIN(RUN(page_is_as_documented); RUN(several_axes_give_several_pages_in_hardware_order);
          RUN(axes_not_fitted_are_passed_over_in_silence); RUN(wrong_forms_are_refused);
          RUN(columns_hold_and_every_command_named_answers); RUN(page_is_true_in_motion);
          RUN(positions_are_in_the_users_frame); RUN(disabled_axis_shows_it);
          RUN(settling_times_are_measured);
          RUN(acceleration_gain_is_a_setting_and_shown); RUN(slow_port_gets_the_same_bytes))
