/* SPDX-License-Identifier: BSD-2-Clause */
/** The board: the plant grid, the drive's mean over a step, encoder edges in order of time, the pins. */
#include "board.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <vector>

#include "adc.h"
#include "axis.h"
#include "panel.h"
#include "parameters.h"

namespace {

constexpr int64_t NEVER = INT64_MAX;

int64_t whole_step_ps(const plant::Parameters &parameters)
{
    const double ps = parameters.plant_step_ns * 1e3;
    if (!(ps >= 1e3 && ps <= 1e9) || ps != std::floor(ps))
        throw std::invalid_argument("expected plant_step_ns within 1..1000000, in whole picoseconds");
    return int64_t(ps);
}

void set_bit(uint8_t &mask, unsigned bit, bool level)
{
    mask = uint8_t(level ? mask | 1u << bit : mask & ~(1u << bit));
}

/** The wires of one motor since the plant step began. */
struct Drive {
    double level = 0.0;  /* now */
    double sum_ps = 0.0; /* integral of the level up to since_ps */
    int64_t since_ps = 0;
};

struct AxisOnBoard {
    plant::Axis axis;
    Drive drive;
    int64_t count;
    int8_t stuck[3] = {-1, -1, -1}; /* by board_wire: a level, or -1 */
    bool cut = false;

    /** Nothing moves, and nothing has driven it since the plant step began. */
    bool idle() const { return axis.at_rest() && drive.level == 0.0 && drive.sum_ps == 0.0; }
};

} // namespace

struct board {
    int64_t step_ps;
    int64_t step_end_ps;
    int64_t next_ps;
    std::vector<AxisOnBoard> axes;
    std::vector<board_edge> edges; /* of the running step, in order of time */
    size_t next_edge = 0;
    bool resting = false; /* all axes are at rest without drive: plant steps would change nothing, and are left out */
    struct board_pins pins{};
    plant::Panel panel;
    plant::Adc adc;
    double contact_bounce_ps, knob_bounce_ps;
    int knob_place[BOARD_KNOBS] = {}; /* after all that it was told to turn */

    explicit board(const plant::Parameters &parameters)
        : step_ps(whole_step_ps(parameters)), step_end_ps(step_ps), next_ps(step_ps),
          contact_bounce_ps(parameters.contact_bounce_ms * 1e9), knob_bounce_ps(parameters.knob_bounce_us * 1e6)
    {
        pins.adc_miso = 1;
        for (unsigned channel = 0; channel < BOARD_CHANNELS; channel++)
            adc.set_input(channel, 0.5);
        for (const plant::AxisParameters &axis : parameters.axis) {
            plant::Axis made(axis, double(step_ps) * 1e-12);
            axes.push_back({made, {}, made.end_count()});
        }
        edges.reserve(64);
        for (unsigned n = 0; n < BOARD_AXES; n++) {
            show_encoder(n);
            show_limits(n);
        }
    }

    void drive(int64_t time_ps, unsigned n, double level)
    {
        if (resting && level != 0.0)
            wake(time_ps);
        Drive &drive = axes[n].drive;
        const int64_t at_ps = std::clamp(time_ps, drive.since_ps, step_end_ps);
        drive.sum_ps += drive.level * double(at_ps - drive.since_ps);
        drive.since_ps = at_ps;
        drive.level = std::clamp(level, -1.0, 1.0);
    }

    /** Plant steps go on, on their grid, with the one that runs at `time_ps`. */
    void wake(int64_t time_ps)
    {
        resting = false;
        step_end_ps = std::max(step_end_ps, (time_ps + step_ps - 1) / step_ps * step_ps);
        for (AxisOnBoard &on : axes)
            on.drive.since_ps = step_end_ps - step_ps;
        plan();
    }

    bool next(board_edge *edge)
    {
        const bool is_edge = next_edge < edges.size() && edges[next_edge].time_ps == next_ps;
        if (panel.next_ps() == next_ps) {
            panel.next();
            plan();
            return false;
        }
        if (is_edge) {
            const board_edge &now = edges[next_edge++];
            axes[now.axis].count = now.count;
            show_encoder(now.axis);
            if (edge)
                *edge = now;
        } else {
            end_step();
        }
        plan();
        return is_edge;
    }

    void plan()
    {
        const int64_t stage_ps = next_edge < edges.size() ? edges[next_edge].time_ps : resting ? NEVER : step_end_ps;
        next_ps = std::min(stage_ps, panel.next_ps());
    }

    void turn(int64_t time_ps, unsigned knob, int step)
    {
        const int before = knob_place[knob] & 3, after = (before + step) & 3;
        knob_place[knob] = after;
        /* Places 0, 1, 2, 3 are A B = 00, 10, 11, 01: one contact moves. */
        const bool a = after == 1 || after == 2, b = after >= 2, a_moves = a != (before == 1 || before == 2);
        panel.contact(time_ps, a_moves ? pins.knob_a : pins.knob_b, knob, a_moves ? a : b, knob_bounce_ps);
        plan();
    }

    /** The running step was settled when it began; its drive now settles the next. */
    void end_step()
    {
        edges.clear();
        next_edge = 0;
        for (unsigned n = 0; n < BOARD_AXES; n++) {
            AxisOnBoard &on = axes[n];
            if (on.idle())
                continue; /* this step would be like the last */
            drive(step_end_ps, n, on.drive.level);
            const double mean = on.cut ? 0.0 : on.drive.sum_ps / double(step_ps);
            on.drive.sum_ps = 0.0;
            show_limits(n); /* where the step that ends has led */
            on.axis.step(mean);
            find_edges(n);
        }
        if (edges.size() > 1)
            std::stable_sort(edges.begin(), edges.end(),
                             [](const board_edge &a, const board_edge &b) { return a.time_ps < b.time_ps; });
        step_end_ps += step_ps;
        resting = std::all_of(axes.begin(), axes.end(), [](const AxisOnBoard &on) {
            return on.axis.at_rest() && on.drive.level == 0.0;
        });
    }

