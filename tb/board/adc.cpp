/* SPDX-License-Identifier: BSD-2-Clause */
#include "adc.h"

#include <algorithm>
#include <cmath>

namespace plant {

namespace {

constexpr unsigned REGISTER_BIT = 15; /* 1: a setting; 0: mode control */
constexpr unsigned SCAN_SHIFT = 11, CHANNEL_SHIFT = 7, RESET_SHIFT = 5;
constexpr unsigned SCAN_NULL = 0, SCAN_MANUAL = 1;
constexpr unsigned RESET_ALL = 2;
constexpr unsigned NAMED_BIT = 2;
constexpr double CODES = 4096;

} // namespace

bool Adc::pins(bool cs_n, bool sck, bool din)
{
    if (cs_n != cs_n_) {
        cs_n_ = cs_n;
        cs_n ? deselect() : select();
    } else if (!cs_n && sck && !sck_) {
        shift_in_ = uint16_t(shift_in_ << 1 | din);
        received_++;
    } else if (!cs_n && !sck && sck_) {
        shift_out_ = uint16_t(shift_out_ << 1);
    }
    sck_ = sck;
    return cs_n || (shift_out_ >> 15 & 1); /* not driven: pulled up */
}

uint16_t Adc::frame(uint16_t word)
{
    select();
    const uint16_t result = shift_out_;
    shift_in_ = word;
    received_ = 16;
    deselect();
    return result;
}

void Adc::select()
{
    shift_out_ = converting_ ? convert() : 0;
    shift_in_ = 0;
    received_ = 0;
}

void Adc::deselect()
{
    if (received_ != 16 || (shift_in_ >> REGISTER_BIT & 1) != 0)
        return;
    const unsigned scan = shift_in_ >> SCAN_SHIFT & 0xf;
    if ((shift_in_ >> RESET_SHIFT & 3) == RESET_ALL)
        converting_ = named_ = false;
    else if (scan != SCAN_NULL) {
        converting_ = scan == SCAN_MANUAL;
        channel_ = shift_in_ >> CHANNEL_SHIFT & (CHANNELS - 1);
        named_ = (shift_in_ >> NAMED_BIT & 1) != 0;
    }
}

uint16_t Adc::convert() const
{
    const double code = std::clamp(std::floor(inputs_[channel_] * CODES), 0.0, CODES - 1);
    return uint16_t((named_ ? channel_ << 12 : 0) | unsigned(code));
}

} // namespace plant
