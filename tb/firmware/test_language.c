/* SPDX-License-Identifier: BSD-2-Clause */
/* The language as the whole firmware speaks it: what hosts send, and what must not hurt it. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "check.h"
#include "machine.h"
#include "random.h"

#define EXPECT(line, reply) CHECK_TEXT(machine_send(line), reply "\r\n")
#define EXPECT_START(line, reply)                                                                  \
    do {                                                                                           \
        const char *got = machine_send(line);                                                      \
        if (strncmp(got, reply, strlen(reply)) != 0)                                               \
            CHECK_FAIL("%s gives \"%s\", not \"%s...\"", line, got, reply);                        \
    } while (0)

/* The start-up of the most used host, in its order. */
TEST(a_common_host_gets_through_its_start_up)
{
    machine_start();
    EXPECT("/", "N");
    EXPECT_START("V", ":A Version: USB-9.2k \r\n");
    EXPECT_START("BU", "ABBE_XYZF\r\n");
    EXPECT("UM X=-10000 Y=10000", ":A ");
    EXPECT_START("S X?", ":A X=");
    EXPECT("S X=10000.000000 Y=10000.000000", ":A ");
    EXPECT("S X?", ":A X=6.800000");
    EXPECT("S X=5.745900 Y=5.745900", ":A ");
    EXPECT("S X? Y?", ":A X=5.745900 Y=5.745900");
    EXPECT_START("AC X?", ":X=");
    EXPECT_START("C X?", ":X=45396");
    EXPECT("W X Y", ":A 0.0 0.0 ");
}

TEST(build_x_names_the_modules_that_are_there)
{
    machine_start();
    const char *text = machine_send("BU X");

    CHECK(strstr(text, "\rMotor Axes: X Y Z F  \r") != NULL);
    CHECK(strstr(text, "\rSCAN MODULE") != NULL);
    CHECK(strstr(text, "\rENC_INT") != NULL);
}

TEST(a_move_is_busy_at_once_and_ends_at_its_target)
{
    machine_start();
    EXPECT("M X=10000 Y=-500.5", ":A ");
    EXPECT("/", "B");
    EXPECT("RS X? Y? Z?", ":A BBN");
    CHECK(machine_wait());
    double x = 0, y = 0;
    CHECK(sscanf(machine_send("W X Y"), ":A %lf %lf \r\n", &x, &y) == 2);
    CHECK(fabs(x - 10000) < 10 && fabs(y + 500.5) < 10); /* 1 um: what hosts ask for */
    EXPECT("M X=10000", ":A ");
    CHECK(machine_wait());
}

TEST(halt_stops_a_move_and_says_so)
{
    machine_start();
    EXPECT("M X=100000", ":A ");
    machine_run(500);
    CHECK_TEXT(machine_bytes("\\", 1), ":N-21\r\n");
    CHECK_TEXT(machine_bytes("\r", 1), "");
    CHECK(machine_wait());
    EXPECT("HALT", ":A ");
}

/* Each gets the answer of the language, and the next good command works. */
TEST(nasty_lines_get_their_answers)
{
    char text[512];

    machine_start();
    EXPECT("SCANF =0", ":N-1");
    EXPECT("FOO", ":N-1");
    EXPECT("XYZZY X=1", ":N-1");
    EXPECT("MOVE", ":N-3");
    EXPECT("M X=", ":N-3");
    EXPECT("WHERE Q", ":N-2");
    EXPECT("MOVE Q=1", ":N-2");
    EXPECT("SCANR Z=0", ":N-4");
    EXPECT("PC X=6e-06 Y=6E-6", ":A ");
    EXPECT("PC X? Y?", ":A X=0.000006 Y=0.000006");
    EXPECT("S VX=4.690000 VY=4.690000 ", ":A ");
    EXPECT("S X? Y? ", ":A X=4.690000 Y=4.690000");
    EXPECT("M X=1e400", ":N-4");
    EXPECT("M X=1 Q=1", ":N-2");
    EXPECT("S X=3 Y=0", ":N-4");
    memset(text, 'W', 300);
    text[300] = '\0';
    EXPECT(text, ":N-6");
    EXPECT("W X", ":A 0.0 ");
    EXPECT("/", "N"); /* nothing above has moved anything */
}

