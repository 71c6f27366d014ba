/* SPDX-License-Identifier: BSD-2-Clause */
/** The clock loop around the Verilated top. Everything done once per `fast` clock is in `fast_edge`. */
#include "simulator.h"

#include <algorithm>
#include <cstdio>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "Vabbe.h"
#include "board/nor.h"
#include "board/serial_line.h"
#include "verilated.h"

/* What Vabbe::eval() does for the design itself. Around it eval() also empties message queues and deletes objects,
 * under a lock; eight times a `sync` clock that costs a fifth of the speed, so it is done once per run. */
void Vabbe___024root___eval(Vabbe___024root *root);

static_assert(SIM_FLASH_BYTES == NOR_BYTES, "size of the flash");

namespace {

constexpr int64_t NEVER = INT64_MAX;
constexpr uint32_t CONTROLLER_FAST = 1u << SIM_OUT0 | 1u << SIM_SYNC | 1u << SIM_ENCODER;
constexpr uint32_t CONTROLLER_SYNC = 0xffu << SIM_PWM | 1u << SIM_MOTOR_ENABLE | 1u << SIM_SERIAL_TX |
                                     1u << SIM_REPORT_TX;
constexpr uint32_t DRIVE = 0xffu << SIM_PWM | 1u << SIM_MOTOR_ENABLE;

struct Scheduled {
    int64_t time_ps;
    board_input input;
    int level;
};

struct Flash {
    std::vector<uint8_t> bytes = std::vector<uint8_t>(NOR_BYTES, 0xff);
    nor chip;
};

/** Move up to `size` elements from the front of `from` to `to`. */
template <typename T> size_t take(std::deque<T> &from, T *to, size_t size)
{
    const size_t count = std::min(size, from.size());
    std::copy_n(from.begin(), count, to);
    from.erase(from.begin(), from.begin() + std::ptrdiff_t(count));
    return count;
}

} // namespace

struct sim {
    VerilatedContext context;
    std::unique_ptr<Vabbe> top;
    board *const stage;
    SerialLine serial, report;

    int64_t now_ps = 0;       /* the next sync edge */
    int64_t next_ps = 0;      /* the next thing that happens outside the controller */
    int64_t sample_ps = NEVER, sample_period_ps = 0;
    std::deque<Scheduled> scheduled;
    uint64_t awake_clocks = 0;

    uint32_t levels = 0;
    std::unique_ptr<Flash> flash;
    uint32_t spi = 0; /* pins of the analog-to-digital converter and of the flash */
    uint32_t recorded = 0;
    uint32_t stop_rise = 0, stop_fall = 0;
    bool stop = false;
    std::deque<sim_change> changes;
    std::deque<sim_sample> samples;

    sim(board *made, double baud, int argument_count, const char *const *arguments)
        : stage(made), serial(baud), report(baud)
    {
        context.commandArgs(argument_count, const_cast<const char **>(arguments));
        top = std::make_unique<Vabbe>(&context, "abbe");
        top->clk = top->fast_clk = top->cpu_clk = 0;
        top->rst = top->fast_rst = top->cpu_rst = 1;
        top->flash_miso = 1;
        show_inputs(0);
        top->eval();
        levels |= controller_fast() | controller_sync();
        plan();
    }

    ~sim()
    {
        top->final();
        board_destroy(stage);
    }

    uint32_t controller_fast() const
    {
        return uint32_t(top->out0) << SIM_OUT0 | uint32_t(top->sync_out) << SIM_SYNC |
               uint32_t(top->encoder_out) << SIM_ENCODER;
    }

    uint32_t controller_sync() const
    {
        return uint32_t(top->pwm) << SIM_PWM | uint32_t(top->dir) << SIM_DIR |
               uint32_t(top->motor_enable) << SIM_MOTOR_ENABLE | uint32_t(top->serial_tx) << SIM_SERIAL_TX |
               uint32_t(top->report_tx) << SIM_REPORT_TX;
    }

    /** The pins in `mask` have these levels from `time_ps` on. */
    void change(int64_t time_ps, uint32_t mask, uint32_t now)
    {
        const uint32_t changed = (levels ^ now) & mask;
        levels ^= changed;
        stop |= (changed & ((levels & stop_rise) | (~levels & stop_fall))) != 0;
        for (uint32_t left = changed & recorded; left; left &= left - 1) {
            const uint32_t signal = uint32_t(__builtin_ctz(left));
            changes.push_back({time_ps, signal, levels >> signal & 1});
        }
    }

