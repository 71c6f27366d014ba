/* SPDX-License-Identifier: BSD-2-Clause */
/** The positions of all axes and the time at one instant, on a servo tick or on request: rtl/snapshot.py. */
#ifndef TWIN_SNAPSHOT_H
#define TWIN_SNAPSHOT_H

#include "agenda.h"
#include "block.h"
#include "crossing.h"
#include "quadrature.h"

namespace twin {

/** Who asks for snapshots by the servo tick. */
class TickListener {
public:
    /** The interrupt may be raised from `edge` on: the tick bank is readable. */
    virtual void latched(Time edge) = 0;

protected:
    ~TickListener() = default;
};

class Snapshot final : public Block {
public:
    /** `init`: the time at reset. */
    Snapshot(TickListener &listener, Quadrature (&encoders)[AXES], uint64_t init)
        : listener_(listener), encoders_(encoders), init_(init)
    {
    }

    /** A servo tick is taken by `edge`. Ticks are further apart than a crossing takes. */
    void tick(Time edge)
    {
        if (tick_.crossing.request(edge))
            agenda_.add(edge + ACTS_IN_FAST, Kind::LATCH_TICK);
    }

    uint32_t read(uint32_t address, Time edge) override
    {
        const uint32_t n = (address - REG_SNAPSHOT_CONTROL) / 4;
        if (address == REG_SNAPSHOT_STATUS)
            return sample_.crossing.ready(edge) ? 0 : REG_SNAPSHOT_STATUS_BUSY_MASK;
        return n >= TICK && n < TICK + WORDS ? tick_.words[n - TICK] : n >= SAMPLE ? sample_words(n - SAMPLE) : 0;
    }

    void write(uint32_t address, uint32_t value, Time edge) override
    {
        if (address != REG_SNAPSHOT_CONTROL || !(value & REG_SNAPSHOT_CONTROL_SAMPLE_MASK))
            return;
        if (sample_.crossing.request(edge))
            agenda_.add(edge + ACTS_IN_FAST, Kind::LATCH_SAMPLE);
        else
            agenda_.add(sample_.crossing.next(), Kind::SEND_SAMPLE);
    }


    void run(Time edge) override
    {
        while (agenda_.next() == edge) {
            switch (agenda_.take().kind) {
            case Kind::SEND_SAMPLE:
                if (sample_.crossing.run(edge))
                    agenda_.add(edge + ACTS_IN_FAST, Kind::LATCH_SAMPLE);
                break;
            case Kind::LATCH_TICK:
                latch(tick_, edge);
                agenda_.add(edge - ACTS_IN_FAST + 4 * SYNC, Kind::TICK_DONE);
                break;
            case Kind::LATCH_SAMPLE:
                latch(sample_, edge);
                for (Quadrature &encoder : encoders_)
                    encoder.hold(edge);
                break;
            case Kind::TICK_DONE:
                listener_.latched(edge);
                break;
            }
        }
    }

private:
    enum class Kind { SEND_SAMPLE, LATCH_TICK, LATCH_SAMPLE, TICK_DONE };

    /* Word offsets: of the banks, of the gap between time and positions of the sample bank. */
    static constexpr uint32_t TICK = (REG_SNAPSHOT_TICK_TIME_LOW - REG_SNAPSHOT_CONTROL) / 4;
    static constexpr uint32_t SAMPLE = (REG_SNAPSHOT_SAMPLE_TIME_LOW - REG_SNAPSHOT_CONTROL) / 4;
    static constexpr uint32_t SAMPLE_POSITION = (REG_SNAPSHOT_SAMPLE_POSITION0 - REG_SNAPSHOT_CONTROL) / 4 - SAMPLE;
    static constexpr uint32_t WORDS = 2 + AXES;

    struct Bank {
        ToFast crossing;
        uint32_t words[WORDS] = {}; /* time low, time high, positions */
    };

    uint32_t sample_words(uint32_t n) const { return sample_.words[n < 2 ? n : n - SAMPLE_POSITION + 2]; }

    void latch(Bank &bank, Time edge)
    {
        const uint64_t time = init_ + uint64_t(edge);
        bank.words[0] = uint32_t(time);
        bank.words[1] = uint32_t(time >> 32);
        for (unsigned axis = 0; axis < AXES; axis++)
            bank.words[2 + axis] = uint32_t(encoders_[axis].count(edge));
    }

    TickListener &listener_;
    Quadrature (&encoders_)[AXES];
    const uint64_t init_;
    Agenda<Kind> agenda_{due};
    Bank tick_, sample_;
};

} // namespace twin

#endif
