/* SPDX-License-Identifier: BSD-2-Clause */
/** A pulse at IN0 or OUT0 freezes the positions of all axes, and the records wait in a queue: rtl/trigger.py. */
#ifndef TWIN_TRIGGER_H
#define TWIN_TRIGGER_H

#include "agenda.h"
#include "block.h"
#include "crossing.h"
#include "fifo.h"
#include "quadrature.h"

namespace twin {

class Trigger final : public Block {
public:
    /** `init`: the time at reset. */
    Trigger(Outputs &outputs, Quadrature (&encoders)[AXES], uint64_t pins, uint64_t init);

    /** OUT0 has a level from `edge` on. */
    void out0(Time edge, bool level);

    uint32_t read(uint32_t address, Time edge) override;
    void write(uint32_t address, uint32_t value, Time edge) override;
    void input(Time edge, uint64_t changed, uint64_t pins) override;
    void run(Time edge) override;

private:
    /* At one edge in this order. */
    enum class Kind {
        SEND,     /* settings leave the register */
        SETTINGS, /* and arrive */
        LOOK,     /* this edge may see another level than the one before */
        TAKE,     /* the count of an axis, for the last rise */
        RECORD,   /* the pulse has lasted long enough */
        REST,     /* so has the pause */
        LEAVE,    /* the record leaves for the queue */
        QUEUE,
        MOVE,     /* a record reaches the output of the queue */
    };

    struct Settings {
        unsigned minimum;
        bool enable, output, falling;
    };

    struct Record {
        uint32_t words[2 + AXES]; /* time low, time high, positions */
    };

    bool level(Time edge) const;
    void look(Time edge);
    void queue_moved(Time edge);

    Outputs &outputs_;
    Quadrature (&encoders_)[AXES];
    const uint64_t init_;
    Agenda<Kind> agenda_{due};

    uint32_t config_, interrupt_enable_ = 0;
    ToFast handover_;
    Past<Settings> settings_;
    Time settled_ = NEVER; /* the edge that sees new settings for the first time */

    Past<bool> in0_, out0_{false}; /* behind their flip-flops */
    bool was_ = true;              /* the level that the last look saw */
    enum { IDLE, PULSE, PAUSE } state_ = PAUSE;
    Time began_ = NEVER, rests_ = NEVER; /* the edge that saw the rise; the one that ends the pause */
    Time takes_[AXES] = {};
    Record capture_{}, hold_{};

    ToSync crossing_;
    Fifo<Record, TRIGGER_RECORDS> queue_;
    uint32_t missed_ = 0;
};

} // namespace twin

#endif
