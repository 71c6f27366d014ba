/* SPDX-License-Identifier: BSD-2-Clause */
#include "stimulus.h"

#include <algorithm>

namespace twin {

/* --- Pins ---------------------------------------------------------------------------------------------------- */

PinStimulus::PinStimulus(Random &random) : random_(random)
{
    for (unsigned pin = 0; pin < INPUT_PINS; pin++) {
        if (pin >= ENC_Z && pin != SERIAL_RX && pin != ADC_MISO)
            slow_[pin] = random.from(200, 3000);
    }
}

Time PinStimulus::next() const
{
    Time next = serial_.empty() ? serial_next_ : serial_.front().first;
    for (const Encoder &encoder : encoders_)
        next = std::min(next, encoder.next);
    for (const auto &[pin, time] : slow_)
        next = std::min(next, time);
    return miso_.empty() ? next : std::min(next, miso_.front().first);
}

void PinStimulus::happen(Time edge)
{
    for (unsigned axis = 0; axis < AXES; axis++)
        if (encoders_[axis].next == edge)
            step(axis, edge);
    for (auto &[pin, time] : slow_)
        if (time == edge) {
            levels_ ^= bit(pin);
            /* The emergency stop is released most of the time, so that drives are on; contacts bounce, then rest. */
            const bool rests = (pin == ESTOP && !(levels_ >> pin & 1)) || (pin >= BUTTON && !random_.one_in(3));
            time = edge + (rests ? random_.from(1, 60000) : random_.from(1, random_.one_in(4) ? 12 : 1500));
            if (pin == IN0)
                time = edge + pulse(time - edge);
        }
    while (!miso_.empty() && miso_.front().first == edge) {
        set(ADC_MISO, miso_.front().second);
        miso_.pop_front();
    }
    if (serial_.empty() && serial_next_ == edge)
        frame(edge);
    while (!serial_.empty() && serial_.front().first == edge) {
        set(SERIAL_RX, serial_.front().second);
        serial_.pop_front();
        if (serial_.empty())
            serial_next_ = edge + Time(divisor) * SYNC * (random_.one_in(3) ? 1 : random_.from(1, 4));
    }
}

/** Now and then IN0 has a burst of pulses, the shortest that there are. */
Time PinStimulus::pulse(Time otherwise)
{
    if (burst_ == 0 && random_.one_in(8))
        burst_ = unsigned(random_.from(1, 60));
    if (burst_ == 0)
        return otherwise;
    burst_--;
    return random_.one_in(8) ? random_.from(1, 4) : 1;
}

/** An encoder edge; now and then both channels at once, a spike, or another speed or direction. */
void PinStimulus::step(unsigned axis, Time edge)
{
    Encoder &encoder = encoders_[axis];
    if (encoder.left == 0) {
        static constexpr Time slowest[] = {1, 3, 8, 20, 60, 300, 3000};
        encoder.gap = slowest[random_.from(0, 6)];
        encoder.left = unsigned(random_.from(1, encoder.gap < 100 ? 200 : 10));
        encoder.direction = random_.one_in(2) ? 1 : -1;
    }
    encoder.left--;
    if (random_.one_in(9))
        encoder.direction = -encoder.direction;
    if (random_.one_in(300)) {
        levels_ ^= bit(ENC_A + axis) | bit(ENC_B + axis);
    } else {
        const bool a = levels_ >> (ENC_A + axis) & 1, b = levels_ >> (ENC_B + axis) & 1;
        levels_ ^= bit((a == b) == (encoder.direction > 0) ? ENC_A + axis : ENC_B + axis);
    }
    encoder.next = edge + random_.from(1, encoder.gap);
}

void PinStimulus::convert(uint64_t outputs, Time edge)
{
    if (random_.one_in(400)) {
        converter_.set_input(unsigned(random_.from(0, 7)), double(random_.from(-10, 4200)) / 4096);
        connected_ = !random_.one_in(8);
    }
    const bool level = converter_.pins(outputs >> ADC_CS_N & 1, outputs >> ADC_SCK & 1, outputs >> ADC_MOSI & 1);
    miso_.push_back({edge + 4, level || !connected_});
}

/** A byte on the serial line, a little fast or slow; or a break, or noise. */
void PinStimulus::frame(Time edge)
{
    const Time bit_fast = Time(divisor) * SYNC;
    Time at = edge;
    if (random_.one_in(8)) {
        for (int64_t n = random_.from(1, 5); n > 0; n--) {
            serial_.push_back({at, n % 2 == 0});
            at += random_.from(1, 14 * bit_fast);
        }
        serial_.push_back({at, true});
        return;
    }
    const unsigned bits = random_.one_in(3) ? 0x200u : unsigned(0x200 | random_.from(0, 255) << 1);
    const Time length = std::max<Time>(4, bit_fast + random_.from(-bit_fast / 50, bit_fast / 50));
    for (unsigned n = 0; n < 10; n++, at += length)
        serial_.push_back({at, bits >> n & 1});
}

/* --- Bus ----------------------------------------------------------------------------------------------------- */

BusStimulus::BusStimulus(Random &random, const std::vector<Field> &fields) : random_(random)
{
    for (const Field &field : fields) {
        if (writable_.find(field.address) == writable_.end())
            addresses_.push_back(field.address);
        writable_[field.address] |= field.access != "R";
    }
    script_.push_back({REG_WATCHDOG_STATUS, 0, false, 15}); /* cold, as never again */
}

Access BusStimulus::next(const Now &now)
{
    if (!script_.empty()) {
        const Access access = script_.front();
        script_.pop_front();
        return access;
    }
    if (random_.one_in(60))
        line(now);
    if (random_.one_in(2000))
        flash();
    if (random_.one_in(2500)) { /* fill a transmitter, and look at it */
        const bool report = random_.one_in(2);
        for (int64_t n = random_.from(30, 80); n > 0; n--)
            script_.push_back({report ? REG_REPORT_DATA : REG_SERIAL_DATA, random_.word(), true, 15});
        script_.push_back({report ? REG_REPORT_STATUS : REG_SERIAL_STATUS, 0, false, 15});
    }
    if (random_.one_in(30)) /* faults are many, and drives are to be on now and then */
        script_.push_back({REG_INTERLOCK_CLEAR, ~0u, true, 15});
    if (random_.one_in(60000)) /* empty the trigger's queue, or nearly so */
        for (int64_t n = random_.from(1, 1100); n > 0; n--)
            script_.push_back({REG_TRIGGER_NEXT, random_.word() | 1, true, 15});
    if (random_.one_in(500)) /* nowhere, or not a whole word */
        return {random_.one_in(2) ? random_.word() & 0x7fffffff : 0xfffff000 | (random_.word() & 0xfff),
                random_.word(), random_.one_in(2), unsigned(random_.from(0, 14))};
    const uint32_t address = addresses_[size_t(random_.from(0, int64_t(addresses_.size()) - 1))];
    const bool write = random_.one_in(writable_[address] ? 2 : 20);
    if (write && address == REG_SNAPSHOT_CONTROL) /* busy for some clocks */
        script_.push_back({REG_SNAPSHOT_STATUS, 0, false, 15});
    return {address, write ? value(address, now) : 0, write, 15};
}

/** Settings of a line that will be crossed, arming, and a look at what it became. */
void BusStimulus::line(const Now &now)
{
    const unsigned axis = unsigned(random_.from(0, 3));
    const auto write = [&](uint32_t address, uint32_t value) { script_.push_back({address, value, true, 15}); };
    if (random_.one_in(2))
        write(REG_QUADRATURE_CONFIG + axis * REG_QUADRATURE_STRIDE, 0);
    write(REG_DIVIDER_AXIS, random_.one_in(6) ? unsigned(random_.from(0, 3)) : axis);
    write(REG_DIVIDER_WHOLE, uint32_t(random_.from(1, random_.one_in(3) ? 9 : 2)));
    write(REG_DIVIDER_FRACTION, random_.one_in(3) ? 0 : random_.word());
    write(REG_DIVIDER_PHASE, random_.one_in(3) ? ~0u : random_.word());
    write(REG_DIVIDER_PIXELS, uint32_t(random_.from(1, random_.one_in(2) ? 4 : 60)));
    write(REG_DIVIDER_WIDTH, uint32_t(random_.from(1, random_.one_in(2) ? 3 : 40)));
    write(REG_DIVIDER_INTERVAL_MIN, random_.one_in(16) ? uint32_t(random_.from(0, 20)) : ~0u);
    write(REG_DIVIDER_CONFIG, !random_.one_in(5));
    const bool reverse = random_.one_in(2);
    write(REG_COMPARE_CONFIG, axis << REG_COMPARE_CONFIG_AXIS_SHIFT | (reverse ? REG_COMPARE_CONFIG_REVERSE_MASK : 0));
    write(REG_COMPARE_REFERENCE, uint32_t(now.count[axis] + (reverse ? -1 : 1) * random_.from(-2, 12)));
    write(REG_COMPARE_CONTROL, REG_COMPARE_CONTROL_ARM_MASK);
    for (int64_t looks = random_.from(0, 12); looks > 0; looks--)
        script_.push_back({looks % 2 ? REG_COMPARE_STATUS : REG_DIVIDER_PRODUCED, 0, false, 15});
    for (const uint32_t address : {REG_DIVIDER_MERGED, REG_DIVIDER_END_POSITION, REG_COMPARE_INTERRUPT})
        script_.push_back({address, 0, false, 15});
}

/** In a few sectors, of which some are guarded; often near the end of a page. */
uint32_t BusStimulus::flash_address()
{
    static constexpr uint32_t sectors[] = {0x3fd000, 0x3fe000, 0x3ff000, 0x400000, 0xffe000, 0xfff000};
    return sectors[random_.from(0, 5)] + uint32_t(random_.one_in(2) ? random_.from(250, 262) : random_.from(0, 4095));
}

/** A change of the flash and a look at it, with and without the patience that either needs. */
void BusStimulus::flash()
{
    const auto write = [&](uint32_t address, uint32_t value) { script_.push_back({address, value, true, 15}); };
    const auto read = [&](uint32_t address, int64_t times) {
        for (; times > 0; times--)
            script_.push_back({address, 0, false, 15});
    };
    const auto frame = [&](uint32_t opcode, uint32_t size) { write(REG_FLASH_FRAME, opcode | size << REG_FLASH_FRAME_SIZE_SHIFT); };
    const uint32_t size = uint32_t(random_.from(1, random_.one_in(4) ? 20 : 6)), address = flash_address();
    write(REG_FLASH_CONTROL, REG_FLASH_CONTROL_ABORT_MASK);
    write(REG_FLASH_ADDRESS, address);
    if (!random_.one_in(3)) {
        read(REG_FLASH_STATUS, 14);
        frame(0x06, 0);
        read(REG_FLASH_STATUS, random_.one_in(6) ? random_.from(0, 20) : 20);
        const bool erase = random_.one_in(3);
        frame(erase ? 0x20 : 0x02, size);
        for (uint32_t n = 0; n < size && !erase; n += 4) {
            write(REG_FLASH_DATA, random_.word());
            read(REG_FLASH_STATUS, random_.one_in(6) ? random_.from(0, 40) : 20);
        }
        read(REG_FLASH_STATUS, random_.from(10, 40));
        frame(0x05, uint32_t(random_.from(1, 5)));
        for (int64_t looks = random_.from(1, 8); looks > 0; looks--) {
            read(REG_FLASH_STATUS, 8);
            read(REG_FLASH_DATA, 1);
        }
        if (!random_.one_in(3)) /* until it is done */
            read(REG_FLASH_STATUS, 60);
    }
    read(REG_FLASH_GUARD, 1);
    write(REG_FLASH_CONTROL, REG_FLASH_CONTROL_ABORT_MASK);
    read(REG_FLASH_STATUS, 20);
    frame(random_.one_in(8) ? 0x9f : 0x03, size + uint32_t(random_.from(0, 3)));
    for (uint32_t n = 0; n < size; n += 4) {
        read(REG_FLASH_STATUS, random_.one_in(6) ? random_.from(0, 40) : 20);
        read(REG_FLASH_DATA, 1);
    }
}

uint32_t BusStimulus::value(uint32_t address, const Now &now)
{
    const bool leaves_little_to_see = address == REG_SERIAL_DIVISOR || address == REG_REPORT_DIVISOR ||
                                      address == REG_PWM_TICK_DIVIDER ||
                                      address == REG_BUTTONS_DEBOUNCE || address == REG_KNOB_FILTER ||
                                      address == REG_LED_PERIOD;
    if (random_.one_in(leaves_little_to_see ? 60 : 16) && address != REG_SERIAL_DIVISOR &&
        address != REG_REPORT_DIVISOR && address != REG_FLASH_CONTROL)
        return random_.word();
    switch (address) {
    case REG_SERIAL_DIVISOR:
    case REG_REPORT_DIVISOR:
        if (random_.one_in(50)) { /* long bits would leave nothing to see */
            script_.push_back({address, 0, false, 15});
            script_.push_back({address, uint32_t(random_.from(0, 12)), true, 15});
            return random_.word();
        }
        return uint32_t(random_.from(0, random_.one_in(8) ? 40 : 12));
    case REG_SERIAL_INTERRUPT_ENABLE:
    case REG_REPORT_INTERRUPT_ENABLE: return uint32_t(random_.from(0, 7));
    case REG_TIMER_ALARM: return now.timer + uint32_t(random_.from(-30, 200));
    case REG_PWM_CONTROL: return random_.one_in(3) ? random_.word() : 0xf;
    case REG_PWM_TICK_DIVIDER: return uint32_t(random_.from(0, 3));
    case REG_PWM_DUTY_DELAY: return uint32_t(random_.from(0, 4));
    case REG_DIVIDER_WHOLE:
    case REG_DIVIDER_PIXELS:
    case REG_DIVIDER_WIDTH: return uint32_t(random_.from(0, 9));
    case REG_DIVIDER_INTERVAL_MIN: return random_.one_in(2) ? ~0u : uint32_t(random_.from(0, 20));
    case REG_COMPARE_REFERENCE: return uint32_t(now.count[random_.from(0, 3)] + random_.from(-20, 20));
    case REG_LED_PERIOD:
    case REG_LED_ON: return uint32_t(random_.from(0, random_.one_in(4) ? 600 : 30));
    case REG_WATCHDOG_TIMEOUT: return uint32_t(random_.from(0, random_.one_in(4) ? 100 : 20000));
    case REG_WATCHDOG_KICK: return random_.one_in(16) ? random_.word() : WATCHDOG_KICK_WORD;
    case REG_WATCHDOG_RESET: return random_.one_in(8) ? WATCHDOG_RESET_WORD : random_.word();
    case REG_INTERLOCK_WAY: return uint32_t(random_.from(0, random_.one_in(4) ? 3 : 15));
    case REG_INTERLOCK_DRIVE_TIME: return uint32_t(random_.from(0, random_.one_in(4) ? 40 : 3000));
    case REG_INTERLOCK_ILLEGAL_TIME: return uint32_t(random_.from(0, 5));
    case REG_ROUTER_OUT0: return random_.one_in(3) ? random_.word() : 5;
    case REG_ADC_CONTROL: return !random_.one_in(4);
    case REG_CLASSIFIER_THRESHOLD: return uint32_t(random_.from(0, random_.one_in(2) ? 4 : 60));
    case REG_CLASSIFIER_CONFIG:
        return (random_.one_in(8) ? 0 : REG_CLASSIFIER_CONFIG_ENABLE_MASK) |
               (random_.one_in(4) ? REG_CLASSIFIER_CONFIG_AT_THRESHOLD_MASK : 0) |
               uint32_t(random_.from(0, 2)) << REG_CLASSIFIER_CONFIG_FILTER_SHIFT;
    case REG_CLASSIFIER_CONTROL: return random_.one_in(2000);
    case REG_TRIGGER_CONFIG: /* enabled, and short pulses */
        return (random_.word() & REG_TRIGGER_CONFIG_OUTPUT_MASK) | (random_.word() & REG_TRIGGER_CONFIG_FALLING_MASK) |
               REG_TRIGGER_CONFIG_ENABLE_MASK | uint32_t(random_.from(0, 60)) << REG_TRIGGER_CONFIG_MINIMUM_SHIFT;
    case REG_FLASH_ADDRESS: return random_.one_in(3) ? random_.word() : flash_address();
    case REG_FLASH_FRAME: {
        static constexpr uint32_t opcodes[] = {0x02, 0x03, 0x05, 0x06, 0x20, 0x9f, 0xab};
        return opcodes[random_.from(0, 6)] | uint32_t(random_.from(0, 9)) << REG_FLASH_FRAME_SIZE_SHIFT;
    }
    case REG_FLASH_CONTROL: /* the lock is for ever */
        return (random_.one_in(2) ? REG_FLASH_CONTROL_ABORT_MASK : 0) | (random_.one_in(100) ? REG_FLASH_CONTROL_LOCK_MASK : 0);
    case REG_BUTTONS_DEBOUNCE:
    case REG_KNOB_FILTER: return uint32_t(random_.from(0, 4));
    case REG_BUTTONS_LONG:
    case REG_BUTTONS_EXTRA_LONG: return uint32_t(random_.from(0, 12));
    case REG_COMPARE_CONTROL:
        return random_.one_in(4) ? random_.word() : random_.one_in(3) ? REG_COMPARE_CONTROL_DISARM_MASK
                                                                      : REG_COMPARE_CONTROL_ARM_MASK;
    default: break;
    }
    if (address >= REG_INTERLOCK_STRONG_TIME0 && address < REG_INTERLOCK_BREAKAWAY0)
        return uint32_t(random_.from(0, random_.one_in(4) ? 40 : 1500));
    if (address >= REG_INTERLOCK_SPEED_MOST0 && address < REG_INTERLOCK_FOLLOWING_MOST0)
        return uint32_t(random_.from(0, random_.one_in(2) ? 500 : 20000));
    if (address >= REG_INTERLOCK_FOLLOWING_MOST0 && address < REG_INTERLOCK_EXPECTED0)
        return uint32_t(random_.from(0, 3000));
    if (address >= REG_INTERLOCK_EXPECTED0 && address <= REG_INTERLOCK_EXPECTED3)
        return uint32_t(now.count[(address - REG_INTERLOCK_EXPECTED0) / 4] + random_.from(-2000, 2000));
    if (address >= REG_QUADRATURE_CONFIG && address < REG_QUADRATURE_CONFIG + AXES * REG_QUADRATURE_STRIDE &&
        (address - REG_QUADRATURE_CONFIG) % REG_QUADRATURE_STRIDE == 0)
        return random_.one_in(2) ? 0 : random_.one_in(3) ? random_.word() : uint32_t(random_.from(0, 3));
    return random_.word();
}

} // namespace twin
