/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Faults that take drives off: rtl/interlock.py, rtl/monitor.py.
 *
 * A sample of the counts is captured every 100 edges and judged 16 edges later. Samples in which nothing happens are
 * not looked at; what they would have added to the times without way is added up when the next one is.
 */
#ifndef TWIN_INTERLOCK_H
#define TWIN_INTERLOCK_H

#include "agenda.h"
#include "block.h"
#include "quadrature.h"

namespace twin {

class Pwm;

class Interlock final : public Block, public StepListener {
public:
    Interlock(Pwm &pwm, uint64_t pins);

    /** The drive of an axis from `edge` on; an illegal transition and the watchdog's strobe as `edge` sees them. */
    void drive(unsigned axis, int32_t steps, Time edge);
    void illegal(unsigned axis, Time edge);
    void expired(Time edge);

    void step(unsigned axis, bool up, int32_t count, Time edge) override;
    void channel_a(unsigned, Time) override {}

    uint32_t read(uint32_t address, Time edge) override;
    void write(uint32_t address, uint32_t value, Time edge) override;
    void input(Time edge, uint64_t changed, uint64_t pins) override;
    void run(Time edge) override;

private:
    /* At one edge in this order. */
    enum class Kind {
        LATCH,   /* causes that the edge before brought are kept */
        STOP,    /* the emergency stop, synchronised */
        CALM,    /* the watchdog's strobe is over */
        FAR,     /* the following error may have become another */
        CAPTURE, /* the counts of a sample */
    };

    struct Axis {
        Past<int32_t> now;       /* the decoder's count */
        int32_t captured = 0;    /* of the latest sample */
        Past<int32_t> count;     /* as of the last sample judged */
        Past<int32_t> drive, reference;
        int32_t mean = 0;              /* of the drive, times 64 */
        int at = 0, low = 0, high = 0; /* way since it was made */
        bool forward = false;
        uint32_t strong_for = 0, weak_for = 0; /* samples */
        int32_t window = 0;
        uint32_t events = 0;
        bool too_fast = false, far = false;
        Past<int32_t> expected;
        Past<uint32_t> most;
    };

    static constexpr Time SAMPLE = 100, CAPTURED = 100, JUDGED = 116;
    static constexpr int64_t WINDOW = 200;

    static Time judged(int64_t sample) { return JUDGED + SAMPLE * sample; }
    static int64_t sample_after(Time edge) { return edge < JUDGED ? 0 : (edge - JUDGED) / SAMPLE + 1; }

    int32_t excess(const Axis &a, unsigned axis, Time edge) const;
    void judge(unsigned axis, int64_t sample, int step);
    void pass(unsigned axis, int64_t samples, int64_t first);
    void samples_to(int64_t last);
    void sample(int64_t number);
    void capture_after(Time edge);
    void end_window();
    uint32_t limit(uint32_t address, unsigned axis = 0) const;
    bool is_far(unsigned axis, Time edge) const;
    uint32_t level() const;
    void refresh(Time edge);
    void keep(uint32_t faults, Time edge);
    void plan();

    Pwm &pwm_;
    Time agenda_due_ = NEVER;
    Agenda<Kind> agenda_{agenda_due_};

    static constexpr unsigned WORDS = 32;
    uint32_t registers_[WORDS] = {};
    Past<uint32_t> control_;
    Axis axes_[AXES];
    int64_t next_ = 0;           /* the first sample that is not judged */
    bool capturing_ = false, moved_ = false;
    unsigned eager_ = 2;         /* the next samples are judged, whatever they bring */
    uint32_t windows_left_ = 0;  /* until illegal transitions count anew */
    bool watchdog_ = false;
    Past<uint32_t> causes_, faults_;
    uint32_t mask_ = 0;          /* axes held off */
    Time sample_due_ = NEVER;
};

} // namespace twin

#endif
