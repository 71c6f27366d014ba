/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Model and Verilated gateware side by side: the same random accesses and pin events into both; every register read,
 * and every change of an output pin or interrupt line with its clock edge, compared.
 *
 *     lockstep FIELDS SEED ACCESSES [read|write|pin NAME]
 *
 * FIELDS: the file that gateware.py writes. With a last pair one thing of the model is broken: the lowest bit of a
 * field as it is read or written, or an output pin, which changes a clock late. Exit status 0: they agreed to the end;
 * 1: they did not, and where is said on the last line. Before that come "toggled" lines: which bits of which field
 * were seen as 0 and as 1.
 */
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <fstream>
#include <memory>
#include <sstream>

#include "Vabbe.h"
#include "gateware.h"
#include "stimulus.h"
#include "verilated.h"

namespace {

using namespace twin;

struct Change {
    Time edge;
    uint64_t pins; /* that changed */
};

struct Pin {
    const char *name;
    unsigned bit;
};

constexpr Pin PINS[] = {{"pwm", PWM}, {"dir", DIR}, {"motor_enable", MOTOR_ENABLE}, {"out0", OUT0},
                        {"sync_out", SYNC_OUT}, {"encoder_out", ENCODER_OUT}, {"serial_tx", SERIAL_TX},
                        {"adc_cs_n", ADC_CS_N}, {"adc_sck", ADC_SCK}, {"adc_mosi", ADC_MOSI},
                        {"report_tx", REPORT_TX}, {"flash_cs_n", FLASH_CS_N}, {"flash_sck", FLASH_SCK},
                        {"flash_mosi", FLASH_MOSI}, {"report", INTERRUPT + INTERRUPT_REPORT},
                        {"trigger", INTERRUPT + INTERRUPT_TRIGGER},
                        {"tick", INTERRUPT + INTERRUPT_TICK}, {"serial", INTERRUPT + INTERRUPT_SERIAL},
                        {"timer", INTERRUPT + INTERRUPT_TIMER}, {"line", INTERRUPT + INTERRUPT_LINE},
                        {"bus", INTERRUPT + INTERRUPT_BUS}};

/** A flash that is fast, so that much is seen of it. */
class QuickFlash {
public:
    QuickFlash() : contents_(NOR_BYTES, 0xff)
    {
        nor_init(&nor, contents_.data());
        nor.program_ps = 4000000;
        nor.erase_ps = 10000000;
    }
    struct nor nor;

private:
    std::vector<uint8_t> contents_;
};

/** The Verilated gateware, and a flash at its pins. */
class Device {
public:
    Device()
    {
        top_.rst = top_.fast_rst = top_.cpu_rst = 1;
        show(bit(SERIAL_RX));
        top_.flash_miso = 1;
        for (Time edge = -16; edge < 0; edge++)
            clock(edge);
        top_.rst = top_.fast_rst = top_.cpu_rst = 0;
        levels_ = outputs();
    }

    void show(uint64_t pins)
    {
        top_.enc_a = pins >> ENC_A & 0xf;
        top_.enc_b = pins >> ENC_B & 0xf;
        top_.enc_z = pins >> ENC_Z & 0xf;
        top_.limit_lower = pins >> LIMIT_LOWER & 0xf;
        top_.limit_upper = pins >> LIMIT_UPPER & 0xf;
        top_.estop = pins >> ESTOP & 1;
        top_.in0 = pins >> IN0 & 1;
        top_.in1 = pins >> IN1 & 1;
        top_.serial_rx = pins >> SERIAL_RX & 1;
        top_.button = pins >> BUTTON & 0xf;
        top_.joystick_button = pins >> JOYSTICK_BUTTON & 1;
        top_.dip = pins >> DIP & 0xf;
        top_.knob_a = pins >> KNOB_A & 7;
        top_.knob_b = pins >> KNOB_B & 7;
        top_.adc_miso = pins >> ADC_MISO & 1;
    }

    void begin(const Access &access)
    {
        top_.bus_address = access.address;
        top_.bus_write_data = access.value;
        top_.bus_write = access.write;
        top_.bus_select = access.select;
        top_.bus_strobe = 1;
    }
    void end() { top_.bus_strobe = 0; }
    bool acknowledged() const { return top_.bus_ack; }
    uint32_t data() const { return top_.bus_read_data; }

    /** Pins that changed at this edge. */
    uint64_t run(Time edge)
    {
        clock(edge);
        const uint64_t now = outputs(), changed = now ^ levels_;
        levels_ = now;
        if (changed & bits(FLASH_CS_N, 3))
            top_.flash_miso = nor_pins(&flash_.nor, edge * FAST_PS, now >> FLASH_CS_N & 1, now >> FLASH_SCK & 1,
                                       now >> FLASH_MOSI & 1);
        return changed;
    }
    uint64_t levels() const { return levels_; }

private:
    void clock(Time edge)
    {
        top_.fast_clk = 1;
        top_.clk = edge % SYNC == 0;
        top_.eval();
        top_.fast_clk = top_.clk = 0;
        top_.eval();
    }

