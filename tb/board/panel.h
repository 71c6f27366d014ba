/* SPDX-License-Identifier: BSD-2-Clause */
/** What hands are on: contacts that bounce, hand-wheels, and the wire from the converter; changes of pins to come. */
#ifndef BOARD_PANEL_H
#define BOARD_PANEL_H

#include <cstdint>
#include <map>

namespace plant {

class Panel {
public:
    static constexpr int64_t NEVER = INT64_MAX;

    /** When the next pin changes. */
    int64_t next_ps() const { return changes_.empty() ? NEVER : changes_.begin()->first; }

    /** Change it. */
    void next();

    /** A level from a time on. */
    void put(int64_t time_ps, uint8_t &pins, unsigned bit, bool level);

    /**
     * A contact moves: it has the level at once, and again for good after at most `bounce_ps`, in between up to four
     * times the other. What it was still to do from that time on is forgotten.
     */
    void contact(int64_t time_ps, uint8_t &pins, unsigned bit, bool level, double bounce_ps);

private:
    struct Change {
        uint8_t *pins;
        unsigned bit;
        bool level;
    };

    uint32_t random();

    std::multimap<int64_t, Change> changes_; /* of one time: in the order they were made */
    uint32_t random_ = 0x41626265;
};

} // namespace plant

#endif
