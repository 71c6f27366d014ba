/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/positions.h"

#include "core/axis.h"
#include "core/report.h"
#include "modules/coordinates.h"

void positions_field(struct reply *reply, unsigned axis, const struct snapshot *snapshot)
{
    reply_field(reply, axis_letter(axis));
    reply_number(reply, coordinates_counts_to_user(axis, snapshot->position_counts[axis]),
                 (unsigned)reply_position_decimals);
}

void positions_report(unsigned axes)
{
    struct reply line;
    struct snapshot snapshot;

    snapshot_now(&snapshot);
    reply_clear(&line);
    reply_open(&line, FORM_V);
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if ((axes >> axis & 1u) != 0)
            positions_field(&line, axis, &snapshot);
    reply_close(&line);
    if (line.length > 0 && !line.overflow)
        report_line(line.text, line.length);
}
