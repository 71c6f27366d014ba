/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * When strobes pass from one clock domain to the other: the contract of rtl/crossing.py at the product's clocks, with
 * synchronisers that resolve on time.
 */
#ifndef TWIN_CROSSING_H
#define TWIN_CROSSING_H

#include "clock.h"

namespace twin {

/** One strobe under way, one kept. `Leave` names the edge at which the next may leave, by that of the last. */
template <Time (*next_after)(Time)> class Pace {
public:
    /** A strobe at `edge`; true: it leaves now. What was due has to have left by run(edge). */
    bool request(Time edge)
    {
        if (edge >= free_) {
            free_ = next_after(edge);
            return true;
        }
        kept_ = true;
        return false;
    }

    /** True: the one that was kept leaves at `edge`. */
    bool run(Time edge)
    {
        if (!kept_ || edge < free_)
            return false;
        kept_ = false;
        free_ = next_after(edge);
        return true;
    }

    /** When the one kept leaves. */
    Time next() const { return kept_ ? free_ : NEVER; }

    /** The first edge that sees `ready`, if nothing is kept. */
    Time free() const { return free_; }
    bool ready(Time edge) const { return !kept_ && edge >= free_; }

private:
    Time free_ = 0;
    bool kept_ = false;
};

/** `sync` to `fast`: the strobe that leaves at edge t acts at edge t + 4; acknowledged, the next may leave at t + 16. */
constexpr Time after_round_from_sync(Time edge)
{
    return edge + 4 * SYNC;
}
using ToFast = Pace<after_round_from_sync>;
constexpr Time ACTS_IN_FAST = 4;

/** `fast` to `sync`: two flip-flops and a strobe from the next `sync` edge on; then two flip-flops back. */
constexpr Time acts_in_sync(Time edge)
{
    return sync_after(edge) + 3 * SYNC;
}
constexpr Time after_round_from_fast(Time edge)
{
    return acts_in_sync(edge) + 3;
}
using ToSync = Pace<after_round_from_fast>;

} // namespace twin

#endif
