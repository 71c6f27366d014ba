/* SPDX-License-Identifier: BSD-2-Clause */
#include "classifier.h"

namespace twin {

namespace {

constexpr Time SYNCHRONISER = 2; /* from the edge that samples the pin to the one that sees its level */
constexpr uint32_t LOST_MAX = 0xffff, BATCH = 8;

unsigned length(uint32_t batch)
{
    unsigned count = 0;
    while (batch >> (count + 1))
        count++;
    return count;
}

} // namespace

Classifier::Classifier(uint64_t pins) : pin_(pins >> IN0 & 1), level_(pin_)
{
    listens = bit(IN0);
}

uint32_t Classifier::read(uint32_t address, Time edge)
{
    switch (address) {
    case REG_CLASSIFIER_THRESHOLD: return written_.threshold;
    case REG_CLASSIFIER_CONFIG: return written_.config;
    case REG_CLASSIFIER_DECISIONS:
        agenda_.add(edge, Kind::POP);
        plan();
        return fifo_.ready() ? fifo_.output() : 1;
    case REG_CLASSIFIER_STATUS: return fifo_.level();
    case REG_CLASSIFIER_LOST: /* a clock behind the sum */
        return std::min(refused_.before(edge - SYNC) + arrived_lost_.before(edge - SYNC), LOST_MAX);
    default: return 0;
    }
}

void Classifier::write(uint32_t address, uint32_t value, Time edge)
{
    switch (address) {
    case REG_CLASSIFIER_THRESHOLD:
        written_.threshold = value;
        break;
    case REG_CLASSIFIER_CONFIG:
        written_.config = value & (REG_CLASSIFIER_CONFIG_ENABLE_MASK | REG_CLASSIFIER_CONFIG_AT_THRESHOLD_MASK |
                                   REG_CLASSIFIER_CONFIG_FILTER_MASK);
        break;
    case REG_CLASSIFIER_CONTROL:
        if (value & REG_CLASSIFIER_CONTROL_CLEAR_MASK)
            fifo_.clear();
        return;
    default: return;
    }
    agenda_.add(edge + SYNC, Kind::SEND, 1);
    plan();
}

void Classifier::input(Time edge, uint64_t, uint64_t pins)
{
    agenda_.add(edge + SYNCHRONISER, Kind::PIN, pins >> IN0 & 1);
    plan();
}

void Classifier::run(Time edge)
{
    bool judged = false, gathers = false;
    uint32_t decision = 0; /* 2 | long, or 0: none */
    while (agenda_.next() == edge) {
        const auto event = agenda_.take();
        switch (event.kind) {
        case Kind::SEND: send(edge, event.value); break;
        case Kind::SETTINGS:
            settings_.set(edge, {uint32_t(event.value >> 32), uint32_t(event.value)});
            agenda_.add(edge + 1, Kind::JUDGE);
            break;
        case Kind::PIN: show_pin(event.value, edge); break;
        case Kind::BELIEVE:
            if (change_ != edge)
                break;
            change_ = NEVER;
            level_.set(edge, pin_);
            /* The classifier sees the level, and a clock later that it was so. */
            agenda_.add(edge + 1, Kind::JUDGE);
            agenda_.add(edge + 2, Kind::JUDGE);
            break;
        case Kind::JUDGE: judged = true; break;
        case Kind::GATHER:
            gathers = true;
            decision |= uint32_t(event.value);
            break;
        case Kind::PUT: put(edge, uint32_t(event.value), uint32_t(event.value >> 32)); break;
        case Kind::POP:
            fifo_.clock(edge, true);
            if (fifo_.moves())
                agenda_.add(edge + SYNC, Kind::FIFO);
            break;
        case Kind::FIFO:
            if (fifo_.moves())
                fifo_.clock(edge, false);
            break;
        }
    }
    if (judged || (timing_ && edge == deadline_))
        judge(edge);
    if (gathers)
        gather(edge, decision);
    plan();
}

/** Settings leave for `fast`: when asked, or when those before them have arrived. */
void Classifier::send(Time edge, bool asked)
{
    if (asked ? handover_.request(edge) : handover_.run(edge)) {
        handed_ = written_;
        handed_.threshold += handed_.threshold == 0;
        agenda_.add(edge + ACTS_IN_FAST, Kind::SETTINGS, uint64_t(handed_.threshold) << 32 | handed_.config);
    } else if (asked) {
        agenda_.add(handover_.next(), Kind::SEND, 0);
    }
}

/** The filter sees a level from `edge` on; it counts by the setting of the clock before. */
void Classifier::show_pin(bool level, Time edge)
{
    pin_ = level;
    if (pin_ == level_.last()) {
        change_ = NEVER;
    } else if (change_ == NEVER) {
        change_ = edge + settings_.before(edge - 1).filter();
        agenda_.add(change_, Kind::BELIEVE);
    }
}

/** An edge of the classifier at which something may happen. */
void Classifier::judge(Time edge)
{
    const Settings &settings = settings_.before(edge);
    const bool level = level_.before(edge), was = level_.before(edge - 1);
    const bool end = timing_ && (edge == deadline_ || (!was && !settings.at_threshold()));
    const bool begin = level && !was && (end || !timing_);
    if (end && settings.enable())
        agenda_.add(edge + 1, Kind::GATHER, 2u | was);
    timing_ = (begin || (timing_ && !end)) && settings.enable();
    if (begin && timing_)
        deadline_ = edge + Time(settings_.before(edge - 1).threshold);
}

/** An edge at which a decision joins the batch, or the batch leaves, or both. */
void Classifier::gather(Time edge, uint32_t decision)
{
    if (waiting_ < edge && crossing_.ready(edge)) {
        crossing_.request(edge);
        agenda_.add(acts_in_sync(edge) + SYNC, Kind::PUT, uint64_t(lost_) << 32 | batch_);
        batch_ = decision ? decision : 1;
        waiting_ = decision ? edge : NEVER;
    } else if (decision && batch_ >> BATCH) {
        lost_ = std::min(lost_ + 1, LOST_MAX);
    } else if (decision) {
        batch_ = batch_ << 1 | (decision & 1);
        waiting_ = std::min(waiting_, edge);
    }
    if (waiting_ == edge)
        agenda_.add(std::max(edge + 1, crossing_.free()), Kind::GATHER);
}

/** A batch has arrived. */
void Classifier::put(Time edge, uint32_t batch, uint32_t lost)
{
    arrived_lost_.set(edge - SYNC, lost);
    if (!fifo_.put(edge, uint16_t(batch)))
        refused_.set(edge, std::min(refused_.last() + length(batch), LOST_MAX));
    else if (fifo_.moves())
        agenda_.add(edge + SYNC, Kind::FIFO);
}

} // namespace twin
