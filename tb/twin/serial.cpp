/* SPDX-License-Identifier: BSD-2-Clause */
#include "serial.h"

#include <algorithm>

namespace twin {

namespace {

constexpr unsigned FRAME_BITS = 10; /* start, eight, stop */
constexpr uint32_t ERRORS_MAX = 0xffff;

} // namespace

Serial::Serial(Outputs &outputs, const SerialPort &port)
    : outputs_(outputs), port_(port), written_(REG_SERIAL_DIVISOR_VALUE_RESET)
{
    listens = port.rx < INPUT_PINS ? twin::bit(port.rx) : 0;
}

uint32_t Serial::read(uint32_t address, Time edge)
{
    switch (address - port_.address + REG_SERIAL_DATA) {
    case REG_SERIAL_DATA:
        agenda_.add(edge, Kind::POP);
        return uint32_t(rx_.output()) << REG_SERIAL_DATA_BYTE_SHIFT | (rx_.ready() ? REG_SERIAL_DATA_VALID_MASK : 0);
    case REG_SERIAL_STATUS:
        return (rx_.ready() ? REG_SERIAL_STATUS_RX_READY_MASK : 0) |
               (!tx_.full() ? REG_SERIAL_STATUS_TX_READY_MASK : 0) |
               (tx_.level() <= SERIAL_FIFO_BYTES / 2 ? REG_SERIAL_STATUS_TX_LOW_MASK : 0) |
               (tx_.level() == 0 && quiet_clocks(edge) > Time(divisor()) ? REG_SERIAL_STATUS_TX_IDLE_MASK : 0);
    case REG_SERIAL_ERRORS: return errors_.bits;
    case REG_SERIAL_ERROR_COUNT: return dropped_;
    case REG_SERIAL_DIVISOR: return written_;
    case REG_SERIAL_INTERRUPT_ENABLE: return enable_;
    default: return 0;
    }
}

void Serial::write(uint32_t address, uint32_t value, Time edge)
{
    switch (address - port_.address + REG_SERIAL_DATA) {
    case REG_SERIAL_DATA:
        if (tx_.put(edge, uint8_t(field(value, REG_SERIAL_DATA_BYTE_MASK, REG_SERIAL_DATA_BYTE_SHIFT))))
            tx_moved(edge);
        break;
    case REG_SERIAL_ERRORS:
        errors_.clear(edge, value);
        break;
    case REG_SERIAL_DIVISOR:
        quiet_ = quiet_clocks(edge + SYNC);
        quiet_from_ = std::max(quiet_from_, edge + SYNC);
        written_ = value & REG_SERIAL_DIVISOR_VALUE_MASK;
        break;
    case REG_SERIAL_INTERRUPT_ENABLE:
        enable_ = value & (REG_SERIAL_INTERRUPT_ENABLE_RX_READY_MASK | REG_SERIAL_INTERRUPT_ENABLE_TX_LOW_MASK |
                           REG_SERIAL_INTERRUPT_ENABLE_ERROR_MASK);
        break;
    }
    show(edge);
}

void Serial::input(Time edge, uint64_t, uint64_t pins)
{
    line_.set(sync_from(edge) + SYNC, pins >> port_.rx & 1);
    agenda_.add(sync_from(edge) + 2 * SYNC, Kind::RX_LOOK);
}

void Serial::run(Time edge)
{
    while (agenda_.next() == edge) {
        switch (agenda_.take().kind) {
        case Kind::POP:
            rx_.clock(edge, true);
            if (rx_.moves())
                agenda_.add(edge + SYNC, Kind::RX_FIFO);
            break;
        case Kind::RX_FIFO:
            if (rx_.moves())
                rx_.clock(edge, false);
            break;
        case Kind::RX_LOOK: look(edge); break;
        case Kind::RX_SAMPLE: sample(edge); break;
        case Kind::RX_DONE: receive(edge); break;
        case Kind::TX_FIFO:
            if (tx_.moves())
                tx_.clock(edge, false);
            tx_moved(edge);
            break;
        case Kind::TX_LOAD: load(edge); break;
        case Kind::TX_SHIFT: shift(edge); break;
        }
    }
    show(edge);
}

/** An idle receiver looks for the falling edge of a start bit. */
void Serial::look(Time edge)
{
    if (receiving_ || edge < idle_from_)
        return;
    const bool high = line_.before(edge);
    if (waiting_) {
        waiting_ = !high;
    } else if (!high) {
        receiving_ = true;
        frame_ = sampled_ = 0;
        agenda_.add(edge + Time(divisor() / 2 + 1) * SYNC, Kind::RX_SAMPLE);
    }
}

void Serial::sample(Time edge)
{
    frame_ |= unsigned(line_.before(edge)) << sampled_;
    if (++sampled_ < FRAME_BITS)
        agenda_.add(edge + bit(), Kind::RX_SAMPLE);
    else
        agenda_.add(edge + 2 * SYNC, Kind::RX_DONE);
}

void Serial::receive(Time edge)
{
    const bool start = frame_ & 1, stop = frame_ >> (FRAME_BITS - 1);
    const uint8_t byte = uint8_t(frame_ >> 1);

    receiving_ = false;
    idle_from_ = edge;
    if (!start && stop) {
        if (!rx_.put(edge, byte))
            errors_.set(edge, REG_SERIAL_ERRORS_RX_OVERRUN_MASK);
        else if (rx_.moves())
            agenda_.add(edge + SYNC, Kind::RX_FIFO);
        look(edge);
    } else {
        errors_.set(edge, byte ? REG_SERIAL_ERRORS_FRAMING_MASK : REG_SERIAL_ERRORS_LINE_BREAK_MASK);
        dropped_ += dropped_ != ERRORS_MAX;
        waiting_ = !line_.before(edge);
        idle_from_ = edge + SYNC;
        agenda_.add(edge + SYNC, Kind::RX_LOOK);
    }
}

/** The FIFO of the transmitter did something: what follows from it at the next clock. */
void Serial::tx_moved(Time edge)
{
    if (tx_.moves())
        agenda_.add(edge + SYNC, Kind::TX_FIFO);
    else if (tx_.ready() && left_ == 0)
        agenda_.add(edge + SYNC, Kind::TX_LOAD);
}

void Serial::load(Time edge)
{
    if (left_ != 0 || !tx_.ready())
        return;
    shift_ = 1u << (FRAME_BITS - 1) | unsigned(tx_.output()) << 1;
    left_ = FRAME_BITS;
    quiet_from_ = NEVER;
    quiet_ = 0;
    tx_.clock(edge, true);
    tx_moved(edge);
    agenda_.add(edge + bit(), Kind::TX_SHIFT);
}

void Serial::shift(Time edge)
{
    outputs_.set(edge, port_.tx, shift_ & 1);
    shift_ >>= 1;
    if (--left_ != 0) {
        agenda_.add(edge + bit(), Kind::TX_SHIFT);
    } else if (tx_.ready()) {
        agenda_.add(edge + SYNC, Kind::TX_LOAD);
    } else {
        quiet_from_ = edge + SYNC;
    }
}

/** Clocks without anything to send that `edge` has seen; they are counted up to one more than a bit has. */
Time Serial::quiet_clocks(Time edge) const
{
    if (edge <= quiet_from_ || quiet_ > Time(divisor()))
        return quiet_;
    return std::min(quiet_ + (edge - quiet_from_) / SYNC, Time(divisor()) + 1);
}

void Serial::show(Time edge)
{
    const bool interrupt = ((enable_ & REG_SERIAL_INTERRUPT_ENABLE_RX_READY_MASK) && rx_.ready()) ||
                           ((enable_ & REG_SERIAL_INTERRUPT_ENABLE_TX_LOW_MASK) &&
                            tx_.level() <= SERIAL_FIFO_BYTES / 2) ||
                           ((enable_ & REG_SERIAL_INTERRUPT_ENABLE_ERROR_MASK) && errors_.bits);
    outputs_.set(edge, port_.interrupt, interrupt);
}

} // namespace twin
