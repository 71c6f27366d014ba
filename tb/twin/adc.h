/* SPDX-License-Identifier: BSD-2-Clause */
/** Eight analog channels over SPI: rtl/adc.py. */
#ifndef TWIN_ADC_H
#define TWIN_ADC_H

#include <functional>

#include "agenda.h"
#include "block.h"

namespace twin {

/** A converter that takes a word and gives one, for when nobody looks at the pins: a scan is then a single event. */
using Converter = std::function<uint16_t(uint16_t)>;

class Adc final : public Block {
public:
    /** With a converter the pins stand still. */
    Adc(Outputs &outputs, uint64_t pins, Converter converter)
        : outputs_(outputs), converter_(std::move(converter)), miso_(pins >> ADC_MISO & 1)
    {
        listens = bit(ADC_MISO);
    }

    /** A servo tick is taken by `edge`. */
    void tick(Time edge) { agenda_.add(edge, Kind::TICK); }

    uint32_t read(uint32_t address, Time) override
    {
        switch (address) {
        case REG_ADC_CONTROL: return enable_ ? REG_ADC_CONTROL_ENABLE_MASK : 0;
        case REG_ADC_EVENTS: return events_.bits;
        case REG_ADC_STATUS:
            return (valid_ ? REG_ADC_STATUS_VALID_MASK : 0) | (idle_high_ ? REG_ADC_STATUS_IDLE_HIGH_MASK : 0);
        default: return values_[(address - REG_ADC_CHANNEL0) / 4 % CHANNELS];
        }
    }

    void write(uint32_t address, uint32_t value, Time edge) override
    {
        if (address == REG_ADC_CONTROL)
            enable_ = value & REG_ADC_CONTROL_ENABLE_MASK;
        else if (address == REG_ADC_EVENTS)
            events_.clear(edge, value);
    }

    void input(Time edge, uint64_t, uint64_t pins) override
    {
        miso_.set(sync_from(edge) + SYNC, pins >> ADC_MISO & 1);
    }


    void run(Time edge) override
    {
        while (agenda_.next() == edge) {
            const auto event = agenda_.take();
            switch (event.kind) {
            case Kind::HALF: half(unsigned(event.value), edge); break;
            case Kind::SHIFT: shift(edge); break;
            case Kind::MOSI: outputs_.set(edge, ADC_MOSI, word_ >> 15); break;
            case Kind::FRAME_ENDS: frame_ends(edge); break;
            case Kind::SCAN_ENDS: scan_ends(edge); break;
            case Kind::TICK: begin_scan(edge); break;
            case Kind::FRAME: frame(edge); break;
            case Kind::IDLE: outputs_.set(edge, ADC_SCK, idle_high_); break;
            }
        }
    }

private:
    enum class Kind { HALF, SHIFT, MOSI, FRAME_ENDS, SCAN_ENDS, TICK, FRAME, IDLE };

    static constexpr unsigned CHANNELS = REG_ADC_CHANNEL_COUNT, BITS = 12;
    static constexpr uint16_t CONFIGURATION[] = {0x0040, 0x8000, 0x8800, 0x9000, 0x9800};
    static constexpr unsigned CONFIGURATIONS = 5, FRAMES = CONFIGURATIONS + CHANNELS + 3;
    static constexpr uint16_t CONVERT = 0x0806;
    static constexpr unsigned CHANNEL_BIT = 7;
    static constexpr Time HALF = 4 * SYNC, HALVES = 36; /* of a bit; to a frame */

    uint16_t command() const
    {
        if (frame_ < CONFIGURATIONS)
            return CONFIGURATION[frame_];
        return uint16_t(CONVERT | (frame_ - CONFIGURATIONS < CHANNELS ? frame_ - CONFIGURATIONS : CHANNELS - 1)
                                      << CHANNEL_BIT);
    }

    void begin_scan(Time edge)
    {
        if (busy_)
            events_.set(edge, REG_ADC_EVENTS_OVERRUN_MASK);
        valid_ = complete_;
        if (complete_)
            for (unsigned n = 0; n < CHANNELS; n++)
                values_[n] = scanned_[n];
        complete_ = false;
        if (!enable_ || busy_)
            return;
        busy_ = true;
        come_ = 0;
        frame_ = configured_ ? CONFIGURATIONS : 0;
        agenda_.add(edge + SYNC, Kind::FRAME);
    }

    /** A frame begins at `edge`; pins are flip-flops that follow it. */
    void frame(Time edge)
    {
        if (converter_) {
            for (; frame_ < FRAMES; frame_++, edge += HALVES * HALF)
                take(converter_(command()));
            agenda_.add(edge - SYNC, Kind::SCAN_ENDS);
            return;
        }
        word_ = command();
        outputs_.set(edge, ADC_CS_N, false);
        agenda_.add(edge + SYNC, Kind::MOSI);
        agenda_.add(edge + HALF, Kind::HALF, 1);
        agenda_.add(edge + HALVES * HALF - SYNC, Kind::FRAME_ENDS);
    }

    /** Half `n` of a bit begins: 1 to 32 are those of the word, low and high; then a trail, and deselection. */
    void half(unsigned n, Time edge)
    {
        if (n <= 32) {
            outputs_.set(edge, ADC_SCK, n % 2 == 0);
            if (n % 2 == 0)
                agenda_.add(edge + HALF - SYNC, Kind::SHIFT);
        } else if (n == 33) {
            outputs_.set(edge, ADC_SCK, idle_high_);
        } else {
            outputs_.set(edge, ADC_CS_N, true);
            return;
        }
        agenda_.add(edge + HALF, Kind::HALF, n + 1);
    }

    void shift(Time edge)
    {
        word_ = uint16_t(word_ << 1);
        result_ = uint16_t(result_ << 1 | miso_.before(edge));
        agenda_.add(edge + SYNC, Kind::MOSI);
    }

    void frame_ends(Time edge)
    {
        take(result_);
        if (++frame_ < FRAMES)
            agenda_.add(edge + SYNC, Kind::FRAME);
        else
            scan_ends(edge);
    }

    /** The word that a frame brought. */
    void take(uint16_t word)
    {
        const unsigned channel = word >> BITS;
        if (frame_ < CONFIGURATIONS || channel >= CHANNELS)
            return;
        scanned_[channel] = word & ((1u << BITS) - 1);
        come_ |= 1u << channel;
    }

    void scan_ends(Time edge)
    {
        busy_ = false;
        complete_ = configured_ = come_ == (1u << CHANNELS) - 1;
        if (!complete_) {
            events_.set(edge, REG_ADC_EVENTS_FAILED_MASK);
            idle_high_ = !idle_high_;
            if (!converter_)
                agenda_.add(edge + SYNC, Kind::IDLE);
        }
    }

    Outputs &outputs_;
    const Converter converter_;
    Agenda<Kind> agenda_{due};
    Past<bool> miso_;
    EventBits events_;
    bool enable_ = false, busy_ = false, configured_ = false, complete_ = false, valid_ = false, idle_high_ = false;
    unsigned frame_ = 0, come_ = 0;
    uint16_t word_ = 0, result_ = 0;
    uint32_t scanned_[CHANNELS] = {}, values_[CHANNELS] = {};
};

} // namespace twin

#endif
