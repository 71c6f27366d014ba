// SPDX-License-Identifier: BSD-2-Clause
// The SoC alone under Verilator: clocks it, loops the serial line back, and prints every change of an output.
//
//   bench [--stop | --hold AT | --estop AT] CLOCKS [+boot=FILE] [+firmware=FILE]
//
// Lines on standard output: "<sync clock> <pin> <level>".  With --stop the processor's clock is left out while
// cpu_asleep is high; the number of clocks left out goes to standard error.  From clock AT on --hold holds the
// processor in reset, and --estop presses the emergency stop.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "Vabbe.h"
#include "verilated.h"

int main(int argc, char **argv)
{
    VerilatedContext context;
    context.commandArgs(argc, argv);
    const auto option = [&](const char *name) { return argc > 1 && !std::strcmp(argv[1], name); };
    const bool stop = option("--stop"), hold = option("--hold"), estop = option("--estop");
    const int used = 1 + (stop ? 1 : hold || estop ? 2 : 0);
    const long at = used == 3 && argc > 2 ? std::atol(argv[2]) : -1;
    const long clocks = argc > used ? std::atol(argv[used]) : 0;
    if (clocks <= 0) {
        std::fprintf(stderr, "usage: bench [--stop | --hold AT | --estop AT] CLOCKS [+boot=FILE] [+firmware=FILE]\n");
        return 2;
    }

    auto top = std::make_unique<Vabbe>(&context);
    top->serial_rx = 1;
    top->rst = top->fast_rst = top->cpu_rst = 1;
    struct { const char *name; CData *pin; int last; } outputs[] = {
        {"serial_tx", &top->serial_tx, -1}, {"pwm", &top->pwm, -1}, {"dir", &top->dir, -1},
        {"motor_enable", &top->motor_enable, -1}, {"out0", &top->out0, -1},
        {"sync_out", &top->sync_out, -1}, {"encoder_out", &top->encoder_out, -1},
    };
    long left_out = 0;
    for (long clock = 0; clock < clocks; clock++) {
        bool run = !(stop && top->cpu_asleep);
        left_out += !run;
        for (int eighth = 0; eighth < 8; eighth++) {
            top->clk = eighth < 4;
            top->cpu_clk = eighth < 4 && run;
            top->fast_clk = !(eighth & 1);
            top->eval();
        }
        if (clock == 3)
            top->rst = top->fast_rst = top->cpu_rst = 0;
        if (clock == at)
            (hold ? top->cpu_rst : top->estop) = 1;
        top->serial_rx = top->serial_tx;
        for (auto &output : outputs)
            if (*output.pin != output.last)
                std::printf("%ld %s %d\n", clock, output.name, output.last = *output.pin);
    }
    top->final();
    std::fprintf(stderr, "left out %ld of %ld clocks\n", left_out, clocks);
    return 0;
}
