/* SPDX-License-Identifier: BSD-2-Clause */
#include "machine.h"

#include <algorithm>

namespace twin {

namespace {

/* Of the soft core: 16 loads took 76 `sync` clocks, 16 stores 53 (docs/timing.md). */
constexpr Time LOAD = 5 * SYNC, STORE = 3 * SYNC;

constexpr uint32_t BUILD_ID = 0x7477696e; /* "twin" */

constexpr uint64_t DRIVES = uint64_t(0xf) << PWM | uint64_t(0xf) << DIR | bit(MOTOR_ENABLE);

} // namespace

Machine::Machine(struct board *board, struct nor *flash)
    : board_(board), line_(115200), report_(115200),
      gateware_(*this, pins(), {BUILD_ID}, flash, [board](uint16_t word) { return board_adc_frame(board, word); })
{
    plan();
}

uint32_t Machine::read(uint32_t address)
{
    const Time edge = sync_from(now_);
    advance(edge);
    const uint32_t value = gateware_.read(address, edge);
    now_ = edge + LOAD;
    return value;
}

void Machine::write(uint32_t address, uint32_t value)
{
    const Time edge = sync_from(now_);
    advance(edge);
    if (gateware_.has(address))
        gateware_.write(address, value, edge);
    else
        gateware_.refuse(address, edge);
    now_ = edge + STORE;
}

void Machine::advance(Time edge, uint32_t wanted)
{
    while (!(interrupts() & wanted)) {
        const Time inside = gateware_.next(), next = std::min(inside, outside_);
        if (next >= edge) {
            now_ = std::max(now_, edge);
            return;
        }
        if (outside_ <= inside)
            happen();
        else
            gateware_.run(inside);
        now_ = std::max(now_, next + 1);
    }
}

void Machine::send(uint8_t byte)
{
    line_.set_baud(double(CLOCK_HZ) / gateware_.serial_divisor());
    line_.write(byte, now_ps());
    plan();
}

bool Machine::receive(uint8_t &byte)
{
    if (line_.received.empty())
        return false;
    byte = line_.received.front().value;
    line_.received.pop_front();
    return true;
}

void Machine::follow(Follower *stage)
{
    stage_ = stage;
    plan();
}

void Machine::at(Time edge, std::function<void()> hands)
{
    hands_.emplace_back(edge, std::move(hands));
    plan();
}

/** The controller's pins act on the board and the line. */
void Machine::changed(Time edge, uint64_t pins)
{
    if (watch)
        watch(edge, pins, levels);
    if (pins & DRIVES && !stage_)
        board_drive_pins(board_, edge * FAST_PS, unsigned(levels >> PWM & 0xf), unsigned(levels >> DIR & 0xf),
                         levels >> MOTOR_ENABLE & 1);
    if (pins & bit(SERIAL_TX)) {
        line_.set_baud(double(CLOCK_HZ) / gateware_.serial_divisor());
        line_.listen(edge * FAST_PS, levels >> SERIAL_TX & 1);
    }
    if (pins & bit(REPORT_TX)) {
        report_.set_baud(double(CLOCK_HZ) / gateware_.report_divisor());
        report_.listen(edge * FAST_PS, levels >> REPORT_TX & 1);
    }
    if (pins & (DRIVES | bit(SERIAL_TX) | bit(REPORT_TX)))
        plan();
}

uint64_t Machine::pins() const
{
    const struct board_pins &board = *board_pins(board_);
    const uint64_t encoders = stage_ ? stage_->pins()
                                     : uint64_t(board.enc_a) << ENC_A | uint64_t(board.enc_b) << ENC_B |
                                           uint64_t(board.enc_z) << ENC_Z;
    return encoders | uint64_t(board.limit_lower) << LIMIT_LOWER | uint64_t(board.limit_upper) << LIMIT_UPPER |
           uint64_t(board.estop) << ESTOP | uint64_t(board.in0) << IN0 | uint64_t(board.in1) << IN1 |
           uint64_t(board.button) << BUTTON | uint64_t(board.joystick_button) << JOYSTICK_BUTTON |
           uint64_t(board.dip) << DIP | uint64_t(board.knob_a) << KNOB_A | uint64_t(board.knob_b) << KNOB_B |
           uint64_t(line_.level()) << SERIAL_RX;
}

/** The next thing outside the controller, which it sees at outside_. */
void Machine::happen()
{
    const Time edge = outside_;
    if (stage_ && stage_->next() == edge) {
        stage_->happen();
        gateware_.input(edge, pins());
        plan();
        return;
    }
    if (!hands_.empty() && hands_.front().first == edge && next_ps() / FAST_PS >= edge) {
        hands_.front().second();
        hands_.pop_front();
    } else if (board_next_ps(board_) <= std::min(line_.next_ps(), report_.next_ps()))
        board_next(board_, nullptr);
    else if (line_.next_ps() <= report_.next_ps())
        line_.happen();
    else
        report_.happen();
    gateware_.input(edge, pins());
    plan();
}

int64_t Machine::next_ps() const
{
    return std::min({board_next_ps(board_), line_.next_ps(), report_.next_ps()});
}

void Machine::plan()
{
    outside_ = next_ps() == INT64_MAX ? NEVER : next_ps() / FAST_PS + 1;
    if (stage_)
        outside_ = std::min(outside_, stage_->next());
    if (!hands_.empty())
        outside_ = std::min(outside_, hands_.front().first);
}

} // namespace twin
