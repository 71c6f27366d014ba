/* SPDX-License-Identifier: BSD-2-Clause */
/** What a model of a peripheral is: registers, input pins, output pins, and things that happen at clock edges. */
#ifndef TWIN_BLOCK_H
#define TWIN_BLOCK_H

#include <cstdint>

#include "clock.h"

extern "C" {
#include "regs.h"
}

namespace twin {

static_assert(FAST_CLOCK_HZ == SYNC * CLOCK_HZ, "the model's clocks");

constexpr unsigned AXES = 4;

/** Input pins: bits of a word. Of pins with a number, that of number 0. */
enum Input : unsigned {
    ENC_A = 0,
    ENC_B = 4,
    ENC_Z = 8,
    LIMIT_LOWER = 12,
    LIMIT_UPPER = 16,
    ESTOP = 20,
    IN0,
    IN1,
    SERIAL_RX,
    BUTTON,
    JOYSTICK_BUTTON = BUTTON + 4,
    DIP,
    KNOB_A = DIP + 4,
    KNOB_B = KNOB_A + 3,
    ADC_MISO = KNOB_B + 3,
    INPUT_PINS,
};

/** Output pins, and from INTERRUPT on the interrupt lines by their numbers. */
enum Output : unsigned {
    PWM = 0,
    DIR = 4,
    MOTOR_ENABLE = 8,
    OUT0,
    SYNC_OUT,
    ENCODER_OUT,
    SERIAL_TX,
    ADC_CS_N,
    ADC_SCK,
    ADC_MOSI,
    REPORT_TX,
    FLASH_CS_N,
    FLASH_SCK,
    FLASH_MOSI,
    INTERRUPT = 32,
};

constexpr uint64_t bit(unsigned n)
{
    return uint64_t(1) << n;
}

/** `count` pins from the one named on. */
constexpr uint64_t bits(unsigned n, unsigned count)
{
    return ((uint64_t(1) << count) - 1) << n;
}

/** The bits of a field, from `shift` up. */
constexpr uint32_t field(uint32_t value, uint32_t mask, unsigned shift)
{
    return (value & mask) >> shift;
}

/** Levels of the output pins and interrupt lines. */
class Outputs {
public:
    uint64_t levels = bit(SERIAL_TX) | bit(ADC_CS_N) | bit(REPORT_TX) | bit(FLASH_CS_N);

    /** From `edge` on. */
    void set(Time edge, unsigned pin, bool level)
    {
        if ((levels >> pin & 1) == level)
            return;
        levels ^= bit(pin);
        changed(edge, bit(pin));
    }

protected:
    ~Outputs() = default;

private:
    virtual void changed(Time edge, uint64_t pins) = 0;
};

/** Event bits of a register: hardware sets them, a written 1 clears, and a set at the same edge wins. */
class EventBits {
public:
    uint32_t bits = 0;

    void set(Time edge, uint32_t mask)
    {
        set_ = edge == at_ ? set_ | mask : mask;
        at_ = edge;
        bits |= mask;
    }

    void clear(Time edge, uint32_t mask) { bits &= ~(edge == at_ ? mask & ~set_ : mask); }

private:
    Time at_ = NEVER;
    uint32_t set_ = 0;
};

/**
 * A peripheral. Everything that happens before an edge has been run when one of these is called with it; what happens
 * at the edge itself runs in the order of the blocks in gateware.h, and a register write at that edge comes last.
 */
class Block {
public:
    virtual ~Block() = default;

    /** Input pins that input() is told of. */
    uint64_t listens = 0;

    /** The value of a register as `edge`, of `sync`, sees it; and what reading it does. */
    virtual uint32_t read(uint32_t address, Time edge) = 0;

    /** A register is written from `edge`, of `sync`, on. */
    virtual void write(uint32_t, uint32_t, Time) {}

    /** Input pins have these levels from before `edge` on, that is, it is the first to sample them. */
    virtual void input(Time, uint64_t /* changed */, uint64_t /* levels */) {}

    /** When something happens next: the block keeps it so, whoever made it change; then run() does all that happens
     * at that edge. */
    Time due = NEVER;
    virtual void run(Time) {}
};

} // namespace twin

#endif
