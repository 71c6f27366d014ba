/* SPDX-License-Identifier: BSD-2-Clause */
/** Random but telling: what happens at the input pins and on the bus while model and gateware are compared. */
#ifndef TWIN_STIMULUS_H
#define TWIN_STIMULUS_H

#include <cstdint>
#include <deque>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "../board/adc.h"
#include "block.h"

namespace twin {

struct Field {
    std::string name; /* block.register.field */
    uint32_t address;
    unsigned shift, width;
    std::string access; /* R, W, RW or RW1C */
    uint32_t mask() const { return (width < 32 ? (1u << width) - 1 : ~0u) << shift; }
};

struct Access {
    uint32_t address, value;
    bool write;
    unsigned select; /* bytes; 15 is the whole word */
};

class Random {
public:
    explicit Random(uint32_t seed) : engine_(seed) {}
    /** first to last, both included. */
    int64_t from(int64_t first, int64_t last)
    {
        return first + int64_t(engine_() % uint64_t(last - first + 1));
    }
    bool one_in(unsigned n) { return engine_() % n == 0; }
    uint32_t word() { return uint32_t(engine_()); }

private:
    std::mt19937_64 engine_;
};

/** Levels of all input pins over time. */
class PinStimulus {
public:
    explicit PinStimulus(Random &random);

    /** Clocks of a bit on the serial line. */
    uint32_t divisor = 434;

    uint64_t levels() const { return levels_; }
    /** The converter's pins, from the controller, after `edge`. */
    void convert(uint64_t outputs, Time edge);

    /** The next edge that is the first to sample something new; then let it happen. */
    Time next() const;
    void happen(Time edge);

private:
    struct Encoder {
        Time next = 200;
        int direction = 1;
        Time gap = 8;
        unsigned left = 0; /* steps of this speed */
    };

    void step(unsigned axis, Time edge);
    void frame(Time edge);
    Time pulse(Time otherwise);
    void set(unsigned pin, bool level) { levels_ = level ? levels_ | bit(pin) : levels_ & ~bit(pin); }

    Random &random_;
    uint64_t levels_ = bit(SERIAL_RX);
    Encoder encoders_[AXES];
    std::map<unsigned, Time> slow_; /* pins that toggle now and then, and when next */
    std::deque<std::pair<Time, bool>> serial_; /* levels to come */
    Time serial_next_ = 300;
    unsigned burst_ = 0; /* edges of IN0 */
    plant::Adc converter_;
    std::deque<std::pair<Time, bool>> miso_;
    bool connected_ = true; /* the converter */
};

/** Register accesses. */
class BusStimulus {
public:
    BusStimulus(Random &random, const std::vector<Field> &fields);

    /** What registers are compared with, now: values near it tell more than others. */
    struct Now {
        uint32_t timer;
        int32_t count[AXES];
    };
    Access next(const Now &now);

private:
    uint32_t value(uint32_t address, const Now &now);
    void line(const Now &now);
    void flash();
    uint32_t flash_address();

    Random &random_;
    std::vector<uint32_t> addresses_;
    std::map<uint32_t, bool> writable_;
    std::deque<Access> script_;
};

} // namespace twin

#endif
