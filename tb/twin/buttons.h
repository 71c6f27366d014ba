/* SPDX-License-Identifier: BSD-2-Clause */
/** Push-buttons, debounced and measured: rtl/buttons.py. */
#ifndef TWIN_BUTTONS_H
#define TWIN_BUTTONS_H

#include <algorithm>

#include "block.h"
#include "debounce.h"
#include "timer.h"

namespace twin {

class Buttons final : public Block {
public:
    /** `millisecond`: in `sync` clocks. */
    Buttons(const Timer &timer, uint64_t pins, Time millisecond)
        : timer_(timer), millisecond_(millisecond), levels_(gather(pins))
    {
        listens = bits(BUTTON, BUTTONS) | bits(JOYSTICK_BUTTON, 1);
    }

    uint32_t read(uint32_t address, Time edge) override
    {
        uint32_t pressed = 0;
        switch (address) {
        case REG_BUTTONS_LEVELS:
            for (unsigned n = 0; n < BUTTONS; n++)
                pressed |= uint32_t(buttons_[n].debounce.output()) << n;
            return pressed << REG_BUTTONS_LEVELS_PRESSED_SHIFT | levels_.before(edge) << REG_BUTTONS_LEVELS_PINS_SHIFT;
        case REG_BUTTONS_EVENTS: return events_.bits;
        case REG_BUTTONS_DEBOUNCE: return debounce_;
        case REG_BUTTONS_LONG: return long_;
        case REG_BUTTONS_EXTRA_LONG: return extra_long_;
        default: break;
        }
        if (address >= REG_BUTTONS_TIME0)
            return buttons_[(address - REG_BUTTONS_TIME0) / 4].time;
        return buttons_[(address - REG_BUTTONS_PRESS0) / 4].press;
    }

    void write(uint32_t address, uint32_t value, Time edge) override
    {
        switch (address) {
        case REG_BUTTONS_EVENTS: events_.clear(edge, value); break;
        case REG_BUTTONS_DEBOUNCE: debounce_ = value & REG_BUTTONS_DEBOUNCE_VALUE_MASK; break;
        case REG_BUTTONS_LONG: long_ = value & REG_BUTTONS_LONG_VALUE_MASK; break;
        case REG_BUTTONS_EXTRA_LONG: extra_long_ = value & REG_BUTTONS_EXTRA_LONG_VALUE_MASK; break;
        }
    }

    void input(Time edge, uint64_t, uint64_t pins) override
    {
        levels_.set(sync_from(edge) + SYNC, gather(pins));
        seen_ = sync_from(edge) + 2 * SYNC;
        looks_ = std::min(looks_, seen_);
        plan();
    }

    void run(Time edge) override
    {
        if (edge == released_)
            release(edge);
        if (edge == looks_)
            look(edge);
        if (edge == strobe_from(edge, millisecond_))
            strobe(edge);
        /* Strobes matter while a button is held, or may have been pressed. */
        bool waits = false;
        for (const Button &button : buttons_)
            waits |= button.debounce.output() || !button.debounce.settled();
        strobe_ = waits ? strobe_from(edge + 1, millisecond_) : NEVER;
        plan();
    }

private:
    static constexpr unsigned BUTTONS = REG_BUTTONS_PRESS_COUNT, JOYSTICK = 3;
    static constexpr uint32_t DURATION_MAX = 0xffff;

    struct Button {
        Debounce debounce;
        uint32_t duration = 0;
        bool released = false; /* a clock ago */
        uint32_t press = 0, time = 0;
    };

    void plan() { due = std::min({looks_, strobe_, released_}); }

    static uint32_t gather(uint64_t pins)
    {
        return uint32_t(pins >> BUTTON & 0xf) | uint32_t(pins >> JOYSTICK_BUTTON & 1) << JOYSTICK;
    }

    void look(Time edge)
    {
        const uint32_t levels = levels_.before(edge);
        for (unsigned n = 0; n < BUTTONS; n++)
            buttons_[n].debounce.input(levels >> n & 1);
        looks_ = edge < seen_ ? edge + SYNC : NEVER;
    }

    void strobe(Time edge)
    {
        for (Button &button : buttons_) {
            if (button.debounce.output() && button.duration != DURATION_MAX)
                button.duration++;
            if (!button.debounce.strobe(debounce_))
                continue;
            if (button.debounce.output()) {
                button.duration = 0;
            } else {
                button.released = true;
                released_ = edge + SYNC;
            }
        }
    }

    void release(Time edge)
    {
        for (unsigned n = 0; n < BUTTONS; n++) {
            Button &button = buttons_[n];
            if (!button.released)
                continue;
            const uint32_t length = button.duration >= extra_long_ ? 2 : button.duration >= long_ ? 1 : 0;
            button.released = false;
            button.press = button.duration << REG_BUTTONS_PRESS0_DURATION_SHIFT |
                           length << REG_BUTTONS_PRESS0_LENGTH_SHIFT;
            button.time = uint32_t(timer_.count(edge));
            const uint32_t was = events_.bits >> REG_BUTTONS_EVENTS_RELEASED_SHIFT & 1u << n;
            events_.set(edge, 1u << n << REG_BUTTONS_EVENTS_RELEASED_SHIFT | was << REG_BUTTONS_EVENTS_LOST_SHIFT);
        }
        released_ = NEVER;
    }

    const Timer &timer_;
    const Time millisecond_;
    Past<uint32_t> levels_;
    uint32_t debounce_ = REG_BUTTONS_DEBOUNCE_VALUE_RESET, long_ = REG_BUTTONS_LONG_VALUE_RESET;
    uint32_t extra_long_ = REG_BUTTONS_EXTRA_LONG_VALUE_RESET;
    EventBits events_;
    Button buttons_[BUTTONS];
    Time looks_ = 0, strobe_ = NEVER, released_ = NEVER;
    Time seen_ = 0; /* the edge that sees the last change of a level */
};

} // namespace twin

#endif
