/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * A stage that does what it is told, by arithmetic: in place of motors, screws and friction, each axis moves in a straight
 * line from the set-point of one servo tick to that of the next, and its encoder edges come at the times that follow.
 *
 * Positions are the firmware's, counts with 32 fraction bits; times are edges of `fast`. Nothing is rounded but the time of
 * an encoder edge, to the first edge of `fast` that samples it.
 */
#ifndef TWIN_FOLLOWER_H
#define TWIN_FOLLOWER_H

#include <algorithm>

#include "block.h"

namespace twin {

class Follower {
public:
    /** At rest at 0, while encoders that are at these counts show what the pins have shown so far. */
    explicit Follower(const int64_t (&shown)[AXES])
    {
        for (unsigned n = 0; n < AXES; n++)
            shown_[n] = shown[n];
    }

    /** From `begin` to `end` each axis moves to a position, from where it then is. To be said before `begin`. */
    void move(Time begin, Time end, const int64_t (&positions_q32)[AXES])
    {
        told_begin_ = begin;
        told_length_ = end - begin;
        for (unsigned n = 0; n < AXES; n++)
            told_q32_[n] = positions_q32[n];
        plan();
    }

    /** The edge of `fast` that is the first to see what happens next; and let it. */
    Time next() const { return next_; }
    void happen()
    {
        bool crossed = false;
        for (Axis &axis : axes_)
            if (axis.next == next_) {
                axis.count += axis.to_q32 > axis.from_q32 ? 1 : -1;
                plan(axis);
                crossed = true;
            }
        if (!crossed)
            begin();
        plan();
    }

    /** Its encoders, at their input pins. Counts 0, 1, 2, 3 are A B = 00, 10, 11, 01. */
    uint64_t pins() const
    {
        uint64_t pins = 0;
        for (unsigned n = 0; n < AXES; n++) {
            const unsigned phase = unsigned((axes_[n].count + shown_[n]) & 3);
            pins |= uint64_t(phase == 1 || phase == 2) << (ENC_A + n) | uint64_t(phase >= 2) << (ENC_B + n);
        }
        return pins;
    }
    static constexpr uint64_t PINS = bits(ENC_A, AXES) | bits(ENC_B, AXES) | bits(ENC_Z, AXES);

private:
    struct Axis {
        int64_t from_q32 = 0, to_q32 = 0, count = 0;
        Time next = NEVER;
    };

    void begin()
    {
        begin_ = told_begin_;
        length_ = told_length_;
        told_begin_ = NEVER;
        for (unsigned n = 0; n < AXES; n++) {
            Axis &axis = axes_[n];
            axis.from_q32 = axis.to_q32;
            axis.to_q32 = told_q32_[n];
            plan(axis);
        }
    }

    /** The next boundary between two counts on the way, and when it is crossed. */
    void plan(Axis &axis) const
    {
        const bool up = axis.to_q32 > axis.from_q32;
        const int64_t edge_q32 = (up ? axis.count + 1 : axis.count) * (int64_t(1) << 32);

        axis.next = NEVER;
        if (axis.to_q32 == axis.from_q32 || (up ? edge_q32 > axis.to_q32 : edge_q32 <= axis.to_q32))
            return;
        const __int128 way = __int128(up ? edge_q32 - axis.from_q32 : axis.from_q32 - edge_q32) * length_;
        const int64_t speed = up ? axis.to_q32 - axis.from_q32 : axis.from_q32 - axis.to_q32;
        /* Downward the count changes just below the boundary: at once after it. */
        axis.next = begin_ + (up ? Time((way + speed - 1) / speed) : Time(way / speed) + 1);
    }

    void plan()
    {
        next_ = told_begin_;
        for (const Axis &axis : axes_)
            next_ = std::min(next_, axis.next);
    }

    Axis axes_[AXES];
    int64_t shown_[AXES];
    Time begin_ = 0, length_ = 1, next_ = NEVER;

    /* The move after the one in progress. */
    Time told_begin_ = NEVER, told_length_ = 1;
    int64_t told_q32_[AXES] = {};
};

} // namespace twin

#endif