/* Commands, letters and values that need hardware or a module that is not there say so. */
TEST(what_is_not_there_has_a_clear_answer)
{
    static const char *const unknown[] = {
        "AF", "AH", "AIJ", "AR", "CCA X=1", "CCB Z=1", "ES", "EX", "LS", "MM",
        "PD X?", "PM X?", "PZ", "PZC", "RL", "SECURE X=1", "SI X?", "VIBRATE", "WD X=1", "WRDAC X=1",
    };

    machine_start();
    for (size_t n = 0; n < sizeof unknown / sizeof *unknown; n++)
        EXPECT(unknown[n], ":N-1");
    EXPECT("J X=8", ":N-4"); /* foot switch */
    EXPECT("J X=11", ":N-4");
    EXPECT("J X?", ":A X=2");
    EXPECT("SB X?", ":A X=1");
    EXPECT("STOPBITS X=1", ":A ");
    EXPECT("SB X=2", ":N-4");
    EXPECT("SB X=0", ":N-4");
    EXPECT("VB F", ":A ");
    EXPECT("VB F=1", ":N-4");
    EXPECT("VB T?", ":N-2");
    EXPECT("RT T?", ":N-2");
    EXPECT("TTL T?", ":N-2");
    EXPECT("UL X?", ":N-2");
    EXPECT("TTL X=9", ":N-4");
    EXPECT("TTL Y=8", ":N-4");
    EXPECT("RM X=1", ":N-4");
    EXPECT("DIP X=1", ":N-4");
}

TEST(ten_kilobytes_of_noise_leave_it_working)
{
    uint8_t bytes[10000];

    machine_start();
    srand(10);
    for (size_t i = 0; i < sizeof bytes; i++)
        bytes[i] = (uint8_t)(rand() >> 7);
    for (size_t i = 0; i < sizeof bytes; i += 100)
        machine_bytes(bytes + i, 100);
    machine_bytes("\r\377A\r", 4);
    EXPECT_START("W X Y", ":A ");
    EXPECT("S X=2.5", ":A ");
    EXPECT("S X?", ":A X=2.500000");
}

static const char *one_of(const char *const *list, size_t count)
{
    return list[random_below((uint32_t)count)];
}
#define ONE_OF(list) one_of(list, sizeof list / sizeof *list)

/* A line of the language, mostly: verb, arguments, here and there something out of place. */
static void random_line(char *text)
{
    static const char *const verbs[] = {
        "M", "MOVE", "R", "W", "H", "Z", "HALT", "/", "RS", "RB", "S", "AC", "C", "UM", "PC", "E",
        "KP", "KI", "KD", "SL", "SU", "MC", "V", "N", "BU", "CD", "I", "TTL", "SCAN", "SCANR",
        "SCANV", "NR", "NV", "SS", "VB", "DU", "WT", "MA", "FOO",
    };
    static const char *const letters[] = {"X", "Y", "Z", "F", "X", "Y", "T", "R", "M", "Q", "VX"};
    static const char *const forms[] = {"=", "=", "=", "=", "?", "?", "", "+", "-", " = "};
    static const char *const numbers[] = {
        "0", "1", "2", "3", "9", "-5", "0.5", "24", "24.4", "1000", "-10000", "45396", "83", "80",
        "1e3", "1e9", "-1e9", "1e300", "1e-300", "99999999999", "2147483648", "-2147483649",
    };
    static const char *const noise[] = {"\b", "\n", "\r", "=", "?", "\"", ",", "\377T", "\377H",
                                        "\\", "\\r", "XYZ", "\200", "e"};

    strcpy(text, ONE_OF(verbs));
    for (uint32_t n = random_below(4); n > 0; n--) {
        strcat(text, random_below(4) > 0 ? " " : "");
        strcat(text, ONE_OF(letters));
        const char *form = ONE_OF(forms);
        strcat(text, form);
        if (strchr(form, '=') != NULL)
            strcat(text, ONE_OF(numbers));
        if (random_below(15) == 0)
            strcat(text, ONE_OF(noise));
    }
    strcat(text, "\r");
}

/* Commands of every module while axes move and lines are scanned. */
TEST(half_a_million_bytes_of_commands_find_no_fault)
{
    unsigned good = 0, bad = 0;

    machine_start();
    random_state = 2026;
    for (unsigned long total = 0; total < 500000;) {
        char text[200];

        random_line(text);
        total += strlen(text);
        const char *reply = machine_bytes(text, strlen(text));

        good += reply[0] == ':' && reply[1] != 'N';
        bad += strncmp(reply, ":N", 2) == 0;
    }
    CHECK(good > 5000 && bad > 5000); /* noise that nothing gets through proves nothing */
    machine_bytes("\r\r", 2);
    EXPECT_START("V", ":A Version: USB-");
    EXPECT_START("W X", ":A ");
}

TEST_MAIN(RUN(a_common_host_gets_through_its_start_up);
          RUN(build_x_names_the_modules_that_are_there);
          RUN(a_move_is_busy_at_once_and_ends_at_its_target); RUN(halt_stops_a_move_and_says_so);
          RUN(nasty_lines_get_their_answers);
          RUN(what_is_not_there_has_a_clear_answer); RUN(ten_kilobytes_of_noise_leave_it_working);
          RUN(half_a_million_bytes_of_commands_find_no_fault))
