/* SPDX-License-Identifier: BSD-2-Clause */
/** A serial port, bit by bit, with its FIFOs: rtl/serial.py. */
#ifndef TWIN_SERIAL_H
#define TWIN_SERIAL_H

#include "agenda.h"
#include "block.h"
#include "fifo.h"

namespace twin {

/** Which of the serial ports it is. */
struct SerialPort {
    uint32_t address; /* of its first register */
    unsigned tx, interrupt;
    unsigned rx = INPUT_PINS; /* none: idle for ever */
};

constexpr SerialPort MAIN_PORT{REG_SERIAL_DATA, SERIAL_TX, INTERRUPT + INTERRUPT_SERIAL, SERIAL_RX};
constexpr SerialPort REPORT_PORT{REG_REPORT_DATA, REPORT_TX, INTERRUPT + INTERRUPT_REPORT};

class Serial final : public Block {
public:
    Serial(Outputs &outputs, const SerialPort &port);

    /** `sync` clocks of a bit. */
    uint32_t divisor() const { return written_ < 8 ? 8 : written_; }

    uint32_t read(uint32_t address, Time edge) override;
    void write(uint32_t address, uint32_t value, Time edge) override;
    void input(Time edge, uint64_t changed, uint64_t pins) override;
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
    const SerialPort port_;
    Agenda<Kind> agenda_{due};
    uint32_t written_, enable_ = 0;
    EventBits errors_;
    uint32_t dropped_ = 0;

    /* Receiver. After a frame without a stop bit it waits until the line has been high. */
    Past<bool> line_{true};
    bool receiving_ = false, waiting_ = false;
    unsigned frame_ = 0, sampled_ = 0;
    Time idle_from_ = 0; /* the first edge that may find a start bit */
    Fifo<uint8_t, SERIAL_FIFO_BYTES> rx_;

    /* Transmitter: bits left of the frame; when it fell quiet, and for how many clocks it had been before. */
    Fifo<uint8_t, SERIAL_FIFO_BYTES> tx_;
    unsigned shift_ = 0, left_ = 0;
    Time quiet_from_ = 0, quiet_ = 0;
};

} // namespace twin

#endif