    /** The stage does not turn round within a step: its edges are those between the counts at either end. */
    void find_edges(unsigned n)
    {
        const AxisOnBoard &on = axes[n];
        const int64_t last = on.axis.end_count();
        const int8_t direction = last > on.count ? 1 : -1;
        for (int64_t count = on.count; count != last;) {
            const int64_t crossed = direction > 0 ? count + 1 : count;
            count += direction;
            const double offset_ps = on.axis.crossing(double(crossed)) * double(step_ps);
            edges.push_back({step_end_ps + int64_t(std::floor(offset_ps + 0.5)), count, uint8_t(n), direction});
        }
    }

    /** Counts 0, 1, 2, 3 are A B = 00, 10, 11, 01: A leads B in the positive direction. */
    void show_encoder(unsigned n)
    {
        const AxisOnBoard &on = axes[n];
        const unsigned phase = unsigned(on.count & 3);
        const bool level[3] = {phase == 1 || phase == 2, phase >= 2, on.axis.index(on.count)};
        uint8_t *const pin[3] = {&pins.enc_a, &pins.enc_b, &pins.enc_z};
        for (int wire = 0; wire < 3; wire++)
            set_bit(*pin[wire], n, on.stuck[wire] < 0 ? level[wire] : on.stuck[wire] != 0);
    }

    void show_limits(unsigned n)
    {
        set_bit(pins.limit_lower, n, axes[n].axis.at_lower_limit());
        set_bit(pins.limit_upper, n, axes[n].axis.at_upper_limit());
    }

    double fraction(int64_t time_ps) const
    {
        return std::clamp(double(time_ps - (step_end_ps - step_ps)) / double(step_ps), 0.0, 1.0);
    }
};

struct board *board_create(const char *parameters, char *error, size_t error_size)
{
    try {
        return new board(plant::parse(parameters));
    } catch (const std::exception &reason) {
        std::snprintf(error, error_size, "%s", reason.what());
        return nullptr;
    }
}

void board_destroy(struct board *board)
{
    delete board;
}

void board_drive(struct board *board, int64_t time_ps, unsigned axis, double drive)
{
    board->drive(time_ps, axis, drive);
}

void board_drive_pins(struct board *board, int64_t time_ps, unsigned pwm, unsigned dir, int motor_enable)
{
    for (unsigned n = 0; n < BOARD_AXES; n++) {
        const bool on = motor_enable && (pwm >> n & 1);
        board->drive(time_ps, n, !on ? 0.0 : dir >> n & 1 ? 1.0 : -1.0);
    }
}

int64_t board_next_ps(const struct board *board)
{
    return board->next_ps;
}

int board_next(struct board *board, struct board_edge *edge)
{
    return board->next(edge);
}

void board_advance(struct board *board, int64_t time_ps)
{
    while (board->next_ps <= time_ps)
        board->next(nullptr);
}

const struct board_pins *board_pins(const struct board *board)
{
    return &board->pins;
}

int64_t board_count(const struct board *board, unsigned axis)
{
    return board->axes[axis].count;
}

double board_position_counts(const struct board *board, unsigned axis, int64_t time_ps)
{
    return board->axes[axis].axis.position_counts(board->fraction(time_ps));
}

double board_speed_counts_per_s(const struct board *board, unsigned axis, int64_t time_ps)
{
    return board->axes[axis].axis.speed_counts_per_s(board->fraction(time_ps));
}

void board_set_input(struct board *board, enum board_input input, int level)
{
    uint8_t *const pin[] = {&board->pins.estop, &board->pins.in0, &board->pins.in1};
    *pin[input] = level != 0;
}

void board_set_contact(struct board *board, int64_t time_ps, enum board_contact contact, int level)
{
    const bool wire = contact == BOARD_JOYSTICK_WIRE;
    board->panel.contact(time_ps, wire ? board->pins.joystick_button : board->pins.button, wire ? 0 : contact,
                         level != 0, board->contact_bounce_ps);
    board->plan();
}

void board_set_dip(struct board *board, unsigned levels)
{
    board->pins.dip = uint8_t(levels & 0xf);
}

void board_turn_knob(struct board *board, int64_t time_ps, unsigned knob, int edges, int64_t interval_ps)
{
    for (; edges != 0; edges += edges > 0 ? -1 : 1, time_ps += interval_ps)
        board->turn(time_ps, knob, edges > 0 ? 1 : -1);
}

void board_set_analog(struct board *board, unsigned channel, double level)
{
    board->adc.set_input(channel, level);
}

void board_adc_pins(struct board *board, int64_t time_ps, int cs_n, int sck, int mosi)
{
    board->panel.put(time_ps + plant::Adc::DELAY_PS, board->pins.adc_miso, 0,
                     board->adc.pins(cs_n != 0, sck != 0, mosi != 0));
    board->plan();
}

uint16_t board_adc_frame(struct board *board, uint16_t word)
{
    return board->adc.frame(word);
}

void board_cut_pwm(struct board *board, unsigned axes)
{
    for (unsigned n = 0; n < BOARD_AXES; n++)
        board->axes[n].cut = axes >> n & 1;
}

void board_stick_wire(struct board *board, unsigned axis, enum board_wire wire, int level)
{
    board->axes[axis].stuck[wire] = int8_t(level < 0 ? -1 : level > 0);
    board->show_encoder(axis);
}
