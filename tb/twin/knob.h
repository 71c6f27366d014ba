/* SPDX-License-Identifier: BSD-2-Clause */
/** Hand-wheels: rtl/knob.py. */
#ifndef TWIN_KNOB_H
#define TWIN_KNOB_H

#include "agenda.h"
#include "block.h"
#include "debounce.h"

namespace twin {

class Knobs final : public Block {
public:
    explicit Knobs(uint64_t pins) : filter_(REG_KNOB_FILTER_VALUE_RESET), pins_(pins)
    {
        listens = bits(KNOB_A, KNOBS) | bits(KNOB_B, KNOBS);
        agenda_.add(0, Kind::LEVELS);
    }

    uint32_t read(uint32_t address, Time) override
    {
        switch (address) {
        case REG_KNOB_FILTER: return filter_;
        case REG_KNOB_ERRORS: return errors_.bits;
        default: return uint32_t(knobs_[(address - REG_KNOB_POSITION0) / 4].count) & REG_KNOB_POSITION0_VALUE_MASK;
        }
    }

    void write(uint32_t address, uint32_t value, Time edge) override
    {
        if (address == REG_KNOB_FILTER)
            filter_ = value & REG_KNOB_FILTER_VALUE_MASK;
        else if (address == REG_KNOB_ERRORS)
            errors_.clear(edge, value);
    }

    void input(Time edge, uint64_t, uint64_t pins) override
    {
        pins_.set(sync_from(edge) + SYNC, pins);
        agenda_.add(sync_from(edge) + 2 * SYNC, Kind::LEVELS);
    }


    void run(Time edge) override
    {
        while (agenda_.next() == edge) {
            switch (agenda_.take().kind) {
            case Kind::LEVELS:
                for (unsigned n = 0; n < KNOBS; n++) {
                    knobs_[n].a.input(pins_.before(edge) >> (KNOB_A + n) & 1);
                    knobs_[n].b.input(pins_.before(edge) >> (KNOB_B + n) & 1);
                }
                wait(edge);
                break;
            case Kind::STROBE:
                strobe_ = NEVER;
                strobe(edge);
                wait(edge + SYNC);
                break;
            }
        }
        if (edge == counts_)
            count(edge);
    }

private:
    enum class Kind { LEVELS, STROBE };
    static constexpr unsigned KNOBS = REG_KNOB_POSITION_COUNT;
    static constexpr Time FILTER_CLOCKS = 64;

    struct Knob {
        Debounce a, b;
        bool was_a = false, was_b = false;
        int16_t count = 0;
        bool settled() const { return a.settled() && b.settled(); }
    };

    /** Strobes matter while some level has not lasted. */
    void wait(Time edge)
    {
        for (const Knob &knob : knobs_)
            if (!knob.settled() && strobe_ == NEVER)
                agenda_.add(strobe_ = strobe_from(edge, FILTER_CLOCKS), Kind::STROBE);
    }

    void strobe(Time edge)
    {
        bool moved = false;
        for (Knob &knob : knobs_) {
            moved |= knob.a.strobe(filter_);
            moved |= knob.b.strobe(filter_);
        }
        if (!moved)
            return;
        counts_ = edge + SYNC;
        agenda_.add(counts_, Kind::LEVELS); /* to be run then; levels are what they are */
    }

    void count(Time edge)
    {
        for (unsigned n = 0; n < KNOBS; n++) {
            Knob &knob = knobs_[n];
            const bool a = knob.a.output(), b = knob.b.output();
            if (a != knob.was_a && b != knob.was_b)
                errors_.set(edge, 1u << n << REG_KNOB_ERRORS_SKIPPED_SHIFT);
            else if (a != knob.was_a || b != knob.was_b)
                knob.count = int16_t(knob.count + (a != knob.was_b ? 1 : -1));
            knob.was_a = a;
            knob.was_b = b;
        }
    }

    uint32_t filter_;
    EventBits errors_;
    Past<uint64_t> pins_;
    Knob knobs_[KNOBS];
    Agenda<Kind> agenda_{due};
    Time strobe_ = NEVER, counts_ = NEVER;
};

} // namespace twin

#endif
