/* SPDX-License-Identifier: BSD-2-Clause */
#include "quadrature.h"

#include "interlock.h"

namespace twin {

namespace {

constexpr Time SYNCHRONISER = 2; /* from the edge that samples a pin to the one that judges it */
constexpr uint32_t ERRORS_MAX = 0xffff;

static_assert(DECODER_LATENCY == SYNCHRONISER + 1, "the count follows the judgement by a clock");

} // namespace

Quadrature::Quadrature(StepListener &line, Interlock &interlock, unsigned axis, uint64_t pins)
    : line_(line), interlock_(interlock), axis_(axis), a_(pins >> (ENC_A + axis) & 1)
{
    listens = bit(ENC_A + axis) | bit(ENC_B + axis) | bit(ENC_Z + axis);
    const unsigned first[WIRES] = {ENC_A, ENC_B, ENC_Z};
    for (unsigned n = 0; n < WIRES; n++) {
        const bool level = pins >> (first[n] + axis) & 1;
        wire_[n] = {level, level, NEVER};
    }
}

void Quadrature::hold(Time edge)
{
    held_errors_ = errors_.before(edge);
    held_index_ = index_.before(edge);
}

unsigned Quadrature::filter(Time edge) const
{
    for (const Wire &wire : wire_)
        if (wire.change != NEVER)
            return samples_;
    return moved_ < edge - 1 ? settings_.before(edge - 2).filter : samples_;
}

uint32_t Quadrature::read(uint32_t address, Time)
{
    switch (address - axis_ * REG_QUADRATURE_STRIDE) {
    case REG_QUADRATURE_CONFIG: return config_;
    case REG_QUADRATURE_STATUS: return status_.bits;
    case REG_QUADRATURE_ERRORS: return held_errors_;
    case REG_QUADRATURE_INDEX_POSITION: return uint32_t(held_index_);
    default: return 0;
    }
}

void Quadrature::write(uint32_t address, uint32_t value, Time edge)
{
    switch (address - axis_ * REG_QUADRATURE_STRIDE) {
    case REG_QUADRATURE_CONFIG:
        config_ = value & (REG_QUADRATURE_CONFIG_FILTER_MASK | REG_QUADRATURE_CONFIG_INVERT_MASK);
        agenda_.add(edge + SYNC, Kind::SEND, 1);
        break;
    case REG_QUADRATURE_STATUS:
        status_.clear(edge, value);
        break;
    }
}

void Quadrature::input(Time edge, uint64_t, uint64_t pins)
{
    agenda_.add(edge + SYNCHRONISER, Kind::PINS,
                    (pins >> (ENC_A + axis_) & 1) << A | (pins >> (ENC_B + axis_) & 1) << B |
                        (pins >> (ENC_Z + axis_) & 1) << Z);
}

void Quadrature::run(Time edge)
{
    bool judged = false, shown = false;
    unsigned levels = 0;
    while (agenda_.next() == edge) {
        const auto event = agenda_.take();
        switch (event.kind) {
        case Kind::SEND: /* with value: asked for now, otherwise kept until now */
            if (event.value ? handover_.request(edge) : handover_.run(edge)) {
                handed_ = config_;
                agenda_.add(edge + ACTS_IN_FAST, Kind::SETTINGS, handed_);
            } else if (event.value) {
                agenda_.add(handover_.next(), Kind::SEND, 0);
            }
            break;
        case Kind::SETTINGS:
            settings_.set(edge, {field(uint32_t(event.value), REG_QUADRATURE_CONFIG_FILTER_MASK,
                                       REG_QUADRATURE_CONFIG_FILTER_SHIFT),
                                 (event.value & REG_QUADRATURE_CONFIG_INVERT_MASK) != 0});
            break;
        case Kind::PINS: /* of several, the sample has the last */
            levels = unsigned(event.value);
            shown = judged = true;
            break;
        case Kind::CHANGE:
            judged = true;
            break;
        case Kind::ERROR:
            if (errors_.last() != ERRORS_MAX)
                errors_.set(edge, errors_.last() + 1);
            pass(error_crossing_, edge, Kind::ERROR_LEAVES, false);
            break;
        case Kind::INDEX:
            index_.set(edge, count_.before(edge));
            pass(index_crossing_, edge, Kind::INDEX_LEAVES, false);
            break;
        case Kind::ERROR_LEAVES:
            pass(error_crossing_, edge, Kind::ERROR_LEAVES, true);
            break;
        case Kind::INDEX_LEAVES:
            pass(index_crossing_, edge, Kind::INDEX_LEAVES, true);
            break;
        case Kind::SET_ERROR:
            status_.set(edge, REG_QUADRATURE_STATUS_ERROR_MASK);
            interlock_.illegal(axis_, edge);
            break;
        case Kind::SET_INDEX:
            status_.set(edge, REG_QUADRATURE_STATUS_INDEX_MASK);
            break;
        }
    }
    if (shown)
        show_pins(levels, edge);
    if (judged)
        judge(edge);
}

/** The synchronised wires have new levels, which `edge` is the first to judge. */
void Quadrature::show_pins(unsigned levels, Time edge)
{
    for (const Wire &wire : wire_)
        if (wire.change != NEVER)
            moved_ = edge - 1;
    /* A new filter is taken while all stand still, a clock after its setting; `edge - 1` decided on it. */
    samples_ = filter(edge);
    for (unsigned n = 0; n < WIRES; n++) {
        Wire &wire = wire_[n];
        wire.pin = levels >> n & 1;
        if (wire.pin == wire.level) {
            wire.change = NEVER;
        } else if (wire.pin != wire.level && wire.change == NEVER) {
            wire.change = edge + Time(samples_);
            if (wire.change > edge)
                agenda_.add(wire.change, Kind::CHANGE);
        }
    }
}

/** Wires change that have shown their new level long enough. */
void Quadrature::judge(Time edge)
{
    bool change[WIRES];
    for (unsigned n = 0; n < WIRES; n++) {
        change[n] = wire_[n].change == edge;
        if (wire_[n].pin != wire_[n].level)
            moved_ = edge;
    }
    if (change[A] != change[B]) {
        const bool up = (wire_[A].level ^ change[A]) != (wire_[B].level ^ settings_.before(edge).invert);
        const int32_t count = int32_t(uint32_t(count_.last()) + (up ? 1u : ~0u));
        count_.set(edge + 1, count);
        line_.step(axis_, up, count, edge + 1);
        interlock_.step(axis_, up, count, edge + 1);
    } else if (change[A]) {
        agenda_.add(edge + 2, Kind::ERROR);
    }
    if (change[Z] && !wire_[Z].level)
        agenda_.add(edge + 2, Kind::INDEX);
    for (unsigned n = 0; n < WIRES; n++)
        if (change[n]) {
            wire_[n].level = !wire_[n].level;
            wire_[n].change = NEVER;
        }
    if (change[A]) {
        a_.set(edge + 1, wire_[A].level);
        line_.channel_a(axis_, edge + 1);
    }
}

/** A strobe on its way to `Status`; `leaves`: one that was kept. */
void Quadrature::pass(ToSync &crossing, Time edge, Kind kind, bool leaves)
{
    const Kind sets = kind == Kind::ERROR_LEAVES ? Kind::SET_ERROR : Kind::SET_INDEX;
    const bool kept = crossing.next() != NEVER;
    if (leaves ? crossing.run(edge) : crossing.request(edge))
        agenda_.add(acts_in_sync(edge), sets);
    else if (!leaves && !kept)
        agenda_.add(crossing.next(), kind);
}

} // namespace twin
