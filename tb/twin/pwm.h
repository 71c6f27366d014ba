/* SPDX-License-Identifier: BSD-2-Clause */
/** Motor PWM and servo tick: rtl/pwm.py. */
#ifndef TWIN_PWM_H
#define TWIN_PWM_H

#include "adc.h"
#include "agenda.h"
#include "block.h"
#include "interlock.h"
#include "snapshot.h"

namespace twin {

class Pwm final : public Block, public TickListener {
public:
    Pwm(Outputs &outputs, Snapshot &snapshot, Adc &adc, Interlock &interlock);

    /** These axes are held off from `edge` on. */
    void inhibit(uint32_t axes, Time edge);

    void latched(Time edge) override;

    uint32_t read(uint32_t address, Time edge) override;
    void write(uint32_t address, uint32_t value, Time edge) override;
    void run(Time edge) override;

private:
    /* START: a PWM period. TICK, DRIVE, FALL: its servo tick, its rising pins, the end of one axis' pulse.
     * OFF: an axis was enabled or disabled, or the interlock changed, a clock ago. */
    enum class Kind { START, TICK, OFF, DRIVE, FALL };

    bool off(unsigned axis, Time edge) const { return ((inhibit_.before(edge) | ~enable_) >> axis & 1) != 0; }
    void start(Time edge);
    void switch_off(Time edge);
    void drive(Time edge);
    void show(Time edge);

    Outputs &outputs_;
    Snapshot &snapshot_;
    Adc &adc_;
    Interlock &interlock_;
    Agenda<Kind> agenda_{due};

    int32_t duty_[AXES] = {};
    uint32_t enable_ = 0, divider_, delay_;
    EventBits events_;
    Past<uint32_t> inhibit_{(1u << AXES) - 1};

    /* The tick divider: starts before the next tick, and before the duties are taken. */
    uint8_t left_ = 0, wait_ = 0;
    bool waiting_ = false;

    /* By axis: the duty taken for periods to come, and the period's clocks of drive and direction. */
    int32_t taken_[AXES] = {};
    int32_t on_[AXES] = {};
    bool direction_[AXES] = {};
};

} // namespace twin

#endif
