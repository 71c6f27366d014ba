/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Modulation of a lamp: rtl/led.py. Settings go over by a crossing and wait for the next period; a dark period ends
 * for light at once. While it is dark nothing happens, and where its periods would begin is computed when it matters.
 */
#ifndef TWIN_LED_H
#define TWIN_LED_H

#include "agenda.h"
#include "block.h"
#include "crossing.h"
#include "line.h"

namespace twin {

class Led final : public Block {
public:
    /** `line` is told of the level. */
    explicit Led(Line &line);

    uint32_t read(uint32_t address, Time edge) override;
    void write(uint32_t address, uint32_t value, Time edge) override;
    void run(Time edge) override;

private:
    /* At one edge in this order. */
    enum class Kind {
        SEND,    /* settings that waited for the crossing leave */
        REQUEST, /* and those just loaded, if they need not wait */
        TAKE,    /* those that have arrived become the next period's */
        ARRIVE,
        FALL,
        BEGIN,   /* of a period */
    };

    struct Settings {
        uint32_t period, on;
        bool operator==(const Settings &other) const { return period == other.period && on == other.on; }
    };

    void send(Time edge);
    void arrive(Time edge);
    void plan_take(Time edge);

    Line &line_;
    Agenda<Kind> agenda_{due};

    uint32_t period_, on_ = 0; /* registers */
    Settings wanted_, sent_;
    bool requested_ = false; /* a REQUEST is to come */
    ToFast crossing_;
    Past<Settings> arrived_;
    Settings present_;       /* of the period that begins at begin_, or has begun */
    Time begin_, take_ = NEVER;
};

} // namespace twin

#endif
