/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Pulses at IN0, short and long, at 100 kHz, while a host floods the main port: what the firmware makes of them.
 *
 *     steps PLANT SEED PULSES THRESHOLD LINE... -- QUERY...
 *
 * LINEs are sent first, one by one, then the pulses: one begins every 2000 clocks of `fast`, up to 600 late, and is
 * short (40 to THRESHOLD - 1 clocks) or long (THRESHOLD to 1300); every other one as near to the threshold as there is.
 * Standard output: "pulses" and a letter, s or l, for each; then the replies to the QUERYs, sent when all is over.
 */
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
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

constexpr Time TURN = 4000; /* of the main loop, as in main.cpp */
constexpr Time PERIOD = 2000, JITTER = 600, SHORTEST = 40, LONGEST = 1300;
constexpr Time SETTLE = Time(FAST_CLOCK_HZ) / 5;

class Bench {
public:
    Bench(struct board *board, unsigned seed, unsigned pulses, Time threshold)
        : machine(board), board_(board), random_(seed), left_(pulses), threshold_(threshold)
    {
    }

    twin::Machine machine;
    std::deque<std::string> lines, queries;

    bool done() const { return done_; }

    void sleep()
    {
        while (!machine.interrupts() && !done_) {
            machine.advance(machine.now() + TURN, ~0u);
            look();
        }
        host_interrupts_set(machine.interrupts());
    }

    void spend()
    {
        machine.advance(machine.now() + TURN);
        look();
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
        while (machine.receive(byte)) {
            heard_ += char(byte);
            if (byte != '\n')
                continue;
            replies_++;
            if (state_ == ASKING)
                std::printf("%s", heard_.c_str());
            heard_.clear();
        }
        if (machine.now() < next_)
            return;
        const bool quiet = replies_ == sent_;
        if (state_ == SETTINGS && quiet && !lines.empty()) {
            say(lines.front());
            lines.pop_front();
        } else if (state_ == SETTINGS && quiet) {
            state_ = PULSES;
            plan_pulse(machine.now() + PERIOD);
        } else if (state_ == PULSES) {
            while (left_ > 0 && sent_ - replies_ < 10)
                say("W X Y Z F");
        } else if (state_ == ENDING && quiet) {
            std::printf("pulses %s\n", sequence_.c_str());
            state_ = ASKING;
            next_ = machine.now() + SETTLE;
        } else if (state_ == ASKING && quiet && !queries.empty()) {
            say(queries.front());
            queries.pop_front();
        } else if (state_ == ASKING && quiet) {
            done_ = true;
        }
    }

    /** Runs of a kind, so that the target goes up and down. */
    Time length()
    {
        const bool longer = from(0, 7) < (left_ / 500 % 2 ? 2 : 6), near = from(0, 1);
        sequence_ += longer ? 'l' : 's';
        if (longer)
            return near ? threshold_ : from(threshold_, LONGEST);
        return near ? threshold_ - 1 : from(SHORTEST, threshold_ - 1);
    }

    void plan_pulse(Time period)
    {
        const Time begins = period + from(0, JITTER);
        machine.at(begins, [this, begins, period] {
            board_set_input(board_, BOARD_IN0, 1);
            machine.at(begins + length(), [this, period] {
                board_set_input(board_, BOARD_IN0, 0);
                if (--left_ > 0)
                    plan_pulse(period + PERIOD);
                else
                    state_ = ENDING;
            });
        });
    }

    struct board *const board_;
    std::mt19937_64 random_;
    unsigned left_, sent_ = 0, replies_ = 0;
    const Time threshold_;
    enum { SETTINGS, PULSES, ENDING, ASKING } state_ = SETTINGS;
    std::string sequence_, heard_;
    Time next_ = Time(FAST_CLOCK_HZ) / 50;
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
    return the->done() || application_busy();
}

} // namespace

int main(int argument_count, char **arguments)
{
    char error[200];
    struct board *board = argument_count > 5 ? board_create(arguments[1], error, sizeof error) : nullptr;
    if (!board) {
        std::fprintf(stderr, "usage: steps PLANT SEED PULSES THRESHOLD LINE... -- QUERY...\n");
        return 2;
    }
    the = std::make_unique<Bench>(board, unsigned(std::atoi(arguments[2])), unsigned(std::atoi(arguments[3])),
                                  Time(std::atoi(arguments[4])));
    bool query = false;
    for (int n = 5; n < argument_count; n++) {
        if (std::strcmp(arguments[n], "--") == 0)
            query = true;
        else
            (query ? the->queries : the->lines).push_back(arguments[n]);
    }
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