    uint64_t outputs() const
    {
        return uint64_t(top_.pwm) << PWM | uint64_t(top_.dir) << DIR | uint64_t(top_.motor_enable) << MOTOR_ENABLE |
               uint64_t(top_.out0) << OUT0 | uint64_t(top_.sync_out) << SYNC_OUT |
               uint64_t(top_.encoder_out) << ENCODER_OUT | uint64_t(top_.serial_tx) << SERIAL_TX |
               uint64_t(top_.adc_cs_n) << ADC_CS_N | uint64_t(top_.adc_sck) << ADC_SCK |
               uint64_t(top_.adc_mosi) << ADC_MOSI | uint64_t(top_.report_tx) << REPORT_TX |
               uint64_t(top_.flash_cs_n) << FLASH_CS_N | uint64_t(top_.flash_sck) << FLASH_SCK |
               uint64_t(top_.flash_mosi) << FLASH_MOSI |
               uint64_t(top_.interrupts) << INTERRUPT;
    }

    static constexpr int64_t FAST_PS = 1000000000000 / FAST_CLOCK_HZ;

    Vabbe top_;
    QuickFlash flash_;
    uint64_t levels_ = 0;
};

/** The model's pins. */
class Log final : public Outputs {
public:
    std::deque<Change> changes;
    uint64_t late = 0; /* these are a clock late: a fault for the test to find */

private:
    void changed(Time edge, uint64_t pins) override
    {
        if (pins & late)
            edge++;
        if (changes.empty() || changes.back().edge != edge)
            changes.push_back({edge, 0});
        /* A write may take back what happened at its edge. */
        if ((changes.back().pins ^= pins) == 0)
            changes.pop_back();
    }
};

struct Seen {
    uint32_t zeros = 0, ones = 0;
};

class Lockstep {
public:
    Lockstep(std::vector<Field> fields, const Gateware::Build &build, uint32_t seed)
        : fields_(std::move(fields)), random_(seed), pins_(random_), bus_(random_, fields_),
          gateware_(log_, pins_.levels(), build, &flash_.nor), timer_init_(build.timer)
    {
        for (size_t n = 0; n < fields_.size(); n++)
            by_address_.emplace(fields_[n].address, n);
        seen_.resize(fields_.size());
    }

    /** Break the model; false: there is no such thing. */
    bool break_model(const std::string &what, const std::string &name)
    {
        if (what == "pin") {
            for (const Pin &pin : PINS)
                if (name == pin.name)
                    log_.late = bit(pin.bit);
            return log_.late != 0;
        }
        for (const Field &field : fields_)
            if (field.name == name) {
                (what == "read" ? broken_read_ : broken_write_) = field.address;
                broken_mask_ = 1u << field.shift;
                return true;
            }
        return false;
    }

    bool run(uint64_t accesses)
    {
        Time next_access = 400, busy_until = -1;
        for (Time edge = 0; accesses > 0; edge++) {
            if (pins_.next() == edge) {
                pins_.divisor = gateware_.serial_divisor();
                pins_.happen(edge);
                gateware_.run_before(edge);
                gateware_.input(edge, pins_.levels());
                device_.show(pins_.levels());
                events++;
            }
            bool compare = false;
            Access access{};
            if (edge == busy_until)
                ending_ = true;
            if (edge >= next_access && edge % SYNC == 0) {
                gateware_.run_before(edge);
                BusStimulus::Now now{uint32_t(timer_init_) + uint32_t(edge / SYNC), {}};
                for (unsigned axis = 0; axis < AXES; axis++)
                    now.count[axis] = gateware_.count(axis, edge);
                access = bus_.next(now);
                device_.begin(access);
                compare = true;
                busy_until = edge + SYNC;
                next_access = edge + 2 * SYNC + SYNC * (random_.one_in(40) ? random_.from(0, 400) : random_.from(0, 5));
                accesses--;
            }
            uint32_t expected = 0;
            const bool mapped = access.select == 15 && gateware_.has(access.address);
            if (compare)
                expected = into_model(access, mapped, edge);
            const uint64_t changed = device_.run(edge);
            if (changed)
                changes_.push_back({edge, changed});
            if (changed & bits(ADC_CS_N, 3))
                pins_.convert(device_.levels(), edge);
            if (ending_) {
                device_.end();
                ending_ = false;
            }
            if (compare && !check(access, mapped, expected, edge))
                return false;
            if ((edge % 256 == 0 || compare) && !check_pins(edge))
                return false;
            end_ = edge;
        }
        return true;
    }

