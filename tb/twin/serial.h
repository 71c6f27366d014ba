/* SPDX-License-Identifier: BSD-2-Clause */
/** The serial port, bit by bit, with its FIFOs: rtl/serial.py. */
#ifndef TWIN_SERIAL_H
#define TWIN_SERIAL_H

#include <array>

#include "agenda.h"
#include "block.h"

namespace twin {

/**
 * A FIFO with a register at its output, which a byte reaches the clock after it came. At one edge, take first and put
 * then; both go by what the edge saw.
 */
class Fifo {
public:
    bool ready() const { return ready_; }
    bool full() const { return level_ == INNER; }
    unsigned level() const { return level_ + ready_; }
    uint8_t output() const { return output_; }

    /** The output is empty and will not be after the next clock. */
    bool moves() const { return level_ != 0 && !ready_; }

    /** A clock, with or without a read. */
    void clock(Time edge, bool read);

    /** False: it was full, and the byte is lost. */
    bool put(Time edge, uint8_t byte);

private:
    static constexpr unsigned INNER = SERIAL_FIFO_BYTES - 1;

    void see(Time edge);

    std::array<uint8_t, INNER> bytes_{};
    unsigned in_ = 0, out_ = 0, level_ = 0;
    uint8_t output_ = 0;
    bool ready_ = false;
    Time at_ = NEVER; /* the last edge that did anything, and the level it saw */
    unsigned seen_ = 0;
};

class Serial final : public Block {
public:
    explicit Serial(Outputs &outputs);

    /** `sync` clocks of a bit. */
    uint32_t divisor() const { return written_ < 8 ? 8 : written_; }

    uint32_t read(uint32_t address, Time edge) override;
    void write(uint32_t address, uint32_t value, Time edge) override;
    void input(Time edge, uint64_t changed, uint64_t pins) override;
    Time next() const override { return agenda_.next(); }
    void run(Time edge) override;

private:
    enum class Kind { POP, RX_DONE, RX_LOOK, RX_SAMPLE, RX_FIFO, TX_SHIFT, TX_LOAD, TX_FIFO };

    Time bit() const { return Time(divisor()) * SYNC; }
    Time quiet_clocks(Time edge) const;
    void look(Time edge);
    void sample(Time edge);
    void receive(Time edge);
    void load(Time edge);
    void shift(Time edge);
    void tx_moved(Time edge);
    void show(Time edge);

    Outputs &outputs_;
    Agenda<Kind> agenda_;
    uint32_t written_, enable_ = 0;
    EventBits errors_;
    uint32_t dropped_ = 0;

    /* Receiver. After a frame without a stop bit it waits until the line has been high. */
    Past<bool> line_{true};
    bool receiving_ = false, waiting_ = false;
    unsigned frame_ = 0, sampled_ = 0;
    Time idle_from_ = 0; /* the first edge that may find a start bit */
    Fifo rx_;

    /* Transmitter: bits left of the frame; when it fell quiet, and for how many clocks it had been before. */
    Fifo tx_;
    unsigned shift_ = 0, left_ = 0;
    Time quiet_from_ = 0, quiet_ = 0;
};

} // namespace twin

#endif
