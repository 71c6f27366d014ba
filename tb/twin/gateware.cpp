/* SPDX-License-Identifier: BSD-2-Clause */
#include "gateware.h"

#include <algorithm>
#include <cassert>

namespace twin {

Gateware::Gateware(Outputs &outputs, uint64_t pins, const Build &build, struct nor *flash, Converter converter)
    : identity_(build.build_id), bus_fault_(outputs), serial_(outputs, MAIN_PORT), report_(outputs, REPORT_PORT), timer_(outputs, build.timer),
      inputs_(timer_, pins), buttons_(timer_, pins, build.millisecond), knobs_(pins), classifier_(pins),
      interlock_(pwm_, pins), watchdog_(interlock_), pwm_(outputs, snapshot_, adc_, interlock_), adc_(outputs, pins, std::move(converter)), snapshot_(pwm_, quadrature_, build.time),
      trigger_(outputs, quadrature_, pins, build.time), line_(outputs, quadrature_, trigger_), led_(line_), flash_(outputs, flash),
      quadrature_{{line_, interlock_, 0, pins}, {line_, interlock_, 1, pins}, {line_, interlock_, 2, pins}, {line_, interlock_, 3, pins}}, pins_(pins)
{
    add(identity_, REG_IDENTITY_MAGIC, REG_IDENTITY_FAST_CLOCK_HZ);
    add(bus_fault_, REG_BUS_FAULT, REG_BUS_ADDRESS);
    add(inputs_, REG_INPUTS_LEVELS, REG_INPUTS_IN1_TIME);
    add(serial_, REG_SERIAL_DATA, REG_SERIAL_INTERRUPT_ENABLE);
    add(report_, REG_REPORT_DATA, REG_REPORT_INTERRUPT_ENABLE);
    add(timer_, REG_TIMER_COUNT, REG_TIMER_INTERRUPT);
    add(buttons_, REG_BUTTONS_LEVELS, REG_BUTTONS_EXTRA_LONG);
    add(buttons_, REG_BUTTONS_PRESS0, REG_BUTTONS_TIME3);
    add(knobs_, REG_KNOB_POSITION0, REG_KNOB_POSITION2);
    add(knobs_, REG_KNOB_FILTER, REG_KNOB_ERRORS);
    add(classifier_, REG_CLASSIFIER_THRESHOLD, REG_CLASSIFIER_CONTROL);
    add(adc_, REG_ADC_CHANNEL0, REG_ADC_EVENTS);
    add(pwm_, REG_PWM_DUTY0, REG_PWM_DUTY_DELAY);
    add(snapshot_, REG_SNAPSHOT_CONTROL, REG_SNAPSHOT_SAMPLE_TIME_HIGH);
    add(snapshot_, REG_SNAPSHOT_SAMPLE_POSITION0, REG_SNAPSHOT_SAMPLE_POSITION3);
    add(trigger_, REG_TRIGGER_CONFIG, REG_TRIGGER_COUNT3);
    add(line_, REG_COMPARE_CONFIG, REG_COMPARE_INTERRUPT);
    add(line_, REG_DIVIDER_AXIS, REG_DIVIDER_MERGED);
    add(line_, REG_ROUTER_OUT0, REG_ROUTER_ENCODER);
    add(led_, REG_LED_PERIOD, REG_LED_STATUS);
    add(flash_, REG_FLASH_DATA, REG_FLASH_GUARD);
    add(watchdog_, REG_WATCHDOG_CONTROL, REG_WATCHDOG_SCRATCH);
    add(interlock_, REG_INTERLOCK_FAULTS, REG_INTERLOCK_ILLEGAL_TIME);
    add(interlock_, REG_INTERLOCK_STRONG_TIME0, REG_INTERLOCK_EXPECTED3);
    for (unsigned n = 0; n < AXES; n++)
        add(quadrature_[n], REG_QUADRATURE_CONFIG + n * REG_QUADRATURE_STRIDE,
            REG_QUADRATURE_INDEX_POSITION + n * REG_QUADRATURE_STRIDE);
    plan();
}

/** A block has the registers `first` to `last`. */
void Gateware::add(Block &block, uint32_t first, uint32_t last)
{
    for (uint32_t address = first; address <= last && address >= first; address += 4)
        by_word_[(address - FIRST) / 4] = &block;
}

bool Gateware::has(uint32_t address) const
{
    return address >= FIRST && address % 4 == 0 && by_word_[(address - FIRST) / 4] != nullptr;
}

uint32_t Gateware::read(uint32_t address, Time edge)
{
    const uint32_t value = by_word_[(address - FIRST) / 4]->read(address, edge);
    next_ = std::min(next_, by_word_[(address - FIRST) / 4]->due);
    return value;
}

void Gateware::write(uint32_t address, uint32_t value, Time edge)
{
    write_ = {edge + SYNC, by_word_[(address - FIRST) / 4], address, value};
    next_ = std::min(next_, write_.at);
}

void Gateware::refuse(uint32_t address, Time edge)
{
    write_ = {edge + SYNC, nullptr, address, 0};
    next_ = std::min(next_, write_.at);
}

void Gateware::input(Time edge, uint64_t pins)
{
    const uint64_t changed = pins ^ pins_;
    if (!changed)
        return;
    pins_ = pins;
    each([&](auto &block) {
        if (block.listens & changed) {
            block.input(edge, changed, pins);
            next_ = std::min(next_, block.due);
        }
    });
}

void Gateware::run(Time edge)
{
    each([&](auto &block) {
        if (block.due == edge)
            block.run(edge);
    });
    if (write_.at == edge) {
        write_.at = NEVER;
        if (write_.block)
            write_.block->write(write_.address, write_.value, edge);
        else
            bus_fault_.refuse(write_.address, edge);
    }
    plan();
    assert(next_ > edge); /* nothing was left to run after the write: the order of each() */
}

void Gateware::plan()
{
    next_ = write_.at;
    each([&](const auto &block) { next_ = std::min(next_, block.due); });
}

} // namespace twin