    /** The board's and the host's pins to the controller. */
    void show_inputs(int64_t time_ps)
    {
        const struct board_pins &pins = *board_pins(stage);
        top->enc_a = pins.enc_a;
        top->enc_b = pins.enc_b;
        top->enc_z = pins.enc_z;
        top->limit_lower = pins.limit_lower;
        top->limit_upper = pins.limit_upper;
        top->estop = pins.estop;
        top->in0 = pins.in0;
        top->in1 = pins.in1;
        top->button = pins.button;
        top->joystick_button = pins.joystick_button;
        top->dip = pins.dip;
        top->knob_a = pins.knob_a;
        top->knob_b = pins.knob_b;
        top->adc_miso = pins.adc_miso;
        top->serial_rx = serial.level();
        const uint32_t now = uint32_t(pins.enc_a) << SIM_ENC_A | uint32_t(pins.enc_b) << SIM_ENC_B |
                             uint32_t(pins.enc_z) << SIM_ENC_Z | uint32_t(pins.estop) << SIM_ESTOP |
                             uint32_t(pins.in0) << SIM_IN0 | uint32_t(pins.in1) << SIM_IN1 |
                             uint32_t(serial.level()) << SIM_SERIAL_RX;
        change(time_ps, ~(CONTROLLER_FAST | CONTROLLER_SYNC), now);
    }

    void plan()
    {
        next_ps = std::min({board_next_ps(stage), serial.next_ps(), report.next_ps(), sample_ps,
                            scheduled.empty() ? NEVER : scheduled.front().time_ps});
    }

    /** Let everything outside the controller happen that comes before `time_ps`. */
    void happen_before(int64_t time_ps)
    {
        while (next_ps < time_ps) {
            const int64_t at_ps = next_ps;
            if (board_next_ps(stage) == at_ps) {
                board_next(stage, nullptr);
            } else if (serial.next_ps() == at_ps) {
                serial.happen();
            } else if (report.next_ps() == at_ps) {
                report.happen();
            } else if (sample_ps == at_ps) {
                take_sample();
            } else {
                board_set_input(stage, scheduled.front().input, scheduled.front().level);
                scheduled.pop_front();
            }
            show_inputs(at_ps);
            plan();
        }
    }

    void take_sample()
    {
        sim_sample sample{};
        sample.time_ps = sample_ps;
        for (unsigned n = 0; n < BOARD_AXES; n++) {
            sample.position_counts[n] = board_position_counts(stage, n, sample_ps);
            sample.speed_counts_per_s[n] = board_speed_counts_per_s(stage, n, sample_ps);
        }
        samples.push_back(sample);
        sample_ps += sample_period_ps;
    }

    /** What the controller's slow pins do to the world. */
    void controller_changed(int64_t time_ps, uint32_t now)
    {
        if ((levels ^ now) & DRIVE)
            board_drive_pins(stage, time_ps, top->pwm, top->dir, top->motor_enable);
        if ((levels ^ now) >> SIM_SERIAL_TX & 1)
            serial.listen(time_ps, top->serial_tx);
        if ((levels ^ now) >> SIM_REPORT_TX & 1)
            report.listen(time_ps, top->report_tx);
        change(time_ps, CONTROLLER_SYNC, now);
        plan();
    }

    uint32_t controller_spi() const
    {
        return uint32_t(top->adc_cs_n) << 5 | uint32_t(top->adc_sck) << 4 | uint32_t(top->adc_mosi) << 3 |
               uint32_t(top->flash_cs_n) << 2 | uint32_t(top->flash_sck) << 1 | top->flash_mosi;
    }

    void spi_changed(int64_t time_ps)
    {
        const uint32_t changed = spi ^ controller_spi();
        spi ^= changed;
        if (changed >> 3) {
            board_adc_pins(stage, time_ps, top->adc_cs_n, top->adc_sck, top->adc_mosi);
            plan();
        }
        if ((changed & 7) && flash)
            top->flash_miso = nor_pins(&flash->chip, time_ps, top->flash_cs_n, top->flash_sck, top->flash_mosi) != 0;
    }

    void evaluate() { Vabbe___024root___eval(top->rootp); }

    template <bool SYNC> void fast_edge(int64_t time_ps)
    {
        if (next_ps < time_ps)
            happen_before(time_ps);
        top->fast_clk = 1;
        if (SYNC) {
            top->clk = 1;
            top->cpu_clk = !top->cpu_asleep || top->cpu_rst;
            awake_clocks += top->cpu_clk;
        }
        evaluate();
        if (SYNC) {
            const uint32_t now = controller_sync();
            if ((levels ^ now) & CONTROLLER_SYNC)
                controller_changed(time_ps, now);
            if (controller_spi() != spi)
                spi_changed(time_ps);
        }
        const uint32_t now = controller_fast();
        if ((levels ^ now) & CONTROLLER_FAST)
            change(time_ps, CONTROLLER_FAST, now);
        top->fast_clk = 0;
        if (SYNC)
            top->clk = top->cpu_clk = 0;
        evaluate();
    }

    void sync_period()
    {
        const bool reset = now_ps < SIM_RESET_SYNC_CLOCKS * SIM_SYNC_PERIOD_PS;
        if (reset != (top->rst != 0))
            top->rst = top->fast_rst = top->cpu_rst = reset;
        fast_edge<true>(now_ps);
        fast_edge<false>(now_ps + SIM_FAST_PERIOD_PS);
        fast_edge<false>(now_ps + 2 * SIM_FAST_PERIOD_PS);
        fast_edge<false>(now_ps + 3 * SIM_FAST_PERIOD_PS);
        now_ps += SIM_SYNC_PERIOD_PS;
    }

