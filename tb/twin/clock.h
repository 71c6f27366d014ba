/* SPDX-License-Identifier: BSD-2-Clause */
/** Time of the peripheral model, and a register whose recent past can be asked. */
#ifndef TWIN_CLOCK_H
#define TWIN_CLOCK_H

#include <array>
#include <cstdint>

namespace twin {

/**
 * A clock edge of `fast`, counted from the first one after reset, which is edge 0 and one of `sync` as well: every
 * fourth is. "From edge e on" means that flip-flops show it after edge e, and that edge e + 1 is the first to see it.
 */
using Time = int64_t;

constexpr Time NEVER = INT64_MAX;
constexpr Time SYNC = 4; /* `fast` edges to a `sync` edge */

/** The first `sync` edge at or after an edge. */
constexpr Time sync_from(Time edge)
{
    return (edge + SYNC - 1) / SYNC * SYNC;
}

/** The first `sync` edge after an edge: what an edge at the same instant does is seen by the next. */
constexpr Time sync_after(Time edge)
{
    return sync_from(edge + 1);
}

/** A register: its value, and what an edge in the last few clocks saw, or will see of what has been set ahead. */
template <class T> class Past {
public:
    explicit Past(T value = T()) { entries_.fill({INT64_MIN, value}); }

    /** From `edge` on, not before an edge set earlier. */
    void set(Time edge, T value)
    {
        if (entries_[newest_].from != edge)
            newest_ = (newest_ + 1) % DEPTH;
        entries_[newest_] = {edge, value};
    }

    const T &last() const { return entries_[newest_].value; }

    /** What `edge` sees. */
    const T &before(Time edge) const
    {
        unsigned n = newest_;
        for (unsigned back = 1; back < DEPTH && entries_[n].from >= edge; back++)
            n = (n + DEPTH - 1) % DEPTH;
        return entries_[n].value;
    }

private:
    static constexpr unsigned DEPTH = 8;
    struct Entry {
        Time from;
        T value;
    };
    std::array<Entry, DEPTH> entries_;
    unsigned newest_ = 0;
};

} // namespace twin

#endif