    void report() const
    {
        for (size_t n = 0; n < fields_.size(); n++) {
            const Field &field = fields_[n];
            const uint32_t toggled = seen_[n].zeros & seen_[n].ones & field.mask();
            std::printf("toggled %s %s %u %u\n", field.name.c_str(), field.access.c_str(),
                        unsigned(__builtin_popcount(toggled)), field.width);
        }
        std::printf("pin events %" PRIu64 "\n", events);
        std::printf("pin changes %" PRIu64 "\n", matched_);
        std::printf("fast clocks %" PRId64 "\n", end_);
    }

private:
    uint32_t into_model(const Access &access, bool mapped, Time edge)
    {
        if (!mapped) {
            if (access.write)
                gateware_.refuse(access.address, edge);
            return 0;
        }
        see(access);
        if (access.write) {
            const uint32_t flip = access.address == broken_write_ ? broken_mask_ : 0;
            gateware_.write(access.address, access.value ^ flip, edge);
            return 0;
        }
        return gateware_.read(access.address, edge) ^ (access.address == broken_read_ ? broken_mask_ : 0);
    }

    /** What is written counts for fields that cannot be read. */
    void see(const Access &access)
    {
        if (!access.write)
            return;
        for (auto [at, last] = by_address_.equal_range(access.address); at != last; ++at)
            if (fields_[at->second].access == "W")
                note(at->second, access.value);
    }

    void note(size_t n, uint32_t value)
    {
        seen_[n].ones |= value;
        seen_[n].zeros |= ~value;
    }

    bool check(const Access &access, bool mapped, uint32_t expected, Time edge)
    {
        if (device_.acknowledged() != mapped) {
            std::printf("edge %" PRId64 ": access to 0x%08x: %s\n", edge, access.address,
                        mapped ? "bus error, none expected" : "no bus error, one expected");
            return false;
        }
        if (!mapped || access.write)
            return true;
        for (auto [at, last] = by_address_.equal_range(access.address); at != last; ++at)
            note(at->second, device_.data());
        if (device_.data() == expected)
            return true;
        for (auto [at, last] = by_address_.equal_range(access.address); at != last; ++at) {
            const Field &field = fields_[at->second];
            if ((device_.data() ^ expected) & field.mask())
                std::printf("edge %" PRId64 ": %s reads 0x%x in the gateware, 0x%x in the model\n", edge,
                            field.name.c_str(), (device_.data() & field.mask()) >> field.shift,
                            (expected & field.mask()) >> field.shift);
        }
        return false;
    }

    /** Changes before `edge`, which the model has run up to. */
    bool check_pins(Time edge)
    {
        gateware_.run_before(edge);
        while (true) {
            const Time device = changes_.empty() ? NEVER : changes_.front().edge;
            const Time model = log_.changes.empty() ? NEVER : log_.changes.front().edge;
            if (std::min(device, model) >= edge)
                return true;
            const uint64_t pins = device <= model ? changes_.front().pins : 0;
            const uint64_t predicted = model <= device ? log_.changes.front().pins : 0;
            if (pins != predicted) {
                for (const Pin &pin : PINS)
                    if ((pins ^ predicted) >> pin.bit & (pin.bit <= DIR ? 0xf : 1))
                        std::printf("edge %" PRId64 ": %s changes in the %s only\n", std::min(device, model), pin.name,
                                    pins >> pin.bit & (pin.bit <= DIR ? 0xf : 1) ? "gateware" : "model");
                return false;
            }
            changes_.pop_front();
            log_.changes.pop_front();
            matched_++;
        }
    }

    std::vector<Field> fields_;
    std::multimap<uint32_t, size_t> by_address_;
    std::vector<Seen> seen_;
    Random random_;
    PinStimulus pins_;
    BusStimulus bus_;
    Log log_;
    QuickFlash flash_;
    Gateware gateware_;
    Device device_;
    const uint64_t timer_init_;
    std::deque<Change> changes_;
    bool ending_ = false;
    uint32_t broken_read_ = 0, broken_write_ = 0, broken_mask_ = 0;
    uint64_t events = 0, matched_ = 0;
    Time end_ = 0;
};

/** The table of fields, and what it says of the design. */
std::vector<Field> read_fields(const char *path, Gateware::Build &build)
{
    std::vector<Field> fields;
    std::ifstream file(path);
    std::string name, access;
    uint64_t address;
    unsigned shift, width;
    while (file >> name >> address >> shift >> width >> access) {
        if (name == "time")
            build.time = address;
        else if (name == "timer")
            build.timer = address;
        else if (name == "millisecond")
            build.millisecond = Time(address);
        else
            fields.push_back({name, uint32_t(address), shift, width, access});
    }
    return fields;
}

} // namespace

int main(int argument_count, char **arguments)
{
    if (argument_count != 4 && argument_count != 6) {
        std::fprintf(stderr, "usage: lockstep FIELDS SEED ACCESSES [read|write|pin NAME]\n");
        return 2;
    }
    Gateware::Build build;
    std::vector<Field> fields = read_fields(arguments[1], build);
    const auto lockstep = std::make_unique<Lockstep>(std::move(fields), build, uint32_t(std::atoi(arguments[2])));
    if (argument_count == 6 && !lockstep->break_model(arguments[4], arguments[5])) {
        std::fprintf(stderr, "there is no %s\n", arguments[5]);
        return 2;
    }
    const bool agreed = lockstep->run(std::strtoull(arguments[3], nullptr, 10));
    if (agreed)
        lockstep->report();
    return agreed ? 0 : 1;
}
