/* SPDX-License-Identifier: BSD-2-Clause */
/* The low-level binary format, bytes in and bytes out. */
#include "check.h"

#include <stdint.h>
#include <stdlib.h>

#include "machine.h"

/* Bytes in, what came out as hexadecimal; no answer here holds a zero byte. */
#define HEX(bytes) hex_of(bytes, sizeof(bytes) - 1)
#define SEND(text, reply) CHECK_TEXT(machine_send(text), reply)

static const char *hex_of(const char *bytes, size_t length)
{
    static char hex[64];
    const char *reply = machine_bytes(bytes, length);

    hex[0] = '\0';
    for (size_t i = 0; i < strlen(reply); i++)
        sprintf(hex + 3 * i, "%02x ", (unsigned char)reply[i]);
    return hex;
}

static void start(void)
{
    machine_start();
    machine_run(200); /* regulated */
}

static void start_binary(void)
{
    start();
    machine_bytes("\377B", 2);
}

static void end_binary(void)
{
    machine_bytes("\377A", 2);
}

TEST(moves_to_a_target_in_tenths_of_a_micron)
{
    start_binary();
    CHECK_TEXT(HEX("\030T\003\340\223\004:"), ""); /* 300000: 30 mm */
    CHECK_TEXT(HEX("\030?\000:"), "42 ");
    CHECK_TEXT(HEX("\031?\000:"), "62 ");
    end_binary();
    SEND("M X?", ":A X=300000.0\r\n");
    SEND("/", "B\r\n");
}

TEST(negative_places_are_twos_complement)
{
    start_binary();
    CHECK_TEXT(HEX("\031T\003\030\374\377:"), ""); /* -1000 */
    end_binary();
    SEND("M Y?", ":A Y=-1000.1\r\n"); /* -4540 counts */
    CHECK(machine_wait());
    machine_bytes("\377B", 2);
    const char *reply = machine_bytes("\031a\003:", 4);
    int32_t place = (int32_t)((uint32_t)(unsigned char)reply[0] | (uint32_t)(unsigned char)reply[1] << 8 |
                              (uint32_t)(unsigned char)reply[2] << 16 | 0xff000000u);

    CHECK(abs(place + 1000) <= 2);
    CHECK_INT(strlen(reply), 3);
}

TEST(position_and_status_come_together)
{
    start();
    SEND("H X=197121", ":A \r\n"); /* 0x030201 */
    machine_bytes("\377B", 2);
    CHECK_TEXT(HEX("\030l\003:"), "01 02 03 0a ");
    CHECK_TEXT(HEX("\030~\001:"), "0a ");
    end_binary();
}

TEST(places_follow_the_direction_of_um_and_not_its_scale)
{
    start();
    SEND("UM X=-1000", ":A \r\n");
    machine_bytes("\377B\030T\003\20\47\0:\377A", 11); /* 10000: 1 mm */
    SEND("M X?", ":A X=1000.0\r\n");
}

TEST(increments_move_up_and_down)
{
    start_binary();
    CHECK_TEXT(HEX("\030D\003\111\046\001:"), ""); /* 0x012649 */
    CHECK_TEXT(HEX("\030d\003:"), "49 26 01 ");
    CHECK_TEXT(HEX("\030+\000:"), "");
    CHECK_TEXT(HEX("\030+\000:"), "");
    CHECK_TEXT(HEX("\030-\000:"), "");
    end_binary();
    SEND("M X?", ":A X=75337.0\r\n");
}

TEST(a_motor_is_stopped_and_started)
{
    start_binary();
    CHECK_TEXT(HEX("\030T\003\340\223\004:"), "");
    machine_run(500);
    CHECK_TEXT(HEX("\030B\000:"), "");
    end_binary();
    CHECK(machine_wait());
    double target = atof(machine_send("M X?") + 5);
    CHECK(target > 0 && target < 299999);
    SEND("MC X-", ":A \r\n");
    machine_bytes("\377B\030G\000:\377A", 8);
    SEND("MC X?", ":A 1\r\n");
}

TEST(other_frames_are_taken_and_get_no_answer)
{
    start_binary();
    CHECK_TEXT(HEX("\030S\002\001\002:\030A\001\005:\030s\002:\143a\003:"), "");
    CHECK_TEXT(HEX("\030?\000:"), "62 ");
    end_binary();
}

TEST(commands_and_frames_are_answered_in_order)
{
    static const char bytes[] = "V\r\377B\030?\000:\377A/\r";

    start();
    CHECK_TEXT(machine_bytes(bytes, sizeof bytes - 1), ":A Version: USB-9.2k \r\nbN\r\n");
}

TEST(addresses_can_be_changed)
{
    start();
    SEND("LL X? F?", ":A X=24 F=27\r\n");
    SEND("LL X=33", ":A \r\n");
    SEND("LL X=255", ":N-4\r\n");
    CHECK_TEXT(HEX("\377B\030?\000:\041?\000:\377A"), "62 ");
}

/* A frame must not mean two axes. Within a line two may change theirs. */
TEST(an_address_is_one_axis)
{
    start();
    SEND("LL X=25", ":N-4\r\n");
    SEND("LL X=25.9", ":N-4\r\n");
    SEND("LL X=40 Y=40", ":N-4\r\n");
    SEND("LL X=25 Z=50", ":N-4\r\n");
    SEND("LL X? Y? Z? F?", ":A X=24 Y=25 Z=26 F=27\r\n");
    SEND("LL X=25 Y=24", ":A \r\n");
    SEND("LL X=25", ":A \r\n");
    SEND("LL Z X?", ":A X=25\r\n"); /* 0 */
    SEND("LL X? Y? Z?", ":A X=25 Y=24 Z=0\r\n");
    SEND("LL F", ":N-4\r\n");
}

TEST_MAIN(RUN(an_address_is_one_axis); RUN(moves_to_a_target_in_tenths_of_a_micron);
          RUN(negative_places_are_twos_complement);
          RUN(position_and_status_come_together);
          RUN(places_follow_the_direction_of_um_and_not_its_scale);
          RUN(increments_move_up_and_down); RUN(a_motor_is_stopped_and_started);
          RUN(other_frames_are_taken_and_get_no_answer);
          RUN(commands_and_frames_are_answered_in_order); RUN(addresses_can_be_changed))
