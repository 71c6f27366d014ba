/* SPDX-License-Identifier: BSD-2-Clause */
#include "flash.h"

#include <algorithm>

namespace twin {

namespace {

constexpr int64_t FAST_PS = 1000000000000 / FAST_CLOCK_HZ;

enum Opcode : uint32_t {
    PAGE_PROGRAM = 0x02,
    READ = 0x03,
    READ_STATUS = 0x05,
    WRITE_ENABLE = 0x06,
    SECTOR_ERASE = 0x20,
    READ_ID = 0x9f,
    WAKE = 0xab,
};

constexpr uint32_t SECTOR = 4096, LOWEST = 0x3fe000, GUARD = 0x400000, JUMP = 0xfff000;
constexpr Time SELECT_CLOCKS = 4, HALF_CLOCKS = 2, END_CLOCKS = 4, REST_CLOCKS = 8;

bool changes(uint32_t opcode)
{
    return opcode == PAGE_PROGRAM || opcode == SECTOR_ERASE;
}

bool reads(uint32_t opcode)
{
    return opcode == READ || opcode == READ_STATUS || opcode == READ_ID;
}

} // namespace

Flash::Flash(Outputs &outputs, struct nor *nor) : outputs_(outputs), nor_(nor), lowest_(LOWEST) {}

uint32_t Flash::read(uint32_t address, Time edge)
{
    const bool waiting = waiting_.before(edge), busy = busy_.before(edge);
    switch (address) {
    case REG_FLASH_DATA:
        take_ = edge;
        plan();
        return word_;
    case REG_FLASH_ADDRESS: return address_;
    case REG_FLASH_STATUS:
        return (busy ? REG_FLASH_STATUS_BUSY_MASK : 0) |
               ((changing_ ? busy && !waiting : waiting) ? REG_FLASH_STATUS_READY_MASK : 0) |
               (refused_ ? REG_FLASH_STATUS_REFUSED_MASK : 0);
    case REG_FLASH_GUARD: return lowest_;
    default: return 0;
    }
}

void Flash::write(uint32_t address, uint32_t value, Time edge)
{
    switch (address) {
    case REG_FLASH_DATA:
        if (changing_ && busy_.before(edge) && !waiting_.before(edge)) {
            word_ = value;
            waiting_.set(edge, true);
            if (state_ == State::BYTE && next_ == NEVER)
                next_ = edge + SYNC;
        }
        break;
    case REG_FLASH_ADDRESS: address_ = value & REG_FLASH_ADDRESS_VALUE_MASK; break;
    case REG_FLASH_FRAME:
        start(field(value, REG_FLASH_FRAME_OPCODE_MASK, REG_FLASH_FRAME_OPCODE_SHIFT),
              field(value, REG_FLASH_FRAME_SIZE_MASK, REG_FLASH_FRAME_SIZE_SHIFT), edge);
        break;
    case REG_FLASH_CONTROL:
        if (value & REG_FLASH_CONTROL_ABORT_MASK)
            abort(edge);
        if (value & REG_FLASH_CONTROL_LOCK_MASK)
            lowest_ = GUARD;
        break;
    }
    plan();
}

void Flash::start(uint32_t opcode, uint32_t size, Time edge)
{
    const bool known = changes(opcode) || reads(opcode) || opcode == WRITE_ENABLE || opcode == WAKE;
    const uint32_t sector = address_ / SECTOR * SECTOR;
    refused_ = busy_.before(edge) || !known || (changes(opcode) && (sector < lowest_ || sector == JUMP));
    if (refused_)
        return;
    reading_ = reads(opcode);
    changing_ = changes(opcode);
    header_ = opcode << 24 | address_;
    header_bits_ = changing_ || opcode == READ ? 32 : 8;
    left_ = reading_ || opcode == PAGE_PROGRAM ? size : 0;
    lane_ = 0;
    settling_ = fetched_ = full_ = false;
    waiting_.set(edge, false);
    busy_.set(edge, true);
    to(State::SELECT, edge + SYNC);
}

/** Before everything else that the state would have done. */
void Flash::abort(Time edge)
{
    if (state_ == State::IDLE || state_ == State::END || state_ == State::REST)
        return;
    set(edge, FLASH_SCK, false);
    to(State::END, edge + END_CLOCKS * SYNC);
}

void Flash::run(Time edge)
{
    if (take_ == edge) {
        take_ = NEVER;
        waiting_.set(edge, false);
        if (state_ == State::BYTE && next_ == NEVER)
            next_ = edge + SYNC;
    }
    if (next_ == edge) {
        look();
        switch (state_) {
        case State::SELECT:
            set(edge, FLASH_CS_N, false);
            half_ = 0;
            to(State::HEADER, edge + SELECT_CLOCKS * SYNC);
            break;
        case State::HEADER:
            bit(edge, header_ >> 31);
            if (half_ % 2 == 0)
                header_ <<= 1;
            if (half_ == 2 * header_bits_)
                state_ = State::BYTE;
            break;
        case State::BYTE: byte(edge); break;
        case State::DATA:
            bit(edge, changing_ ? shift_ >> 7 : mosi_);
            if (half_ % 2 == 0)
                shift_ = uint8_t(shift_ << 1 | miso_);
            if (half_ == 16) {
                settling_ = fetched_ = reading_;
                state_ = State::BYTE;
            }
            break;
        case State::END:
            set(edge, FLASH_CS_N, true);
            to(State::REST, edge + REST_CLOCKS * SYNC);
            break;
        case State::REST:
            busy_.set(edge, false);
            to(State::IDLE, NEVER);
            break;
        case State::IDLE: break;
        }
    }
    plan();
}

/** Half a bit: data as the clock falls, then the clock rises. */
void Flash::bit(Time edge, bool mosi)
{
    if (half_++ % 2 == 0) {
        set(edge, FLASH_SCK, false);
        set(edge, FLASH_MOSI, mosi);
    } else {
        set(edge, FLASH_SCK, true);
    }
    next_ = edge + HALF_CLOCKS * SYNC;
}

/** A clock between two bytes. */
void Flash::byte(Time edge)
{
    const bool waiting = waiting_.before(edge);
    set(edge, FLASH_SCK, false);
    next_ = edge + SYNC;
    if (settling_) {
        settling_ = false; /* its last bit is in the synchroniser */
    } else if (fetched_) {
        assembled_ = (assembled_ & ~(0xffu << 8 * lane_)) | uint32_t(shift_) << 8 * lane_;
        full_ = lane_ == 3 || left_ == 0;
        lane_ = (lane_ + 1) % 4;
        fetched_ = false;
    } else if (full_ && waiting) {
        next_ = waiting_.last() ? NEVER : next_; /* unless it is taken at this edge */
    } else if (full_) {
        word_ = assembled_;
        waiting_.set(edge, true);
        full_ = false;
    } else if (left_ == 0) {
        to(State::END, edge + END_CLOCKS * SYNC);
    } else if (reading_) {
        begin_data(0, edge);
    } else if (lane_ != 0) {
        begin_data(uint8_t(assembled_ >> 8 * lane_), edge);
        lane_ = (lane_ + 1) % 4;
    } else if (waiting) {
        assembled_ = word_;
        waiting_.set(edge, false);
        lane_ = 1;
        begin_data(uint8_t(assembled_), edge);
    } else {
        next_ = NEVER;
    }
}

void Flash::begin_data(uint8_t byte, Time edge)
{
    shift_ = byte;
    left_--;
    half_ = 0;
    to(State::DATA, edge + SYNC);
}

void Flash::to(State state, Time next)
{
    state_ = state;
    next_ = next;
}

void Flash::plan()
{
    due = std::min(next_, take_);
}

void Flash::set(Time edge, unsigned pin, bool level)
{
    if (seen_from_ != edge)
        look();
    outputs_.set(edge, pin, level);
    (pin == FLASH_CS_N ? cs_n_ : pin == FLASH_SCK ? sck_ : mosi_) = level;
    unseen_ = true;
    seen_from_ = edge;
}

/** The flash sees the pins. An abort at the same edge may have taken back what they did, so only now. */
void Flash::look()
{
    if (unseen_ && nor_)
        miso_ = nor_pins(nor_, seen_from_ * FAST_PS, cs_n_, sck_, mosi_);
    unseen_ = false;
}

} // namespace twin
