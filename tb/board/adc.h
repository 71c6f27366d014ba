/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The board's analog-to-digital converter, a MAX11125: 12 bit, 8 channels, on SPI.
 *
 * As Maxim's data sheet MAX11120-MAX11128 has it. Words of 16 bits, the most significant first; DIN is taken at rising edges of SCLK; the first
 * result bit comes with the selection, the others at falling edges. A command takes effect at the end of its frame;
 * the conversion starts with the next selection, and its result is that frame's.
 */
#ifndef BOARD_ADC_H
#define BOARD_ADC_H

#include <cstdint>

namespace plant {

class Adc {
public:
    static constexpr unsigned CHANNELS = 8;
    /** From an edge to DOUT, most. */
    static constexpr int64_t DELAY_PS = 15'500;

    /** Level of an input as a fraction of the range; clamped. */
    void set_input(unsigned channel, double fraction) { inputs_[channel] = fraction; }

    /** The pins are like this now; returns the level that DOUT takes DELAY_PS later. */
    bool pins(bool cs_n, bool sck, bool din);

    /** A whole frame at once: the word to the converter; returns the one from it. */
    uint16_t frame(uint16_t word);

private:
    void select();
    void deselect();
    uint16_t convert() const;

    double inputs_[CHANNELS] = {};
    bool cs_n_ = true, sck_ = false;
    bool converting_ = false, named_ = false;
    unsigned channel_ = 0;
    uint16_t shift_out_ = 0, shift_in_ = 0;
    unsigned received_ = 0;
};

} // namespace plant

#endif
