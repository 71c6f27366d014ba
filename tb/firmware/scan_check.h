/* SPDX-License-Identifier: BSD-2-Clause */
/** What the tests of scans share: the worked example, the states of a scan, where pixels belong. */
#ifndef TB_FIRMWARE_SCAN_CHECK_H
#define TB_FIRMWARE_SCAN_CHECK_H

#include "check.h"

#include "core/fault.h"
#include "modules/motion.h"
#include "modules/scan_run.h"
#include "port.h"
#include "stage.h"

#define ACKNOWLEDGED ":A \r\n"
#define SEND(text, reply) CHECK_TEXT(port_send(text), reply)

/* The worked example at four times the speed; its run-up is 4 x 599 counts, settling and margin. */
#define WORKED_EXAMPLE                                                                             \
    do {                                                                                           \
        SEND("SCANR X=0.0 Y=1.0 Z=24", ACKNOWLEDGED);                                              \
        SEND("SCANV X=0.0 Y=1.0 Z=1", ACKNOWLEDGED);                                               \
        SEND("SPEED X=2.112 Y=2.112", ACKNOWLEDGED);                                               \
        SEND("SCAN F=0", ACKNOWLEDGED);                                                            \
        SEND("TTL X=1", ACKNOWLEDGED);                                                             \
    } while (0)

/* Runs to the end of the scan and collects the states it went through, each once in a row. */
static inline const char *states(void)
{
    static char text[256];
    size_t length = 0;

    for (int n = 0; n < 200000; n++) {
        const char state = (char)scan_run_state();

        if ((length == 0 || text[length - 1] != state) && length < sizeof text - 1)
            text[length++] = state;
        if (state == SCAN_IDLE)
            break;
        /* Busy all the time, or it shows. */
        if ((strcmp(port_send("/"), "B\r\n") != 0 || !motion_busy()) && length < sizeof text - 1)
            text[length++] = '!';
        stage_tick();
    }
    text[length] = '\0';
    return text;
}

static inline bool moved(void)
{
    for (int n = 0; n < 100; n++)
        stage_tick();
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if (stage_position[axis] != 0)
            return true;
    return false;
}

/* Pixel k on the edge that completes k pitches after SYNC; the pitch in thousandths of a count. */
static inline bool pixels_lie_on(const struct stage_line *line, uint32_t pixels, long long milli)
{
    if (!line->finished || line->pixels != pixels)
        return false;
    for (uint32_t k = 1; k <= pixels; k++) {
        const long long edges = (k * milli + 999) / 1000;

        if (line->pixel_edge[k - 1] != line->sync_edge + (line->reverse ? -edges : edges))
            return false;
    }
    return true;
}

/* After a start: goes on into the active line. */
static inline void go_into_the_line(void)
{
    while (!stage_sync)
        stage_tick();
    for (int n = 0; n < 200; n++)
        stage_tick();
}

#endif
