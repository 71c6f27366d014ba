/* SPDX-License-Identifier: BSD-2-Clause */
/** A level that ignores what does not last: rtl/debounce.py. */
#ifndef TWIN_DEBOUNCE_H
#define TWIN_DEBOUNCE_H

#include "clock.h"

namespace twin {

/** Every `period` clocks of `sync` since reset there is a strobe: the first edge of one at or after an edge. */
constexpr Time strobe_from(Time edge, Time period)
{
    const Time clock = sync_from(edge) / SYNC;
    return ((clock / period + 1) * period - 1) * SYNC;
}

class Debounce {
public:
    bool output() const { return output_; }
    bool settled() const { return input_ == output_; }

    /** An edge sees this level. */
    void input(bool level)
    {
        input_ = level;
        if (settled())
            seen_ = 0;
    }

    /** A strobe; true: the output changes from here on. */
    bool strobe(unsigned periods)
    {
        if (settled() || ++seen_ < periods)
            return false;
        seen_ = 0;
        output_ = input_;
        return true;
    }

private:
    bool input_ = false, output_ = false;
    unsigned seen_ = 0;
};

} // namespace twin

#endif
