/* SPDX-License-Identifier: BSD-2-Clause */
#include "serial_line.h"

namespace {

constexpr unsigned STOP_BIT = 9, FRAME_BITS = 10;

int64_t after(int64_t start_ps, double bits, double bit_ps)
{
    return start_ps + int64_t(bits * bit_ps + 0.5);
}

} // namespace

void SerialLine::write(uint8_t byte, int64_t now_ps)
{
    waiting_.push_back(byte);
    if (send_ps_ == NEVER) {
        send_ps_ = now_ps;
        frame_bit_ = FRAME_BITS;
    }
}

void SerialLine::listen(int64_t time_ps, bool level)
{
    heard_ = level;
    if (!level && sample_ps_ == NEVER) {
        start_ps_ = time_ps;
        sample_bit_ps_ = bit_ps_;
        sample_bit_ = 0;
        sampled_ = 0;
        sample_ps_ = after(start_ps_, 0.5, sample_bit_ps_);
    }
}

void SerialLine::happen()
{
    if (send_ps_ < sample_ps_)
        send_bit();
    else
        sample();
}

void SerialLine::send_bit()
{
    if (frame_bit_ == FRAME_BITS) { /* the frame before has ended */
        sending_ = !waiting_.empty();
        if (!sending_) {
            send_ps_ = NEVER;
            return;
        }
        frame_ = 1u << STOP_BIT | unsigned(waiting_.front()) << 1;
        waiting_.pop_front();
        frame_ps_ = send_ps_;
        frame_bit_ps_ = bit_ps_;
        frame_bit_ = 0;
    }
    level_ = frame_ >> frame_bit_ & 1;
    frame_bit_++;
    send_ps_ = after(frame_ps_, frame_bit_, frame_bit_ps_);
}

void SerialLine::sample()
{
    sampled_ |= unsigned(heard_) << sample_bit_;
    if (sample_bit_ == 0 && heard_) { /* a glitch, no start bit */
        sample_ps_ = NEVER;
        return;
    }
    if (sample_bit_ < STOP_BIT) {
        sample_bit_++;
        sample_ps_ = after(start_ps_, sample_bit_ + 0.5, sample_bit_ps_);
        return;
    }
    sample_ps_ = NEVER;
    if (!heard_) {
        framing_errors++;
        return;
    }
    const uint8_t value = uint8_t(sampled_ >> 1);
    received.push_back({start_ps_, value});
    lines += value == '\n';
}
