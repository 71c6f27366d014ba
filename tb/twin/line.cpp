/* SPDX-License-Identifier: BSD-2-Clause */
#include "line.h"

namespace twin {

namespace {

/* From a step to the verdict whether it crosses the reference or makes progress: axis selector 1, compare 2. From
 * there to the pulse or the edge of SYNC: completion of a pixel 1, pulse 1. From these to the pins: the router. */
constexpr Time VERDICT = 3, PULSE = LINE_LATENCY - VERDICT - ROUTER_LATENCY;
static_assert(PULSE == 2, "the line of which this is the model");

/* Requests of the report and of the live settings leave again as soon as they may, from reset on. */
constexpr Time ROUND = 4 * SYNC, CAPTURED = ACTS_IN_FAST, REPORTED = ROUND;

constexpr uint64_t pack(unsigned axis, bool up, int32_t count)
{
    return uint64_t(axis) << 33 | uint64_t(up) << 32 | uint32_t(count);
}

constexpr uint64_t DONE = bit(32); /* of a PIXEL, above the count */

} // namespace

bool Line::Live::operator==(const Live &other) const
{
    return router[PIN_OUT0] == other.router[PIN_OUT0] && router[PIN_SYNC] == other.router[PIN_SYNC] &&
           router[PIN_ENCODER] == other.router[PIN_ENCODER] && width == other.width && axis == other.axis;
}

Line::Line(Outputs &outputs, Quadrature (&encoders)[AXES], Trigger &trigger)
    : outputs_(outputs), encoders_(encoders), trigger_(trigger)
{
    registers_.phase = REG_DIVIDER_PHASE_VALUE_RESET;
    live_ = {{REG_ROUTER_OUT0_SOURCE_RESET, REG_ROUTER_SYNC_SOURCE_RESET, REG_ROUTER_ENCODER_SOURCE_RESET}, 0, 0};
    Live reset = live_;
    live_in_force_ = Past<Live>(reset);
    live_sent_ = reset;
    agenda_.add(0, Kind::SEND_LIVE);
    agenda_.add(0, Kind::DIRECT);
}

/* --- Registers ----------------------------------------------------------------------------------------------- */

uint32_t Line::read(uint32_t address, Time)
{
    switch (address) {
    case REG_COMPARE_CONFIG:
        return registers_.compare_axis << REG_COMPARE_CONFIG_AXIS_SHIFT |
               (registers_.reverse ? REG_COMPARE_CONFIG_REVERSE_MASK : 0);
    case REG_COMPARE_REFERENCE: return uint32_t(registers_.reference);
    case REG_COMPARE_STATUS:
        return (report_.armed ? REG_COMPARE_STATUS_ARMED_MASK : 0) |
               (report_.active ? REG_COMPARE_STATUS_ACTIVE_MASK : 0) |
               (report_.late ? REG_COMPARE_STATUS_LATE_MASK : 0) |
               (waiting_ || ticket_ != report_.ticket ? REG_COMPARE_STATUS_BUSY_MASK : 0);
    case REG_COMPARE_INTERRUPT: return events_.bits;
    case REG_DIVIDER_AXIS: return registers_.divider_axis;
    case REG_DIVIDER_WHOLE: return registers_.whole;
    case REG_DIVIDER_FRACTION: return registers_.fraction;
    case REG_DIVIDER_PHASE: return registers_.phase;
    case REG_DIVIDER_PIXELS: return registers_.pixels;
    case REG_DIVIDER_WIDTH: return live_.width;
    case REG_DIVIDER_INTERVAL_MIN: return interval_min_;
    case REG_DIVIDER_CONFIG: return registers_.emit ? REG_DIVIDER_CONFIG_EMIT_MASK : 0;
    case REG_DIVIDER_STATUS:
        return (refused_ ? REG_DIVIDER_STATUS_REFUSED_MASK : 0) |
               (report_.merged ? REG_DIVIDER_STATUS_MERGED_MASK : 0);
    case REG_DIVIDER_PRODUCED: return report_.produced;
    case REG_DIVIDER_END_POSITION: return report_.end_position;
    case REG_DIVIDER_MERGED: return report_.merged;
    case REG_ROUTER_OUT0: return live_.router[PIN_OUT0];
    case REG_ROUTER_SYNC: return live_.router[PIN_SYNC];
    case REG_ROUTER_ENCODER: return live_.router[PIN_ENCODER];
    default: return 0;
    }
}

void Line::write(uint32_t address, uint32_t value, Time edge)
{
    constexpr uint32_t ROUTE = REG_ROUTER_OUT0_SOURCE_MASK | REG_ROUTER_OUT0_INVERT_MASK;

    switch (address) {
    case REG_COMPARE_CONFIG:
        registers_.compare_axis = field(value, REG_COMPARE_CONFIG_AXIS_MASK, REG_COMPARE_CONFIG_AXIS_SHIFT);
        registers_.reverse = (value & REG_COMPARE_CONFIG_REVERSE_MASK) != 0;
        break;
    case REG_COMPARE_REFERENCE: registers_.reference = int32_t(value); break;
    case REG_COMPARE_CONTROL: command(value, edge); break;
    case REG_COMPARE_INTERRUPT:
        events_.clear(edge, value);
        show_interrupt(edge);
        break;
    case REG_DIVIDER_AXIS: registers_.divider_axis = live_.axis = value & REG_DIVIDER_AXIS_VALUE_MASK; break;
    case REG_DIVIDER_WHOLE: registers_.whole = value; break;
    case REG_DIVIDER_FRACTION: registers_.fraction = value; break;
    case REG_DIVIDER_PHASE: registers_.phase = value; break;
    case REG_DIVIDER_PIXELS: registers_.pixels = value; break;
    case REG_DIVIDER_WIDTH: live_.width = value & REG_DIVIDER_WIDTH_VALUE_MASK; break;
    case REG_DIVIDER_INTERVAL_MIN: interval_min_ = value; break;
    case REG_DIVIDER_CONFIG: registers_.emit = (value & REG_DIVIDER_CONFIG_EMIT_MASK) != 0; break;
    case REG_ROUTER_OUT0: live_.router[PIN_OUT0] = value & ROUTE; break;
    case REG_ROUTER_SYNC: live_.router[PIN_SYNC] = value & ROUTE; break;
    case REG_ROUTER_ENCODER: live_.router[PIN_ENCODER] = value & ROUTE; break;
    default: return;
    }
    agenda_.add((edge + ROUND) / ROUND * ROUND, Kind::SEND_LIVE);
}

bool Line::refuses() const
{
    return registers_.whole == 0 || registers_.pixels == 0 || live_.width == 0 || live_.width + 2 > interval_min_;
}

void Line::command(uint32_t control, Time edge)
{
    const bool arm = control & REG_COMPARE_CONTROL_ARM_MASK, disarm = control & REG_COMPARE_CONTROL_DISARM_MASK;
    if (!arm && !disarm)
        return;
    if (!disarm)
        refused_ = refuses();
    arming_ = !disarm && !refuses();
    if (!waiting_) {
        waiting_ = true;
        consider_sending(edge + SYNC);
    }
}

/** `edge` is the first to see that something changed which a command waits for. */
void Line::consider_sending(Time edge)
{
    if (edge > may_send_)
        may_send_ = edge;
    if (waiting_ && ticket_ == report_.ticket)
        agenda_.add(may_send_ > crossing_.free() ? may_send_ : crossing_.free(), Kind::SEND);
}

void Line::send_live(Time edge)
{
    if (live_ == live_sent_)
        return;
    live_sent_ = live_;
    agenda_.add(edge + ACTS_IN_FAST, Kind::LIVE);
}

void Line::show_interrupt(Time edge)
{
    outputs_.set(edge, INTERRUPT + INTERRUPT_LINE, events_.bits != 0);
}

void Line::report(Time edge)
{
    const uint32_t events = (captured_.started != report_.started ? REG_COMPARE_INTERRUPT_STARTED_MASK : 0) |
                            (captured_.finished != report_.finished ? REG_COMPARE_INTERRUPT_FINISHED_MASK : 0) |
                            (captured_.went_late != report_.went_late ? REG_COMPARE_INTERRUPT_LATE_MASK : 0);
    const bool answered = captured_.ticket != report_.ticket;
    report_ = captured_;
    events_.set(edge, events);
    show_interrupt(edge);
    if (answered)
        consider_sending(edge + SYNC);
}

/* --- The line ------------------------------------------------------------------------------------------------ */

void Line::run(Time edge)
{
    while (agenda_.next() == edge) {
        const auto event = agenda_.take();
        switch (event.kind) {
        case Kind::CAPTURE:
            captured_ = state_;
            agenda_.add(edge - CAPTURED + REPORTED, Kind::REPORT);
            break;
        case Kind::REPORT: report(edge); break;
        case Kind::SEND:
            if (waiting_ && ticket_ == report_.ticket && edge >= may_send_ && crossing_.request(edge)) {
                waiting_ = false;
                ticket_ = !ticket_;
                sent_ = {arming_, ticket_, registers_};
                agenda_.add(edge + ACTS_IN_FAST, Kind::COMMAND);
            }
            break;
        case Kind::SEND_LIVE: send_live(edge); break;
        case Kind::SHOW: show_pins(edge); break;
        case Kind::COMMAND:
            command_ = sent_;
            ends_ = edge + 1;
            watching_ |= command_.arm;
            emit_.set(edge, command_.settings.emit);
            agenda_.add(edge + 1, Kind::END);
            agenda_.add(edge + 2, Kind::PRIMED);
            agenda_.add(edge + VERDICT, Kind::JUDGE);
            break;
        case Kind::STEP: verdict(event.value, edge); break;
        case Kind::PIXEL: pixel(event.value, edge); break;
        case Kind::STARTED:
            state_.started = (state_.started + 1) % 4;
            touch(edge);
            break;
        case Kind::SYNC_RISES:
            set_sync(active_.before(edge) && active_.before(edge - 1), edge);
            break;
        case Kind::END: end(edge); break;
        case Kind::PRIMED:
            set_sync(false, edge);
            if (command_.arm)
                state_.produced = state_.end_position = state_.merged = 0;
            touch(edge);
            break;
        case Kind::JUDGE: judge(edge); break;
        case Kind::JUDGED:
            state_.ticket = command_.ticket;
            state_.went_late = (state_.went_late + state_.late) % 4;
            touch(edge);
            break;
        case Kind::FALL:
            if (falls_ == edge)
                set_pulse(false, edge);
            break;
        case Kind::LIVE:
            live_in_force_.set(edge, live_sent_);
            agenda_.add(edge + ROUTER_LATENCY, Kind::SHOW);
            agenda_.add(edge + 1, Kind::DIRECT);
            break;
        case Kind::DIRECT: {
            const bool level = encoders_[live_in_force_.before(edge).axis].a(edge);
            if (level != direct_taken_)
                agenda_.add(edge + LINE_LATENCY - ROUTER_LATENCY - 1, Kind::DIRECT_OUT, level);
            direct_taken_ = level;
            break;
        }
        case Kind::DIRECT_OUT:
            direct_.set(edge, event.value);
            agenda_.add(edge + ROUTER_LATENCY, Kind::SHOW);
            break;
        }
    }
}

/** The state changes from `edge` on: the first capture that sees it takes it along. */
void Line::touch(Time edge)
{
    const Time capture = (edge - CAPTURED + ROUND) / ROUND * ROUND + CAPTURED;
    if (capture != capture_)
        agenda_.add(capture, Kind::CAPTURE);
    capture_ = capture;
}

void Line::step(unsigned axis, bool up, int32_t count, Time edge)
{
    if (watching_)
        agenda_.add(edge + VERDICT, Kind::STEP, pack(axis, up, count));
}

void Line::channel_a(unsigned axis, Time edge)
{
    if (live_in_force_.last().axis == axis)
        agenda_.add(edge + 1, Kind::DIRECT);
}

void Line::end(Time edge)
{
    const Settings &settings = command_.settings;

    line_ = settings;
    target_ = int32_t(uint32_t(settings.reference) - settings.reverse);
    judged_count_ = encoders_[settings.compare_axis].count(edge);
    armed_.set(edge, false);
    active_.set(edge, false);
    state_.armed = state_.active = state_.late = false;
    watching_ = command_.arm;
    if (command_.arm) {
        const uint64_t place = uint64_t(settings.phase) + settings.fraction;
        edges_left_ = settings.whole + (place >> 32);
        fraction_ = uint32_t(place);
        pixels_left_ = settings.pixels;
    }
    touch(edge);
}

void Line::judge(Time edge)
{
    if (command_.arm) {
        const int32_t past = int32_t(uint32_t(judged_count_) - uint32_t(target_));
        const bool reached = past == 0 || (past < 0) == line_.reverse;
        armed_.set(edge, !reached);
        state_.armed = watching_ = !reached;
        state_.late = reached;
        touch(edge);
    }
    agenda_.add(edge + 1, Kind::JUDGED);
}

void Line::verdict(uint64_t packed, Time edge)
{
    const unsigned axis = unsigned(packed >> 33);
    const bool forward = bool(packed >> 32 & 1) != line_.reverse;
    const int32_t count = int32_t(uint32_t(packed));

    if (armed_.before(edge) && edge != ends_ && axis == line_.compare_axis && forward && count == target_) {
        armed_.set(edge, false);
        active_.set(edge, true);
        state_.armed = false;
        state_.active = true;
        behind_ = 0;
        touch(edge);
        agenda_.add(edge + 1, Kind::STARTED);
        agenda_.add(edge + PULSE, Kind::SYNC_RISES);
    }
    if (edge == ends_ && command_.arm)
        return;
    if (active_.before(edge) && axis == line_.divider_axis)
        progress(forward, count, edge);
}

void Line::progress(bool forward, int32_t count, Time edge)
{
    if (!forward) {
        behind_++;
    } else if (behind_ != 0) {
        behind_--;
    } else if (pixels_left_ != 0 && --edges_left_ == 0) {
        const uint64_t place = uint64_t(fraction_) + line_.fraction;
        edges_left_ = line_.whole + (place >> 32);
        fraction_ = uint32_t(place);
        pixels_left_--;
        agenda_.add(edge + PULSE, Kind::PIXEL, uint32_t(count) | (pixels_left_ == 0 ? DONE : 0));
    }
}

void Line::pixel(uint64_t packed, Time edge)
{
    if (packed & DONE) {
        active_.set(edge, false);
        state_.active = false;
        watching_ = watching_ && ends_ >= edge - PULSE; /* which is for the next line */
        state_.finished = (state_.finished + 1) % 4;
        set_sync(false, edge);
    }
    state_.produced++;
    state_.end_position = uint32_t(packed);
    if (emit_.before(edge - 1))
        trigger(edge);
    touch(edge);
}

/** A pulse rises, or is made longer; its length is that of the clock before, or of the last one if that began there. */
void Line::trigger(Time edge)
{
    if (triggered_ != edge - 1) {
        const uint32_t width = live_in_force_.before(edge - 1).width;
        width_ = width != 0 ? width : 1;
    }
    if (pulse_.before(edge))
        state_.merged++;
    triggered_ = edge;
    falls_ = edge + width_;
    set_pulse(true, edge);
    agenda_.add(falls_, Kind::FALL);
}

void Line::set_sync(bool level, Time edge)
{
    if (level != sync_.last())
        agenda_.add(edge + ROUTER_LATENCY, Kind::SHOW);
    sync_.set(edge, level);
}

void Line::set_pulse(bool level, Time edge)
{
    if (level != pulse_.last())
        agenda_.add(edge + ROUTER_LATENCY, Kind::SHOW);
    pulse_.set(edge, level);
}

void Line::set_led(bool level, Time edge)
{
    if (level != led_.last())
        agenda_.add(edge + ROUTER_LATENCY, Kind::SHOW);
    led_.set(edge, level);
}

void Line::show_pins(Time edge)
{
    const Time routed = edge - ROUTER_LATENCY + 1;
    constexpr unsigned pins[PINS] = {OUT0, SYNC_OUT, ENCODER_OUT};
    const bool levels[] = {false, true, sync_.before(routed), pulse_.before(routed), direct_.before(routed),
                           led_.before(routed)};
    const Live &live = live_in_force_.before(routed);

    for (unsigned pin = 0; pin < PINS; pin++) {
        const uint32_t source = field(live.router[pin], REG_ROUTER_OUT0_SOURCE_MASK, REG_ROUTER_OUT0_SOURCE_SHIFT);
        const bool level = source < sizeof levels ? levels[source] : false;
        outputs_.set(edge, pins[pin], level != bool(live.router[pin] & REG_ROUTER_OUT0_INVERT_MASK));
    }
    trigger_.out0(edge, outputs_.levels >> OUT0 & 1);
}

} // namespace twin
