/* SPDX-License-Identifier: BSD-2-Clause */
/** SyncFIFOBuffered of amaranth.lib.fifo. */
#ifndef TWIN_FIFO_H
#define TWIN_FIFO_H

#include <array>

#include "clock.h"

namespace twin {

/**
 * A FIFO of DEPTH values, one of them in a register at its output, which a value reaches the clock after it came. At
 * one edge it is read and written in either order: both go by what the edge saw.
 */
template <class T, unsigned DEPTH> class Fifo {
public:
    bool ready() const { return ready_; }
    bool full() const { return level_ == INNER; }
    unsigned level() const { return level_ + ready_; }
    const T &output() const { return output_; }

    /** The output is empty and will not be after the next clock. */
    bool moves() const { return level_ != 0 && !ready_; }

    /** A clock, with or without a read; what was clocked without has nothing for a read at the same edge. */
    void clock(Time edge, bool read)
    {
        see(edge);
        if (clocked_ == edge)
            return;
        clocked_ = edge;
        if (seen_ != 0 && (!ready_ || read)) {
            output_ = values_[out_];
            out_ = (out_ + 1) % INNER;
            level_--;
            ready_ = true;
        } else if (read) {
            ready_ = false;
        }
    }

    /** False: it was full, and the value is lost. */
    bool put(Time edge, const T &value)
    {
        see(edge);
        if (seen_ == INNER)
            return false;
        values_[in_] = value;
        in_ = (in_ + 1) % INNER;
        level_++;
        return true;
    }

    /** Empty from this edge on, whatever else happened at it. */
    void clear()
    {
        in_ = out_ = level_ = 0;
        ready_ = false;
    }

private:
    static constexpr unsigned INNER = DEPTH - 1;

    void see(Time edge)
    {
        if (at_ != edge)
            seen_ = level_;
        at_ = edge;
    }

    std::array<T, INNER> values_{};
    unsigned in_ = 0, out_ = 0, level_ = 0;
    T output_{};
    bool ready_ = false;
    Time at_ = NEVER, clocked_ = NEVER; /* the last edge that did anything, and the level it saw */
    unsigned seen_ = 0;
};

} // namespace twin

#endif
