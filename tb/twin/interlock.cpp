/* SPDX-License-Identifier: BSD-2-Clause */
#include "interlock.h"

#include <algorithm>
#include <cstdlib>

#include "pwm.h"

namespace twin {

namespace {

constexpr uint32_t WATCHDOG = REG_INTERLOCK_FAULTS_WATCHDOG_MASK, ESTOP_FAULT = REG_INTERLOCK_FAULTS_ESTOP_MASK;
constexpr unsigned NO_PROGRESS = REG_INTERLOCK_FAULTS_NO_PROGRESS_SHIFT, TOO_FAST = REG_INTERLOCK_FAULTS_OVER_SPEED_SHIFT,
                   FAR_AWAY = REG_INTERLOCK_FAULTS_FOLLOWING_SHIFT;

constexpr unsigned MEAN_BITS = 6;

constexpr unsigned word(uint32_t address)
{
    return (address - REG_INTERLOCK_FAULTS) / 4;
}

/** Bits that a register keeps, by its word. */
uint32_t kept_bits(uint32_t address)
{
    switch (address) {
    case REG_INTERLOCK_CONTROL: return REG_INTERLOCK_CONTROL_ARMED_MASK | REG_INTERLOCK_CONTROL_HOLD_MASK;
    case REG_INTERLOCK_WAY: return REG_INTERLOCK_WAY_COUNTS_MASK;
    case REG_INTERLOCK_STRONG: return REG_INTERLOCK_STRONG_VALUE_MASK;
    case REG_INTERLOCK_DRIVE_TIME: return REG_INTERLOCK_DRIVE_TIME_VALUE_MASK;
    case REG_INTERLOCK_HELD_MOST: return REG_INTERLOCK_HELD_MOST_VALUE_MASK;
    case REG_INTERLOCK_ILLEGAL_MOST: return REG_INTERLOCK_ILLEGAL_MOST_VALUE_MASK;
    case REG_INTERLOCK_ILLEGAL_TIME: return REG_INTERLOCK_ILLEGAL_TIME_VALUE_MASK;
    }
    if (address < REG_INTERLOCK_STRONG_TIME0)
        return 0;
    return address < REG_INTERLOCK_BREAKAWAY0        ? REG_INTERLOCK_STRONG_TIME0_VALUE_MASK
           : address < REG_INTERLOCK_SPEED_MOST0     ? REG_INTERLOCK_BREAKAWAY0_VALUE_MASK
           : address < REG_INTERLOCK_FOLLOWING_MOST0 ? REG_INTERLOCK_SPEED_MOST0_VALUE_MASK
           : address < REG_INTERLOCK_EXPECTED0       ? REG_INTERLOCK_FOLLOWING_MOST0_VALUE_MASK
                                                     : REG_INTERLOCK_EXPECTED0_VALUE_MASK;
}

} // namespace

Interlock::Interlock(Pwm &pwm, uint64_t pins) : pwm_(pwm), causes_(ESTOP_FAULT), faults_(ESTOP_FAULT), mask_((1u << AXES) - 1)
{
    listens = bit(ESTOP);
    registers_[word(REG_INTERLOCK_WAY)] = REG_INTERLOCK_WAY_COUNTS_RESET;
    registers_[word(REG_INTERLOCK_STRONG)] = REG_INTERLOCK_STRONG_VALUE_RESET;
    registers_[word(REG_INTERLOCK_DRIVE_TIME)] = REG_INTERLOCK_DRIVE_TIME_VALUE_RESET;
    registers_[word(REG_INTERLOCK_HELD_MOST)] = REG_INTERLOCK_HELD_MOST_VALUE_RESET;
    registers_[word(REG_INTERLOCK_ILLEGAL_TIME)] = REG_INTERLOCK_ILLEGAL_TIME_VALUE_RESET;
    for (unsigned n = 0; n < AXES; n++) {
        registers_[word(REG_INTERLOCK_STRONG_TIME0) + n] = REG_INTERLOCK_STRONG_TIME0_VALUE_RESET;
        registers_[word(REG_INTERLOCK_BREAKAWAY0) + n] = REG_INTERLOCK_BREAKAWAY0_VALUE_RESET;
        registers_[word(REG_INTERLOCK_SPEED_MOST0) + n] = REG_INTERLOCK_SPEED_MOST0_VALUE_RESET;
    }
    /* The stop holds until the pin has been seen. */
    agenda_.add(SYNC, Kind::STOP, pins >> ESTOP & 1);
    plan();
}

uint32_t Interlock::limit(uint32_t address, unsigned axis) const
{
    return registers_[word(address) + axis];
}

/* --- Way --------------------------------------------------------------------------------------------------------- */

/** What a sample judged at `edge` has for an excess: that of the clock before. */
int32_t Interlock::excess(const Axis &a, unsigned axis, Time edge) const
{
    const bool hold = control_.before(edge - SYNC) >> REG_INTERLOCK_CONTROL_HOLD_SHIFT >> axis & 1;
    return a.drive.before(edge - SYNC) - (hold ? a.reference.before(edge - SYNC) : 0);
}

void Interlock::judge(unsigned axis, int64_t number, int step)
{
    Axis &a = axes_[axis];
    const Time edge = judged(number);
    a.at += step;
    a.low = std::min(a.low, a.at);
    a.high = std::max(a.high, a.at);
    const bool made = unsigned(a.high - a.low) >= limit(REG_INTERLOCK_WAY);
    const int32_t now = excess(a, axis, edge);
    const uint32_t size = uint32_t(std::abs(now));
    const bool hold = control_.before(edge - SYNC) >> REG_INTERLOCK_CONTROL_HOLD_SHIFT >> axis & 1, forward = now >= 0;
    const uint32_t least = hold ? limit(REG_INTERLOCK_HELD_MOST) : limit(REG_INTERLOCK_BREAKAWAY0, axis);
    const auto go_on = [&](uint32_t &run, bool counts, uint32_t most) {
        if (made || !counts || forward != a.forward)
            run = counts && !made;
        else if (run <= most)
            run++;
    };
    go_on(a.strong_for, size >= limit(REG_INTERLOCK_STRONG) && !hold, limit(REG_INTERLOCK_STRONG_TIME0, axis));
    go_on(a.weak_for, size >= least, limit(REG_INTERLOCK_DRIVE_TIME));
    a.forward = forward;
    if (made) {
        a.at = a.low = a.high = 0;
        const int32_t reference = a.mean >> MEAN_BITS;
        if (reference != a.reference.last()) {
            a.reference.set(edge, reference);
            eager_ = 2;
        }
    }
}

/** Samples from `first` on in which the count stands. */
void Interlock::pass(unsigned axis, int64_t samples, int64_t first)
{
    Axis &a = axes_[axis];
    for (; samples > 4; samples--, first++) {
        const uint32_t strong = a.strong_for, weak = a.weak_for;
        judge(axis, first, 0);
        /* Each of them adds one, or nothing. */
        if (a.strong_for - strong > 1 || a.weak_for - weak > 1 || a.forward != (excess(a, axis, judged(first + 1)) >= 0))
            continue;
        const int64_t more = samples - 4;
        const auto add = [more](uint32_t &run, uint32_t before, uint32_t most) {
            if (run != before)
                run = uint32_t(std::min<int64_t>(run + more, std::max<int64_t>(run, int64_t(most) + 1)));
        };
        add(a.strong_for, strong, limit(REG_INTERLOCK_STRONG_TIME0, axis));
        add(a.weak_for, weak, limit(REG_INTERLOCK_DRIVE_TIME));
        first += more;
        samples -= more;
    }
    for (; samples > 0; samples--, first++)
        judge(axis, first, 0);
}

/** All samples before one have been judged, or are now: nothing happens in them. */
void Interlock::samples_to(int64_t last)
{
    if (last <= next_)
        return;
    for (unsigned axis = 0; axis < AXES; axis++)
        pass(axis, last - next_, next_);
    next_ = last;
}

void Interlock::sample(int64_t number)
{
    const Time edge = judged(number);
    samples_to(number);
    if (eager_ > 0)
        eager_--;
    for (unsigned axis = 0; axis < AXES; axis++) {
        Axis &a = axes_[axis];
        const int step = moved_ ? a.captured - a.count.last() : 0;
        judge(axis, number, step);
        a.window += step;
        if (step == 0)
            continue;
        a.count.set(edge, a.captured);
        const int64_t error = int64_t(int32_t(uint32_t(a.captured) - uint32_t(a.expected.last())));
        if (a.far || std::abs(error) + 2 * SAMPLE > int64_t(a.most.last()))
            agenda_.add(edge + 2 * SYNC, Kind::FAR);
    }
    moved_ = false;
    next_ = number + 1;
    if (next_ % WINDOW == 0)
        end_window();
    refresh(edge);
}

void Interlock::end_window()
{
    const bool anew = windows_left_ == 0;
    windows_left_ = (anew ? limit(REG_INTERLOCK_ILLEGAL_TIME) - 1 : windows_left_ - 1) & 0xffff;
    for (unsigned axis = 0; axis < AXES; axis++) {
        Axis &a = axes_[axis];
        a.mean += a.drive.before(judged(next_ - 1)) - (a.mean >> MEAN_BITS);
        a.too_fast = uint32_t(std::abs(a.window)) > limit(REG_INTERLOCK_SPEED_MOST0, axis);
        a.window = 0;
        if (anew)
            a.events = 0;
    }
}

/* --- Causes ------------------------------------------------------------------------------------------------------ */

/** Whether the error is too large, as known from `edge` on. */
bool Interlock::is_far(unsigned axis, Time edge) const
{
    const Axis &a = axes_[axis];
    const int64_t error = int32_t(uint32_t(a.count.before(edge - SYNC)) - uint32_t(a.expected.before(edge - SYNC)));
    return (control_.before(edge - SYNC) >> axis & 1) && std::abs(error) > int64_t(a.most.before(edge));
}

uint32_t Interlock::level() const
{
    uint32_t result = (causes_.last() & ESTOP_FAULT) | (watchdog_ ? WATCHDOG : 0);
    for (unsigned n = 0; n < AXES; n++) {
        const Axis &a = axes_[n];
        const bool stands = a.strong_for > limit(REG_INTERLOCK_STRONG_TIME0, n) || a.weak_for > limit(REG_INTERLOCK_DRIVE_TIME);
        result |= uint32_t(a.events > limit(REG_INTERLOCK_ILLEGAL_MOST)) << n | uint32_t(stands) << (NO_PROGRESS + n) |
                  uint32_t(a.too_fast) << (TOO_FAST + n) | uint32_t(a.far && (control_.last() >> n & 1)) << (FAR_AWAY + n);
    }
    return result;
}

/** From `edge` on the causes are what they are now. */
void Interlock::refresh(Time edge)
{
    const uint32_t now = level();
    if (now == causes_.last())
        return;
    causes_.set(edge, now);
    agenda_.add(edge + SYNC, Kind::LATCH);
}

void Interlock::keep(uint32_t faults, Time edge)
{
    if (faults != faults_.last())
        faults_.set(edge, faults);
    uint32_t mask = 0;
    for (unsigned n = 0; n < AXES; n++)
        mask |= uint32_t((faults & (0x1111u << n | WATCHDOG)) != 0 || (causes_.last() & ESTOP_FAULT) != 0) << n;
    if (mask != mask_)
        pwm_.inhibit(mask_ = mask, edge);
}

/* --- What happens ------------------------------------------------------------------------------------------------ */

void Interlock::plan()
{
    int64_t next = eager_ || moved_ ? next_ : (next_ / WINDOW + 1) * WINDOW - 1;
    for (unsigned n = 0; n < AXES; n++) {
        const Axis &a = axes_[n];
        const auto rises = [&](uint32_t run, uint32_t most) {
            if (run != 0 && run <= most)
                next = std::min(next, next_ + int64_t(most - run));
        };
        rises(a.strong_for, limit(REG_INTERLOCK_STRONG_TIME0, n));
        rises(a.weak_for, limit(REG_INTERLOCK_DRIVE_TIME));
    }
    sample_due_ = judged(next);
    due = std::min(agenda_due_, sample_due_);
}

void Interlock::drive(unsigned axis, int32_t steps, Time edge)
{
    if (axes_[axis].drive.last() == steps)
        return;
    samples_to(sample_after(edge));
    axes_[axis].drive.set(edge, steps);
    eager_ = 2;
    refresh(edge);
    plan();
}

void Interlock::illegal(unsigned axis, Time edge)
{
    axes_[axis].events = std::min(axes_[axis].events + 1, 256u);
    refresh(edge);
    plan();
}

void Interlock::expired(Time edge)
{
    watchdog_ = true;
    refresh(edge);
    agenda_.add(edge + SYNC, Kind::CALM);
    plan();
}

void Interlock::step(unsigned axis, bool, int32_t count, Time edge)
{
    axes_[axis].now.set(edge, count);
    if (!capturing_)
        capture_after(edge);
}

void Interlock::capture_after(Time edge)
{
    capturing_ = true;
    agenda_.add(edge / SAMPLE * SAMPLE + CAPTURED, Kind::CAPTURE);
    due = std::min(agenda_due_, sample_due_);
}

void Interlock::input(Time edge, uint64_t, uint64_t pins)
{
    agenda_.add(sync_from(edge) + SYNC, Kind::STOP, pins >> ESTOP & 1);
    due = std::min(agenda_due_, sample_due_);
}

void Interlock::run(Time edge)
{
    while (agenda_.next() == edge) {
        const auto event = agenda_.take();
        switch (event.kind) {
        case Kind::LATCH:
            keep(faults_.last() | causes_.before(edge), edge);
            break;
        case Kind::STOP: {
            const uint32_t now = (causes_.last() & ~ESTOP_FAULT) | (event.value ? ESTOP_FAULT : 0);
            if (now == causes_.last())
                break;
            causes_.set(edge, now);
            agenda_.add(edge + SYNC, Kind::LATCH);
            keep(faults_.last(), edge);
            break;
        }
        case Kind::CALM:
            watchdog_ = false;
            refresh(edge);
            break;
        case Kind::FAR:
            for (unsigned n = 0; n < AXES; n++)
                axes_[n].far = is_far(n, edge);
            refresh(edge);
            break;
        case Kind::CAPTURE:
            capturing_ = false;
            moved_ = true;
            for (Axis &a : axes_)
                a.captured = a.now.before(edge);
            samples_to((edge - CAPTURED) / SAMPLE);
            if (std::any_of(axes_, axes_ + AXES, [](const Axis &a) { return a.captured != a.now.last(); }))
                capture_after(edge);
            break;
        }
    }
    if (sample_due_ == edge)
        sample((edge - JUDGED) / SAMPLE);
    plan();
}

uint32_t Interlock::read(uint32_t address, Time edge)
{
    switch (address) {
    case REG_INTERLOCK_FAULTS: return faults_.before(edge);
    case REG_INTERLOCK_CAUSES: return causes_.before(edge);
    case REG_INTERLOCK_CLEAR: return 0;
    default: return registers_[word(address)];
    }
}

void Interlock::write(uint32_t address, uint32_t value, Time edge)
{
    samples_to(sample_after(edge));
    if (address == REG_INTERLOCK_CLEAR) {
        keep((faults_.last() & ~value) | causes_.before(edge), edge);
        plan();
        return;
    }
    uint32_t &stored = registers_[word(address)];
    stored = value & kept_bits(address);
    if (address == REG_INTERLOCK_CONTROL)
        control_.set(edge, stored);
    for (unsigned n = 0; n < AXES; n++) {
        if (axes_[n].expected.last() != int32_t(limit(REG_INTERLOCK_EXPECTED0, n)))
            axes_[n].expected.set(edge, int32_t(limit(REG_INTERLOCK_EXPECTED0, n)));
        if (axes_[n].most.last() != limit(REG_INTERLOCK_FOLLOWING_MOST0, n))
            axes_[n].most.set(edge, limit(REG_INTERLOCK_FOLLOWING_MOST0, n));
    }
    if (address == REG_INTERLOCK_CONTROL || address >= REG_INTERLOCK_FOLLOWING_MOST0) {
        agenda_.add(edge + SYNC, Kind::FAR);
        agenda_.add(edge + 2 * SYNC, Kind::FAR);
    }
    eager_ = 2;
    refresh(edge);
    plan();
}

} // namespace twin
