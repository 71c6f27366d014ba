/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The gateware around the processor, as an event-driven model: registers, input pins, output pins and interrupt lines
 * of the controller, exact to the `fast` clock, with synchronisers that resolve on time. The lock-step test holds it
 * to the Verilated gateware.
 *
 * Time belongs to the caller: every call names its edge, edges never go back, and before a call with an edge all that
 * comes before it has been run (run_before).
 */
#ifndef TWIN_GATEWARE_H
#define TWIN_GATEWARE_H


#include "adc.h"
#include "block.h"
#include "bus_fault.h"
#include "buttons.h"
#include "classifier.h"
#include "flash.h"
#include "identity.h"
#include "inputs.h"
#include "interlock.h"
#include "knob.h"
#include "led.h"
#include "line.h"
#include "pwm.h"
#include "quadrature.h"
#include "serial.h"
#include "snapshot.h"
#include "timer.h"
#include "trigger.h"
#include "watchdog.h"

namespace twin {

class Gateware {
public:
    /** What differs from one build of the gateware to another. */
    struct Build {
        uint32_t build_id = 0;
        uint64_t time = 0, timer = 0; /* of the snapshot and the timer at reset */
        Time millisecond = CLOCK_HZ / 1000;
    };

    /** After reset; the input pins have been as they are for a while. Without a converter it is behind pins. */
    Gateware(Outputs &outputs, uint64_t pins, const Build &build, struct nor *flash, Converter converter = nullptr);

    /** Whether there is a register at an address. Others get a bus error. */
    bool has(uint32_t address) const;

    /** An access whose strobe is taken by `edge`, of `sync`; the next one is at least two `sync` clocks later. */
    uint32_t read(uint32_t address, Time edge);
    void write(uint32_t address, uint32_t value, Time edge);

    /** A write without a register, or not of a whole word. */
    void refuse(uint32_t address, Time edge);

    /** All input pins, from before `edge` on: it is the first to sample them. */
    void input(Time edge, uint64_t pins);

    /** When something happens next; and let it. */
    Time next() const { return next_; }
    void run(Time edge);

    /** Let everything happen that comes before an edge. */
    void run_before(Time edge)
    {
        while (next_ < edge)
            run(next_);
    }

    /** Position of an axis, as an edge sees it. */
    int32_t count(unsigned axis, Time edge) const { return quadrature_[axis].count(edge); }

    /** Clocks of a bit on the serial line, as set by the firmware. */
    uint32_t serial_divisor() const { return serial_.divisor(); }
    uint32_t report_divisor() const { return report_.divisor(); }

    /** The watchdog has reset the processor. */
    bool has_reset() const { return watchdog_.has_reset(); }
    /** It starts again. */
    void start_processor() { watchdog_.start(); }

private:
    /**
     * Those to which something happens, in the order in which they run at one edge: who looks at another comes before
     * it, and so does who starts another, which would otherwise run after the register write at that edge.
     * By their types, since this is where the model spends its time.
     */
    template <class Act> void each(Act &&act)
    {
        act(inputs_), act(serial_), act(report_), act(timer_), act(buttons_), act(knobs_), act(classifier_);
        act(watchdog_), act(interlock_), act(pwm_), act(adc_), act(snapshot_), act(trigger_), act(line_), act(led_), act(flash_);
        for (Quadrature &quadrature : quadrature_)
            act(quadrature);
    }

    void add(Block &block, uint32_t first, uint32_t last);
    void plan();

    Identity identity_;
    BusFault bus_fault_;
    Serial serial_, report_;
    Timer timer_;
    Inputs inputs_;
    Buttons buttons_;
    Knobs knobs_;
    Classifier classifier_;
    Interlock interlock_;
    Watchdog watchdog_;
    Pwm pwm_;
    Adc adc_;
    Snapshot snapshot_;
    Trigger trigger_;
    Line line_;
    Led led_;
    Flash flash_;
    Quadrature quadrature_[AXES];

    static constexpr uint32_t FIRST = 0xfffff000, WORDS = 1024;
    Block *by_word_[WORDS] = {};
    uint64_t pins_;
    Time next_ = NEVER;

    /* The write that is on its way from the bus to its register, or to nowhere. */
    struct {
        Time at;
        Block *block;
        uint32_t address, value;
    } write_{NEVER, nullptr, 0, 0};
};

} // namespace twin

#endif
