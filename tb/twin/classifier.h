/* SPDX-License-Identifier: BSD-2-Clause */
/** Pulses at IN0, judged by their length, as decisions to read: rtl/decisions.py and what it is made of. */
#ifndef TWIN_CLASSIFIER_H
#define TWIN_CLASSIFIER_H

#include <algorithm>

#include "agenda.h"
#include "block.h"
#include "crossing.h"
#include "fifo.h"

namespace twin {

class Classifier final : public Block {
public:
    explicit Classifier(uint64_t pins);

    uint32_t read(uint32_t address, Time edge) override;
    void write(uint32_t address, uint32_t value, Time edge) override;
    void input(Time edge, uint64_t changed, uint64_t pins) override;
    void run(Time edge) override;

private:
    enum class Kind { SEND, SETTINGS, PIN, BELIEVE, JUDGE, GATHER, POP, PUT, FIFO };

    struct Settings {
        uint32_t threshold = REG_CLASSIFIER_THRESHOLD_VALUE_RESET;
        uint32_t config = REG_CLASSIFIER_CONFIG_FILTER_RESET << REG_CLASSIFIER_CONFIG_FILTER_SHIFT;
        bool enable() const { return config & REG_CLASSIFIER_CONFIG_ENABLE_MASK; }
        bool at_threshold() const { return config & REG_CLASSIFIER_CONFIG_AT_THRESHOLD_MASK; }
        Time filter() const
        {
            return field(config, REG_CLASSIFIER_CONFIG_FILTER_MASK, REG_CLASSIFIER_CONFIG_FILTER_SHIFT);
        }
    };

    void send(Time edge, bool asked);
    void show_pin(bool level, Time edge);
    void judge(Time edge);
    void gather(Time edge, uint32_t decision);
    void put(Time edge, uint32_t batch, uint32_t lost);

    void plan() { due = std::min(planned_, timing_ ? deadline_ : NEVER); }

    Time planned_ = NEVER; /* what the agenda has next */
    Agenda<Kind> agenda_{planned_};

    /* Settings, as written, on their way, and at work. */
    Settings written_, handed_;
    ToFast handover_;
    Past<Settings> settings_;

    /* The glitch filter: the sampled level, and when the one believed changes to it. */
    bool pin_;
    Time change_ = NEVER;
    Past<bool> level_;

    /* The classifier: a pulse is not judged yet, and when it will be at the latest. */
    bool timing_ = false;
    Time deadline_ = NEVER;

    /* The batch: from when on it is not empty. */
    uint32_t batch_ = 1, lost_ = 0;
    Time waiting_ = NEVER;
    ToSync crossing_;

    /* The queue. */
    Fifo<uint16_t, CLASSIFIER_BATCHES> fifo_;
    Past<uint32_t> refused_, arrived_lost_;
};

} // namespace twin

#endif
