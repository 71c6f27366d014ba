/* SPDX-License-Identifier: BSD-2-Clause */
#include "led.h"

namespace twin {

namespace {

/* From the clock that takes the settings of a period to the edge from which its first clock shows; and from the edge
 * that sees that a period is over, or is to be, to the one that takes. */
constexpr Time LEAD = 2, TAKES = 1;

constexpr uint32_t PERIOD_MIN = 4;

} // namespace

Led::Led(Line &line)
    : line_(line), period_(REG_LED_PERIOD_VALUE_RESET), wanted_{period_, 0}, sent_(wanted_), arrived_(wanted_),
      present_(wanted_), begin_(LEAD)
{
}

uint32_t Led::read(uint32_t address, Time edge)
{
    switch (address) {
    case REG_LED_PERIOD: return period_;
    case REG_LED_ON: return on_;
    case REG_LED_STATUS: return requested_ || !crossing_.ready(edge) ? REG_LED_STATUS_BUSY_MASK : 0;
    default: return 0;
    }
}

void Led::write(uint32_t address, uint32_t value, Time edge)
{
    switch (address) {
    case REG_LED_PERIOD: period_ = value & REG_LED_PERIOD_VALUE_MASK; break;
    case REG_LED_ON: on_ = value & REG_LED_ON_VALUE_MASK; break;
    case REG_LED_CONTROL:
        if (!(value & REG_LED_CONTROL_LOAD_MASK))
            break;
        wanted_.period = period_ < PERIOD_MIN ? PERIOD_MIN : period_;
        wanted_.on = on_ < wanted_.period ? on_ : wanted_.period;
        requested_ = true;
        agenda_.add(edge + SYNC, Kind::REQUEST);
        break;
    }
}

void Led::send(Time edge)
{
    sent_ = wanted_;
    agenda_.add(edge + ACTS_IN_FAST, Kind::ARRIVE);
}

void Led::run(Time edge)
{
    while (agenda_.next() == edge) {
        switch (agenda_.take().kind) {
        case Kind::SEND:
            if (crossing_.run(edge))
                send(edge);
            break;
        case Kind::REQUEST:
            requested_ = false;
            if (crossing_.request(edge))
                send(edge);
            else
                agenda_.add(crossing_.next(), Kind::SEND);
            break;
        case Kind::TAKE:
            if (edge != take_)
                break;
            take_ = NEVER;
            present_ = arrived_.before(edge);
            begin_ = edge + LEAD;
            agenda_.add(begin_, Kind::BEGIN);
            if (present_.on != 0)
                agenda_.add(take_ = begin_ + present_.period - LEAD, Kind::TAKE);
            break;
        case Kind::ARRIVE: arrive(edge); break;
        case Kind::FALL:
            line_.set_led(false, edge);
            break;
        case Kind::BEGIN:
            line_.set_led(present_.on != 0, edge);
            if (present_.on != 0 && present_.on < present_.period)
                agenda_.add(edge + present_.on, Kind::FALL);
            break;
        }
    }
}

void Led::arrive(Time edge)
{
    arrived_.set(edge, sent_);
    if (present_.on == 0)
        plan_take(edge);
}

/** The present period is dark, and other settings may be there from `edge` on. */
void Led::plan_take(Time edge)
{
    const Settings &settings = arrived_.last();
    const Time period = present_.period;

    /* The last beginning that took what was there before, and the next one. */
    begin_ += (edge + LEAD - begin_) / period * period;
    const Time following = begin_ + period - LEAD;
    take_ = NEVER;
    if (settings.on != 0) {
        const Time sees = edge + 1 <= begin_ ? begin_ + 1 : edge + 1;
        take_ = sees + TAKES < following ? sees + TAKES : following;
    } else if (!(settings == present_)) {
        take_ = following;
    }
    if (take_ != NEVER)
        agenda_.add(take_, Kind::TAKE);
}

} // namespace twin
