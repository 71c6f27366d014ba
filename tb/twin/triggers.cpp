/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Pulses at IN0 by the thousand, at any phase, while all axes move and a host floods the main port: what the report port
 * sends, and where the board says that the axes were.
 *
 *     triggers PLANT SEED PULSES GAP_US LINE...
 *
 * LINEs are sent first, one by one. Pulses begin 0.1 us to twice GAP_US after the one before. Standard output: "power
 * COUNT COUNT COUNT COUNT", where the board is at power-up, in edges of each encoder; a line "pulse EDGE COUNT COUNT
 * COUNT COUNT" for each pulse, EDGE being the first of `fast` to sample it and COUNTs where the board is then; "byte TIME_PS VALUE" for each byte, with the time of its start bit; and
 * "replies N", the lines that the host got.
 */
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <random>
#include <string>

#include "processor.h"

extern "C" {
#include "hal/interrupts.h"
#include "host/interrupts.h"
#include "modules/application.h"
}

namespace {

using twin::Time;

constexpr Time TURN = 4000;           /* of the main loop, as in main.cpp */
constexpr Time SHORTEST = 20;         /* pulse and pause that are ones for sure */
constexpr Time LIMIT = Time(FAST_CLOCK_HZ) * 4; /* for what is waited for, on the controller's clock */
constexpr uint32_t ENABLED = INTERRUPTS_TICK | INTERRUPTS_SERIAL | INTERRUPTS_TIMER | INTERRUPTS_BUS |
                             INTERRUPTS_REPORT | INTERRUPTS_TRIGGER;

class Bench {
public:
    Bench(struct board *board, unsigned seed, Time gap) : machine(board), board_(board), random_(seed), gap_(gap) {}

    twin::Machine machine;

    /** Whether the processor may sleep on. */
    bool busy() const { return done_; }

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

    bool done() const { return done_; }

    void say_where(const std::string &what) const
    {
        std::printf("%s", what.c_str());
        for (unsigned n = 0; n < twin::AXES; n++)
            std::printf(" %" PRId64, board_count(board_, n));
        std::printf("\n");
    }

    void begin(char **lines, int count, unsigned pulses)
    {
        for (int n = 0; n < count; n++)
            lines_.push_back(lines[n]);
        pulses_ = pulses;
    }

private:
    Time from(Time first, Time last) { return std::uniform_int_distribution<Time>(first, last)(random_); }

    void say(const std::string &line)
    {
        for (char byte : line + "\r")
            machine.send(uint8_t(byte));
        sent_++;
    }

    /** The host's, and the script's, turn. */
    void look()
    {
        uint8_t byte;
        while (machine.receive(byte))
            replies_ += byte == '\n';
        if (machine.now() < next_look_)
            return;
        if (!lines_.empty() && replies_ == sent_) {
            say(lines_.front());
            lines_.pop_front();
        } else if (lines_.empty() && replies_ == sent_ && state_ == SETTINGS) {
            state_ = MOVING;
            next_look_ = machine.now() + Time(FAST_CLOCK_HZ) / 5; /* until all axes move */
            move();
        } else if (state_ == MOVING && lines_.empty()) {
            state_ = PULSES;
            plan_pulse(machine.now() + 1000);
        } else if (state_ == PULSES) {
            flood();
        } else if (state_ == ENDING && machine.now() > end_) {
            report();
        }
    }

    void move()
    {
        std::string line = "M";
        for (const char *axis : {"X", "Y", "Z", "F"})
            line += std::string(" ") + axis + "=" + std::to_string(from(-40000, 40000));
        say(line);
    }

    /** The main port is never idle: some lines are always on their way, and not so many that one is refused. */
    void flood()
    {
        static const char *const lines[] = {"W X Y Z F", "/", "RS X Y Z F", "S X? Y?", "UM X? Y? Z? F?", "WHO", "TTL X?"};
        while (sent_ - replies_ < 10) {
            if (machine.now() < next_move_) {
                say(lines[from(0, 6)]);
            } else {
                move();
                next_move_ = machine.now() + Time(FAST_CLOCK_HZ) / 5;
            }
        }
    }

    void plan_pulse(Time after)
    {
        const Time begins = after + from(SHORTEST, 2 * gap_);
        machine.at(begins, [this, begins] {
            board_set_input(board_, BOARD_IN0, 1);
            say_where("pulse " + std::to_string(begins));
            const Time ends = begins + from(SHORTEST, 4 * SHORTEST);
            machine.at(ends, [this, ends] {
                board_set_input(board_, BOARD_IN0, 0);
                if (--pulses_ > 0) {
                    plan_pulse(ends);
                    return;
                }
                state_ = ENDING;
                end_ = ends + LIMIT;
            });
        });
    }

    void report()
    {
        for (const SerialLine::Byte &byte : machine.reported())
            std::printf("byte %" PRId64 " %u\n", byte.start_ps, byte.value);
        std::printf("replies %u\n", replies_);
        done_ = true;
    }

    struct board *const board_;
    std::mt19937_64 random_;
    const Time gap_;
    std::deque<std::string> lines_;
    enum { SETTINGS, MOVING, PULSES, ENDING } state_ = SETTINGS;
    unsigned pulses_ = 0, sent_ = 0, replies_ = 0;
    Time next_look_ = Time(FAST_CLOCK_HZ) / 50, next_move_ = 0, end_ = 0;
    bool done_ = false;
};

std::unique_ptr<Bench> the;

void interrupt()
{
    application_interrupt();
    the->machine.advance(the->machine.now());
    host_interrupts_set(the->machine.interrupts());
}

bool busy()
{
    return the->busy() || application_busy();
}

} // namespace

int main(int argument_count, char **arguments)
{
    if (argument_count < 5) {
        std::fprintf(stderr, "usage: triggers PLANT SEED PULSES GAP_US LINE...\n");
        return 2;
    }
    char error[200];
    struct board *board = board_create(arguments[1], error, sizeof error);
    if (!board) {
        std::fprintf(stderr, "%s\n", error);
        return 2;
    }
    the = std::make_unique<Bench>(board, unsigned(std::atoi(arguments[2])),
                                  Time(std::atof(arguments[4]) * FAST_CLOCK_HZ / 1e6));
    the->say_where("power");
    the->begin(arguments + 5, argument_count - 5, unsigned(std::atoi(arguments[3])));
    twin::processor_on(the->machine);
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
