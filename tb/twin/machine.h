/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The controller on its board: the gateware's model, the board's, and the host's end of the serial line, on one clock.
 *
 * Time passes when the processor accesses a register and when it is told to; never by itself.
 */
#ifndef TWIN_MACHINE_H
#define TWIN_MACHINE_H

#include <deque>
#include <functional>
#include <utility>

#include "../board/board.h"
#include "../board/serial_line.h"
#include "follower.h"
#include "gateware.h"

namespace twin {

class Machine final : private Outputs {
public:
    static constexpr int64_t FAST_PS = 1000000000000 / FAST_CLOCK_HZ;

    /** Powered up on a board, with a flash if one is given; both stay the caller's. */
    explicit Machine(struct board *board, struct nor *flash = nullptr);

    /** The processor has been reset, by the watchdog or by order. */
    bool has_reset() const { return gateware_.has_reset(); }
    void start_processor() { gateware_.start_processor(); }

    /** The next edge: everything before it has happened. */
    Time now() const { return now_; }
    int64_t now_ps() const { return now_ * FAST_PS; }

    /** A register access of the processor; takes as long as on the soft core, in the mean. */
    uint32_t read(uint32_t address);
    void write(uint32_t address, uint32_t value);

    /** Let time pass up to an edge, or, with `interrupts` (a mask of lines), until one of these is high. */
    void advance(Time edge, uint32_t interrupts = 0);

    /** Hands on the board: before `edge`, the first to sample what they do. To be said in order of time. */
    void at(Time edge, std::function<void()> hands);

    /** From now on the encoders are those of a stage that does what it is told; the board's motors have no wires. */
    void follow(Follower *stage);

    /** Told of changes of output pins, with the edge from which on they are so. */
    std::function<void(Time, uint64_t changed, uint64_t levels)> watch;

    /** Levels of the interrupt lines. */
    uint32_t interrupts() const { return uint32_t(levels >> INTERRUPT); }

    /* The host's end of the serial line, which has the bit rate that the firmware sets. */
    void send(uint8_t byte);
    size_t unsent() const { return line_.unsent(); }
    bool receive(uint8_t &byte);

    /** Bytes from the report port, whose far end has its bit rate too, and when each began. */
    std::deque<SerialLine::Byte> &reported() { return report_.received; }

private:
    void changed(Time edge, uint64_t pins) override;
    uint64_t pins() const;
    int64_t next_ps() const;
    void happen();
    void plan();

    struct board *const board_;
    SerialLine line_, report_;
    Gateware gateware_;
    Follower *stage_ = nullptr;
    Time now_ = 0;
    std::deque<std::pair<Time, std::function<void()>>> hands_;
    Time outside_ = NEVER; /* the edge that is the first to see what happens next on the board or the line */
};

} // namespace twin

#endif
