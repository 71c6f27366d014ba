/* SPDX-License-Identifier: BSD-2-Clause */
/** One encoder axis: synchronisers, glitch filter, count, index, errors: rtl/quadrature.py. */
#ifndef TWIN_QUADRATURE_H
#define TWIN_QUADRATURE_H

#include "agenda.h"
#include "block.h"
#include "crossing.h"

namespace twin {

/** Who wants to know of steps. Told one clock ahead: what is said holds from `edge` on, the next one. */
class StepListener {
public:
    virtual void step(unsigned axis, bool up, int32_t count, Time edge) = 0;
    virtual void channel_a(unsigned axis, Time edge) = 0;

protected:
    ~StepListener() = default;
};

class Interlock;

class Quadrature final : public Block {
public:
    Quadrature(StepListener &line, Interlock &interlock, unsigned axis, uint64_t pins);

    /** Position, and the level of channel A with it. */
    int32_t count(Time edge) const { return count_.before(edge); }
    bool a(Time edge) const { return a_.before(edge); }

    /** Clocks by which the filter delays what `edge` is the first to judge. */
    unsigned filter(Time edge) const;

    /** The snapshot samples at `edge`: errors and index position are held. */
    void hold(Time edge);

    uint32_t read(uint32_t address, Time edge) override;
    void write(uint32_t address, uint32_t value, Time edge) override;
    void input(Time edge, uint64_t changed, uint64_t pins) override;
    void run(Time edge) override;

private:
    enum class Kind { SEND, SETTINGS, PINS, CHANGE, ERROR_LEAVES, INDEX_LEAVES, ERROR, INDEX, SET_ERROR, SET_INDEX };
    enum { A, B, Z, WIRES };

    struct Settings {
        unsigned filter;
        bool invert;
    };

    /** A wire behind its synchroniser: the level sampled, the level believed, and when that will change. */
    struct Wire {
        bool pin, level;
        Time change;
    };

    void show_pins(unsigned levels, Time edge);
    void judge(Time edge);
    void pass(ToSync &crossing, Time edge, Kind kind, bool leaves);

    StepListener &line_;
    Interlock &interlock_;
    const unsigned axis_;

    Agenda<Kind> agenda_{due};
    uint32_t config_ = 0;
    ToFast handover_;
    uint32_t handed_ = 0;
    Past<Settings> settings_;

    Wire wire_[WIRES];
    unsigned samples_ = 0;  /* of the filters, as long as a wire moves */
    Time moved_ = -1;       /* the last edge known to have seen one move */

    Past<int32_t> count_;
    Past<bool> a_;
    Past<uint32_t> errors_;
    Past<int32_t> index_;
    uint32_t held_errors_ = 0;
    int32_t held_index_ = 0;

    ToSync error_crossing_, index_crossing_;
    EventBits status_;
};

} // namespace twin

#endif
