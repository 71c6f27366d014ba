/* SPDX-License-Identifier: BSD-2-Clause */
/** The flash's controller, a frame at a time, with the flash itself behind its pins: rtl/flash.py, tb/board/nor.h. */
#ifndef TWIN_FLASH_H
#define TWIN_FLASH_H

#include "../board/nor.h"
#include "block.h"

namespace twin {

class Flash final : public Block {
public:
    /** @param nor  Stays the caller's; nullptr: none is fitted. */
    Flash(Outputs &outputs, struct nor *nor);

    uint32_t read(uint32_t address, Time edge) override;
    void write(uint32_t address, uint32_t value, Time edge) override;
    void run(Time edge) override;

private:
    enum class State { IDLE, SELECT, HEADER, BYTE, DATA, END, REST };

    void start(uint32_t opcode, uint32_t size, Time edge);
    void abort(Time edge);
    void bit(Time edge, bool mosi);
    void byte(Time edge);
    void begin_data(uint8_t byte, Time edge);
    void to(State state, Time next);
    void plan();
    void set(Time edge, unsigned pin, bool level);
    void look();

    Outputs &outputs_;
    struct nor *const nor_;

    uint32_t address_ = 0, lowest_;
    bool refused_ = false;

    State state_ = State::IDLE;
    Time next_ = NEVER;      /* when the state does something */
    Past<bool> busy_;
    Past<bool> waiting_;     /* a word in word_ is not taken yet, by whoever takes it */
    Time take_ = NEVER;      /* Data is read at this edge */
    uint32_t word_ = 0, assembled_ = 0;

    bool reading_ = false, changing_ = false;
    uint32_t header_ = 0, left_ = 0; /* bits to send, the next on top; bytes to come */
    unsigned header_bits_ = 0, half_ = 0, lane_ = 0; /* half_: bits and halves of bits of a byte or header done */
    uint8_t shift_ = 0;
    bool settling_ = false, fetched_ = false, full_ = false;

    /* What the flash sees, once the edge that made it so is over. */
    bool cs_n_ = true, sck_ = false, mosi_ = false, miso_ = true, unseen_ = false;
    Time seen_from_ = 0;
};

} // namespace twin

#endif
