/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/positions.h"

#include "core/axis.h"
#include "core/report.h"
#include "hal/snapshot.h"
#include "modules/coordinates.h"

void positions_write(struct reply *reply, unsigned axes)
{
    struct snapshot snapshot;

    snapshot_now(&snapshot);
    reply_open(reply, FORM_V);
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        if ((axes >> axis & 1u) == 0)
            continue;
        reply_field(reply, axis_letter(axis));
        reply_number(reply, coordinates_counts_to_user(axis, snapshot.position_counts[axis]),
                     (unsigned)reply_position_decimals);
    }
    reply_close(reply);
}

void positions_report(unsigned axes)
{
    struct reply line;

    reply_clear(&line);
    positions_write(&line, axes);
    if (line.length > 0 && !line.overflow)
        report_line(line.text, line.length);
}
