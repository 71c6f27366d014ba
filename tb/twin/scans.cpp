/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Whole scans, far faster than in real time: the firmware over the model of the gateware and a stage that does what it is
 * told (follower.h), and every pulse at the pins.
 *
 *     scans PLANT EVERY LINE...
 *
 * LINEs are sent one by one, each when the one before is answered; a scan that they start is waited for. Standard output:
 * a line "line SYNC END PULSES FIRST LAST" for each time that SYNC was high, in edges of `fast`, and for one in EVERY of
 * them "pulses" and the edges at which ENCODER rose; then "error CODE" for each entry of the error log, "stray N", pulses
 * without SYNC, and "time SIMULATED_S PROCESSOR_S".
 */
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include "follower.h"
#include "processor.h"

extern "C" {
#include "core/fault.h"
#include "hal/interrupts.h"
#include "host/interrupts.h"
#include "modules/application.h"
#include "modules/axis_state.h"
#include "modules/scan_run.h"
}

namespace {

using twin::Time;

constexpr Time TURN = 4000; /* of the main loop, as in main.cpp */
constexpr uint32_t ENABLED = INTERRUPTS_TICK | INTERRUPTS_SERIAL | INTERRUPTS_TIMER | INTERRUPTS_BUS;
constexpr Time TICK = Time(FAST_CLOCK_HZ) / 1000000 * AXIS_TICK_US;
constexpr Time HANDLER = 8000; /* from a tick to its set-points' beginning: longer than the handler takes */

double processor_s()
{
    return double(clock()) / CLOCKS_PER_SEC;
}

class Scans {
public:
    Scans(struct board *board, unsigned every, char **lines, int count) : machine(board), stage_(counts(board).at), every_(every)
    {
        machine.follow(&stage_);
        machine.watch = [this](Time edge, uint64_t pins, uint64_t levels) { changed(edge, pins, levels); };
        for (int n = 0; n < count; n++)
            lines_.push_back(lines[n]);
    }

    twin::Machine machine;

    bool done() const { return done_; }

    void sleep()
    {
        while (!(machine.interrupts() & ENABLED) && !done_) {
            machine.advance(machine.now() + TURN, ENABLED);
            look();
        }
        host_interrupts_set(machine.interrupts());
    }

    void spend()
    {
        machine.advance(machine.now() + TURN);
        look();
        host_interrupts_set(machine.interrupts());
    }

    /** After the handler of a servo tick: the stage goes on to where its set-points are. */
    void follow()
    {
        if (axis_tick_count == tick_)
            return;
        tick_ = axis_tick_count;
        if (first_ == twin::NEVER)
            first_ = Time(axis_time_fast()) - TICK * (tick_ - 1);
        const Time begin = first_ + TICK * (tick_ - 1) + HANDLER;
        int64_t positions_q32[twin::AXES] = {};
        for (unsigned n = 0; n < AXIS_COUNT; n++)
            positions_q32[n] = axis_states[n].profile.position_q32;
        stage_.move(begin, begin + TICK, positions_q32);
        machine.follow(&stage_);
    }

private:
    struct Counts {
        int64_t at[twin::AXES];
    };
    static Counts counts(struct board *board)
    {
        Counts counts;
        for (unsigned n = 0; n < twin::AXES; n++)
            counts.at[n] = board_count(board, n);
        return counts;
    }

    /* The host's turn. */
    void look()
    {
        uint8_t byte;
        while (machine.receive(byte))
            replies_ += byte == '\n';
        if (replies_ != sent_ || scan_run_state() != SCAN_IDLE || machine.now() < Time(FAST_CLOCK_HZ) / 50)
            return;
        if (sent_ == lines_.size()) {
            report();
            done_ = true;
            return;
        }
        for (char byte_sent : lines_[sent_] + "\r")
            machine.send(uint8_t(byte_sent));
        sent_++;
    }

    void changed(Time edge, uint64_t pins, uint64_t levels)
    {
        const bool sync = levels >> twin::SYNC_OUT & 1, pulse = levels >> twin::ENCODER_OUT & 1;

        if (pins & twin::bit(twin::SYNC_OUT) && sync) {
            line_ = {edge, 0, {}};
        }
        if (pins & twin::bit(twin::ENCODER_OUT) && pulse) {
            if (sync || edge == line_.end)
                line_.pulses.push_back(edge);
            else
                stray_++;
        }
        if (pins & twin::bit(twin::SYNC_OUT) && !sync) {
            line_.end = edge;
            ended_ = true;
        }
        if (ended_ && edge > line_.end)
            print_line();
    }

    void print_line()
    {
        ended_ = false;
        const std::vector<Time> &pulses = line_.pulses;
        std::printf("line %" PRId64 " %" PRId64 " %zu %" PRId64 " %" PRId64 "\n", line_.begin, line_.end, pulses.size(),
                    pulses.empty() ? 0 : pulses.front(), pulses.empty() ? 0 : pulses.back());
        if (number_++ % every_ != 0)
            return;
        std::printf("pulses");
        for (Time at : pulses)
            std::printf(" %" PRId64, at);
        std::printf("\n");
    }

    void report()
    {
        if (ended_)
            print_line();
        for (unsigned n = 0; fault_read(n) != FAULT_NONE; n++)
            std::printf("error %u\n", unsigned(fault_read(n)));
        std::printf("stray %u\ntime %.6f %.6f\n", stray_, double(machine.now()) / double(FAST_CLOCK_HZ), processor_s());
    }

    twin::Follower stage_;
    const unsigned every_;
    std::vector<std::string> lines_;
    size_t sent_ = 0, replies_ = 0;
    bool done_ = false;
    uint32_t tick_ = 0;
    Time first_ = twin::NEVER; /* the first tick */

    struct {
        Time begin = 0, end = 0;
        std::vector<Time> pulses;
    } line_;
    bool ended_ = false;
    unsigned number_ = 0, stray_ = 0;
};

std::unique_ptr<Scans> the;

void interrupt()
{
    application_interrupt();
    the->follow();
    the->machine.advance(the->machine.now());
    host_interrupts_set(the->machine.interrupts());
}

bool busy()
{
    return the->done() || application_busy();
}

} // namespace

int main(int argument_count, char **arguments)
{
    if (argument_count < 4) {
        std::fprintf(stderr, "usage: scans PLANT EVERY LINE...\n");
        return 2;
    }
    char error[200];
    struct board *board = board_create(arguments[1], error, sizeof error);
    if (!board) {
        std::fprintf(stderr, "could not run: %s\n", error);
        return 2;
    }
    the = std::make_unique<Scans>(board, unsigned(std::atoi(arguments[2])), arguments + 3, argument_count - 3);
    twin::processor_on(the->machine);
    /* Whatever its duties are, this stage makes its way. */
    the->machine.write(REG_INTERLOCK_WAY, 0);
    host_interrupts_on_sleep([] { the->sleep(); });
    host_interrupts_dispatch(interrupt);
    if (!application_init())
        return 1;
    while (!the->done()) {
        application_poll();
        the->spend();
        do
            interrupts_sleep_unless(busy);
        while (!busy());
    }
    return 0;
}
