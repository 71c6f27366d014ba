/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The host computer's end of the serial line, bit by bit: 8 data bits, no parity, one stop bit.
 *
 * Bits leave at their exact times, to a picosecond, and without gaps while bytes wait. Received bits are sampled
 * at their middle, counted from the falling edge of the start bit. The caller owns time: it asks for the next time
 * something happens and lets it happen.
 */
#ifndef BOARD_SERIAL_LINE_H
#define BOARD_SERIAL_LINE_H

#include <cstddef>
#include <cstdint>
#include <deque>

class SerialLine {
public:
    explicit SerialLine(double baud) { set_baud(baud); }

    /** For bytes that start from now on, both ways. */
    void set_baud(double baud) { bit_ps_ = 1e12 / baud; }

    /** Queue a byte; its start bit leaves at `now_ps`, or right after the stop bit of the one before. */
    void write(uint8_t byte, int64_t now_ps);

    /** The controller's transmit pin changed. */
    void listen(int64_t time_ps, bool level);

    /** When the line or the receiver next needs `happen`; never: INT64_MAX. */
    int64_t next_ps() const { return send_ps_ < sample_ps_ ? send_ps_ : sample_ps_; }

    /** Let the event at next_ps() happen. */
    void happen();

    /** Level at the controller's receive pin. */
    bool level() const { return level_; }

    /** Bytes written whose stop bit has not ended. */
    size_t unsent() const { return waiting_.size() + sending_; }

    /** Bytes received, oldest first; the reader takes them away. */
    struct Byte {
        int64_t start_ps; /* of the start bit */
        uint8_t value;
    };
    std::deque<Byte> received;

    size_t lines = 0;         /* line feeds received so far */
    size_t framing_errors = 0; /* bytes without a stop bit; not received */

private:
    static constexpr int64_t NEVER = INT64_MAX;

    void send_bit();
    void sample();

    double bit_ps_;

    /* Towards the controller: the frame being sent is start bit, byte, stop bit. */
    std::deque<uint8_t> waiting_;
    int64_t send_ps_ = NEVER;
    int64_t frame_ps_ = 0;
    double frame_bit_ps_ = 0;
    unsigned frame_ = 0, frame_bit_ = 0;
    bool sending_ = false;
    bool level_ = true;

    /* From the controller. */
    int64_t sample_ps_ = NEVER;
    int64_t start_ps_ = 0;
    double sample_bit_ps_ = 0;
    unsigned sampled_ = 0, sample_bit_ = 0;
    bool heard_ = true;
};

#endif