    sim_reason run(int64_t duration_ps, size_t stop_lines)
    {
        const int64_t end_ps = now_ps + duration_ps;
        sim_reason reason = SIM_TIME;
        stop = false;
        show_inputs(now_ps); /* hands on the board since the last run */
        plan();
        while (now_ps < end_ps && reason == SIM_TIME) {
            sync_period();
            if (stop)
                reason = SIM_PIN;
            else if (stop_lines && serial.lines >= stop_lines)
                reason = SIM_LINES;
        }
        happen_before(now_ps);
        top->eval();
        return context.gotFinish() ? SIM_FINISHED : reason;
    }
};

struct sim *sim_create(const char *plant, double baud, int argument_count, const char *const *arguments,
                       char *error, size_t error_size)
{
    board *stage = board_create(plant, error, error_size);
    return stage ? new sim(stage, baud, argument_count, arguments) : nullptr;
}

void sim_destroy(struct sim *sim)
{
    delete sim;
}

struct board *sim_board(struct sim *sim)
{
    return sim->stage;
}

int64_t sim_time_ps(const struct sim *sim)
{
    return sim->now_ps;
}

enum sim_reason sim_run(struct sim *sim, int64_t duration_ps, uint32_t stop_rise, uint32_t stop_fall,
                        size_t stop_lines)
{
    sim->stop_rise = stop_rise;
    sim->stop_fall = stop_fall;
    return sim->run(duration_ps, stop_lines);
}

void sim_schedule_input(struct sim *sim, int64_t time_ps, enum board_input input, int level)
{
    sim->scheduled.push_back({time_ps, input, level});
}

void sim_fit_flash(struct sim *sim, const uint8_t *bytes, size_t size)
{
    sim->flash = std::make_unique<Flash>();
    std::copy_n(bytes, std::min(size, sim->flash->bytes.size()), sim->flash->bytes.begin());
    nor_init(&sim->flash->chip, sim->flash->bytes.data());
}

const uint8_t *sim_flash(const struct sim *sim)
{
    if (!sim->flash)
        return nullptr;
    nor_advance(&sim->flash->chip, sim->now_ps);
    return sim->flash->bytes.data();
}

void sim_set_flash_times(struct sim *sim, int64_t program_ps, int64_t erase_ps)
{
    if (sim->flash) {
        sim->flash->chip.program_ps = program_ps;
        sim->flash->chip.erase_ps = erase_ps;
    }
}

void sim_serial_write(struct sim *sim, const uint8_t *bytes, size_t size)
{
    for (size_t n = 0; n < size; n++)
        sim->serial.write(bytes[n], sim->now_ps);
}

static size_t take_received(SerialLine &line, uint8_t *bytes, int64_t *start_ps, size_t size)
{
    auto &received = line.received;
    size_t count = 0;
    for (; count < size && !received.empty(); count++, received.pop_front()) {
        bytes[count] = received.front().value;
        start_ps[count] = received.front().start_ps;
    }
    return count;
}

size_t sim_serial_read(struct sim *sim, uint8_t *bytes, int64_t *start_ps, size_t size)
{
    return take_received(sim->serial, bytes, start_ps, size);
}

void sim_serial_set_baud(struct sim *sim, double baud)
{
    sim->serial.set_baud(baud);
}

size_t sim_serial_unsent(const struct sim *sim)
{
    return sim->serial.unsent();
}

size_t sim_serial_lines(const struct sim *sim)
{
    return sim->serial.lines;
}

size_t sim_serial_framing_errors(const struct sim *sim)
{
    return sim->serial.framing_errors;
}

size_t sim_report_read(struct sim *sim, uint8_t *bytes, int64_t *start_ps, size_t size)
{
    return take_received(sim->report, bytes, start_ps, size);
}

void sim_report_set_baud(struct sim *sim, double baud)
{
    sim->report.set_baud(baud);
}

size_t sim_report_framing_errors(const struct sim *sim)
{
    return sim->report.framing_errors;
}

void sim_set_recording(struct sim *sim, uint32_t signals)
{
    sim->recorded = signals;
}

uint32_t sim_levels(const struct sim *sim)
{
    return sim->levels;
}

size_t sim_take_changes(struct sim *sim, struct sim_change *changes, size_t size)
{
    return take(sim->changes, changes, size);
}

void sim_set_sampling(struct sim *sim, int64_t period_ps)
{
    sim->sample_period_ps = period_ps;
    sim->sample_ps = period_ps > 0 ? sim->now_ps + period_ps : NEVER;
}

size_t sim_take_samples(struct sim *sim, struct sim_sample *samples, size_t size)
{
    return take(sim->samples, samples, size);
}

void sim_clocks(const struct sim *sim, uint64_t *sync, uint64_t *awake)
{
    *sync = uint64_t(sim->now_ps / SIM_SYNC_PERIOD_PS);
    *awake = sim->awake_clocks;
}
