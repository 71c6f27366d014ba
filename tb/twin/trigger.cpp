/* SPDX-License-Identifier: BSD-2-Clause */
#include "trigger.h"

#include <algorithm>

namespace twin {

namespace {

constexpr Time SYNCHRONISER = 2; /* from the edge that samples a pin to the one that sees the level */
constexpr unsigned MINIMUM = REG_TRIGGER_CONFIG_MINIMUM_RESET;
constexpr uint32_t CONFIG = REG_TRIGGER_CONFIG_ENABLE_MASK | REG_TRIGGER_CONFIG_OUTPUT_MASK |
                            REG_TRIGGER_CONFIG_FALLING_MASK | REG_TRIGGER_CONFIG_MINIMUM_MASK;

} // namespace

Trigger::Trigger(Outputs &outputs, Quadrature (&encoders)[AXES], uint64_t pins, uint64_t init)
    : outputs_(outputs), encoders_(encoders), init_(init), config_(MINIMUM << REG_TRIGGER_CONFIG_MINIMUM_SHIFT),
      settings_({MINIMUM, false, false, false}), in0_(pins >> IN0 & 1)
{
    listens = bit(IN0);
    /* After reset a pause is due; the first edge sees whether it begins with it. */
    agenda_.add(0, Kind::LOOK);
}

uint32_t Trigger::read(uint32_t address, Time)
{
    switch (address) {
    case REG_TRIGGER_CONFIG: return config_;
    case REG_TRIGGER_INTERRUPT_ENABLE: return interrupt_enable_;
    case REG_TRIGGER_LEVEL: return queue_.level();
    case REG_TRIGGER_MISSED: return missed_;
    case REG_TRIGGER_NEXT: return 0;
    default: return queue_.output().words[(address - REG_TRIGGER_TIME_LOW) / 4];
    }
}

void Trigger::write(uint32_t address, uint32_t value, Time edge)
{
    switch (address) {
    case REG_TRIGGER_CONFIG:
        config_ = value & CONFIG;
        agenda_.add(edge + SYNC, Kind::SEND, 1);
        break;
    case REG_TRIGGER_INTERRUPT_ENABLE:
        interrupt_enable_ = value & REG_TRIGGER_INTERRUPT_ENABLE_WAITING_MASK;
        queue_moved(edge);
        break;
    case REG_TRIGGER_NEXT:
        if (value & REG_TRIGGER_NEXT_TAKE_MASK) {
            queue_.clock(edge, true);
            queue_moved(edge);
        }
        break;
    }
}

void Trigger::input(Time edge, uint64_t, uint64_t pins)
{
    in0_.set(edge + SYNCHRONISER - 1, pins >> IN0 & 1);
    agenda_.add(edge + SYNCHRONISER, Kind::LOOK);
}

void Trigger::out0(Time edge, bool level)
{
    if (level == out0_.last())
        return;
    out0_.set(edge + SYNCHRONISER, level);
    agenda_.add(edge + 1 + SYNCHRONISER, Kind::LOOK);
}

void Trigger::run(Time edge)
{
    while (agenda_.next() == edge) {
        const auto event = agenda_.take();
        switch (event.kind) {
        case Kind::SEND: /* with value: asked for now, otherwise kept until now */
            if (event.value ? handover_.request(edge) : handover_.run(edge))
                agenda_.add(edge + ACTS_IN_FAST, Kind::SETTINGS, config_);
            else if (event.value)
                agenda_.add(handover_.next(), Kind::SEND, 0);
            break;
        case Kind::SETTINGS: {
            const uint32_t config = uint32_t(event.value);
            settings_.set(edge, {std::max(MINIMUM, unsigned(field(config, REG_TRIGGER_CONFIG_MINIMUM_MASK,
                                                                  REG_TRIGGER_CONFIG_MINIMUM_SHIFT))),
                                 (config & REG_TRIGGER_CONFIG_ENABLE_MASK) != 0,
                                 (config & REG_TRIGGER_CONFIG_OUTPUT_MASK) != 0,
                                 (config & REG_TRIGGER_CONFIG_FALLING_MASK) != 0});
            settled_ = edge + 1;
            agenda_.add(edge + 1, Kind::LOOK);
            break;
        }
        case Kind::LOOK:
            look(edge);
            break;
        case Kind::TAKE:
            if (takes_[event.value] == edge)
                capture_.words[2 + event.value] = uint32_t(encoders_[event.value].count(edge));
            break;
        case Kind::RECORD:
            if (state_ != PULSE || began_ != Time(event.value))
                break;
            state_ = PAUSE;
            rests_ = NEVER; /* the level is high */
            agenda_.add(edge + 1, Kind::LEAVE);
            break;
        case Kind::REST:
            if (state_ == PAUSE && rests_ == edge)
                state_ = IDLE;
            break;
        case Kind::LEAVE: /* records come further apart than the crossing takes */
            crossing_.request(edge);
            hold_ = capture_;
            agenda_.add(acts_in_sync(edge), Kind::QUEUE);
            break;
        case Kind::QUEUE:
            if (queue_.put(edge, hold_))
                queue_moved(edge);
            else
                missed_ += missed_ != UINT32_MAX;
            break;
        case Kind::MOVE:
            if (queue_.moves())
                queue_.clock(edge, false);
            break;
        }
    }
}

/** What an edge sees, by the settings it sees. */
bool Trigger::level(Time edge) const
{
    const Settings &settings = settings_.before(edge);
    return (settings.output ? out0_ : in0_).before(edge) != settings.falling;
}

void Trigger::look(Time edge)
{
    const bool now = level(edge), changed = now != was_;
    const Settings &settings = settings_.before(edge);

    was_ = now;
    if (!changed)
        return;
    if (state_ == PULSE && !now) {
        state_ = IDLE;
    } else if (state_ == PAUSE) {
        /* What is left of it was loaded by the edge before, the last that saw the level high. */
        rests_ = now ? NEVER : edge + Time(settings_.before(edge - 1).minimum) - 1;
        if (!now)
            agenda_.add(rests_, Kind::REST);
    } else if (state_ == IDLE && now && settings.enable && edge != settled_) {
        const uint64_t moment = init_ + uint64_t(edge) + 1;

        state_ = PULSE;
        began_ = edge;
        capture_.words[0] = uint32_t(moment);
        capture_.words[1] = uint32_t(moment >> 32);
        for (unsigned axis = 0; axis < AXES; axis++) {
            takes_[axis] = edge + SYNCHRONISER + Time(encoders_[axis].filter(edge));
            agenda_.add(takes_[axis], Kind::TAKE, axis);
        }
        agenda_.add(edge + Time(settings.minimum) - 1, Kind::RECORD, uint64_t(edge));
    }
}

/** The queue did something, or the interrupt was enabled. */
void Trigger::queue_moved(Time edge)
{
    if (queue_.moves())
        agenda_.add(sync_after(edge), Kind::MOVE);
    outputs_.set(edge, INTERRUPT + INTERRUPT_TRIGGER, interrupt_enable_ && queue_.level());
}

} // namespace twin
