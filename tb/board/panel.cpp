/* SPDX-License-Identifier: BSD-2-Clause */
#include "panel.h"

#include <algorithm>
#include <vector>

namespace plant {

void Panel::next()
{
    const Change change = changes_.begin()->second;

    changes_.erase(changes_.begin());
    *change.pins = uint8_t(change.level ? *change.pins | 1u << change.bit : *change.pins & ~(1u << change.bit));
}

void Panel::put(int64_t time_ps, uint8_t &pins, unsigned bit, bool level)
{
    changes_.insert({time_ps, {&pins, bit, level}});
}

void Panel::contact(int64_t time_ps, uint8_t &pins, unsigned bit, bool level, double bounce_ps)
{
    for (auto at = changes_.lower_bound(time_ps); at != changes_.end();)
        at = at->second.pins == &pins && at->second.bit == bit ? changes_.erase(at) : std::next(at);
    put(time_ps, pins, bit, level);

    std::vector<int64_t> times(2 * (random() % 5));
    for (int64_t &time : times)
        time = time_ps + int64_t(bounce_ps * (double(random()) / 4294967296.0));
    std::sort(times.begin(), times.end());
    for (int64_t time : times)
        put(time, pins, bit, level = !level);
}

/** Marsaglia, "Xorshift RNGs", Journal of Statistical Software 8(14), 2003: (13, 17, 5). */
uint32_t Panel::random()
{
    random_ ^= random_ << 13;
    random_ ^= random_ >> 17;
    random_ ^= random_ << 5;
    return random_;
}

} // namespace plant
