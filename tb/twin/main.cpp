/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The virtual controller: boot program and application, from their own sources, over the model of the gateware and the
 * board, at real time. After a reset of the processor the boot program starts anew; gateware and board go on.
 *
 *     twin PLANT SPEED TCP_PORT [SETTINGS [FLASH]]
 *
 * PLANT: the board's parameters as text; SPEED: times real time; TCP_PORT: 0 for any that is free; SETTINGS: the file
 * in which SAVESET keeps them, or ""; FLASH: the file with the contents of the flash, where they are kept then, or ""
 * for a board without one. python -m tb.twin calls it so.
 *
 * It runs in slices: sleeps until a slice of real time has passed or a host has sent something, then lets the
 * controller catch up. When the machine cannot keep up, the controller's time falls behind, and is not made up for.
 */
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <memory>

#include <sys/mman.h>
#include <unistd.h>

#include "ports.h"
#include "processor.h"
#include "program.h"

extern "C" {
#include "boot/boot.h"
#include "boot/image.h"
#include "core/settings.h"
#include "hal/bus.h"
#include "hal/interrupts.h"
#include "host/interrupts.h"
#include "host/settings_file.h"
#include "modules/application.h"
}

namespace {

using twin::Time;

constexpr int64_t SLICE_NS = 1000000, BUSY_SLICE_NS = 250000; /* the shorter while bytes are on the line */
constexpr int64_t BEHIND_NS = 50000000;                        /* more than this behind is given up */
constexpr size_t QUEUE_BYTES = 256;                            /* read ahead of the serial line */

/* A turn of the main loop, in `fast` clocks: 20 us, what the soft core takes for a short command. */
constexpr Time TURN = 4000;

int64_t real_ns()
{
    timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return int64_t(now.tv_sec) * 1000000000 + now.tv_nsec;
}

/** The controller and the hosts, and how their times go together. */
class Twin {
public:
    Twin(struct board *board, struct nor *flash, double speed, uint16_t tcp_port)
        : machine(board, flash), ports_(tcp_port), report_ports_(0), fast_per_ns_(speed * FAST_CLOCK_HZ * 1e-9), origin_ns_(real_ns())
    {
        std::printf("serial port: %s\ntcp port: %u\n", ports_.path().c_str(), ports_.tcp_port());
        std::printf("report port: %s\nreport tcp port: %u\n", report_ports_.path().c_str(), report_ports_.tcp_port());
        std::fflush(stdout);
    }

    twin::Machine machine;

    /** The processor sleeps until an interrupt. */
    void sleep()
    {
        while (!(machine.interrupts() & ENABLED)) {
            machine.advance(allowed_, ENABLED);
            if (machine.now() >= allowed_)
                keep_pace();
        }
        host_interrupts_set(machine.interrupts());
    }

    /** The processor was busy for a while. */
    void spend(Time clocks)
    {
        machine.advance(machine.now() + clocks);
        pace();
        host_interrupts_set(machine.interrupts());
    }

    /** Its time is not to run ahead. */
    void pace()
    {
        while (machine.now() >= allowed_)
            keep_pace();
    }

private:
    static constexpr uint32_t ENABLED = INTERRUPTS_TICK | INTERRUPTS_SERIAL | INTERRUPTS_TIMER | INTERRUPTS_BUS |
                                        INTERRUPTS_REPORT | INTERRUPTS_TRIGGER;

    /** Serve the hosts, and wait until real time has come as far as the controller's. */
    void keep_pace()
    {
        exchange();
        int64_t ns = real_ns();
        const bool busy = machine.unsent() != 0 || active_ > machine.now();
        const int64_t due_ns = origin_ns_ + int64_t(double(machine.now()) / fast_per_ns_) +
                               (busy ? BUSY_SLICE_NS : SLICE_NS);
        if (ns < due_ns) {
            ports_.wait(due_ns - ns);
            exchange();
            ns = real_ns();
        } else if (ns > due_ns + BEHIND_NS) {
            origin_ns_ += ns - due_ns;
        }
        allowed_ = std::max(machine.now() + 1, Time(double(ns - origin_ns_) * fast_per_ns_));
        allowed_ = std::min(allowed_, machine.now() + Time(double(SLICE_NS) * fast_per_ns_));
    }

    void exchange()
    {
        uint8_t bytes[QUEUE_BYTES];
        if (machine.unsent() < QUEUE_BYTES) {
            const size_t count = ports_.read(bytes, QUEUE_BYTES - machine.unsent());
            for (size_t n = 0; n < count; n++)
                machine.send(bytes[n]);
            if (count)
                active_ = machine.now() + FAST_CLOCK_HZ / 50;
        }
        while (machine.receive(bytes[0]))
            ports_.write(bytes[0]);
        ports_.flush();
        for (; !machine.reported().empty(); machine.reported().pop_front())
            report_ports_.write(machine.reported().front().value);
        report_ports_.wait(0);
        (void)report_ports_.read(bytes, sizeof bytes); /* nobody listens */
        report_ports_.flush();
    }

    twin::Ports ports_, report_ports_;
    const double fast_per_ns_;
    int64_t origin_ns_;  /* real time at which the controller's began */
    Time allowed_ = 0;   /* how far it may run */
    Time active_ = 0;    /* a host waits for an answer until then, as likely as not */
};

std::unique_ptr<Twin> the;

void fault(const char *what, uint32_t address)
{
    std::fprintf(stderr, "bus error: %s 0x%08x\n", what, address);
    std::exit(1);
}

/** The application's program, as long as it is loaded. */
struct {
    decltype(application_init) *init;
    decltype(application_poll) *poll;
    decltype(application_busy) *busy;
    decltype(application_interrupt) *interrupt;
    decltype(bus_take_fault) *take_fault;
} application;

/** As main_interrupt of main.c. */
void interrupt()
{
    if (interrupts_pending() & INTERRUPTS_BUS)
        fault("write to", application.take_fault());
    application.interrupt();
    the->machine.advance(the->machine.now());
    host_interrupts_set(the->machine.interrupts());
}

/** As main of main.c. Returns if it cannot be started, or was reset. */
void run_application()
{
    if (!application.init())
        return;
    while (!the->machine.has_reset()) {
        application.poll();
        the->spend(TURN);
        do
            interrupts_sleep_unless(application.busy);
        while (!application.busy());
    }
}

twin::Ended load_and_run_application(const char *settings)
{
    const twin::Program program("application.so");
    application = {program.function<decltype(application_init)>("application_init"),
                   program.function<decltype(application_poll)>("application_poll"),
                   program.function<decltype(application_busy)>("application_busy"),
                   program.function<decltype(application_interrupt)>("application_interrupt"),
                   program.function<decltype(bus_take_fault)>("bus_take_fault")};
    if (*settings)
        program.function<decltype(settings_init)>("settings_init")(
            program.function<decltype(settings_file)>("settings_file")(settings));
    host_interrupts_dispatch(interrupt);
    const twin::Ended ended = twin::processor_run(run_application);
    host_interrupts_dispatch(nullptr);
    interrupts_enable(0);
    return ended;
}

twin::Ended load_and_run_boot()
{
    const twin::Program program("boot.so");
    return twin::processor_run(program.function<decltype(boot_main)>("boot_main"), [] { the->pace(); });
}

/** Memory where images are loaded; the application came with the gateware. */
bool fill_memory()
{
    void *const memory = mmap(reinterpret_cast<void *>(uintptr_t(IMAGE_RAM)), IMAGE_RAM_BYTES, PROT_READ | PROT_WRITE,
                              MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED_NOREPLACE, -1, 0);
    const uint32_t start[] = {0, IMAGE_MARK, IMAGE_PRODUCT, REG_MAP_VERSION};
    if (memory != reinterpret_cast<void *>(uintptr_t(IMAGE_RAM)))
        return false;
    std::memcpy(static_cast<uint8_t *>(memory) + IMAGE_HEADER_BYTES, start, sizeof start);
    return true;
}

int run(const char *settings, bool has_flash)
{
    twin::processor_on(the->machine);
    host_interrupts_on_sleep([] { the->sleep(); });
    for (;;) {
        twin::Ended ended = load_and_run_boot();
        if (ended == twin::Ended::RUNS_ANOTHER)
            ended = load_and_run_application(settings);
        if (!the->machine.has_reset())
            return 1;
        if (!has_flash) {
            /* On a board as well: its memory is not trusted, and there is nothing else to start. */
            std::fprintf(stderr, "the processor was reset\n");
            return 3;
        }
        the->machine.start_processor();
    }
}

} // namespace

int main(int argument_count, char **arguments)
{
    if (argument_count < 4) {
        std::fprintf(stderr, "usage: twin PLANT SPEED TCP_PORT [SETTINGS [FLASH]]\n");
        return 2;
    }
    char error[200];
    struct board *board = board_create(arguments[1], error, sizeof error);
    if (!board) {
        std::fprintf(stderr, "the virtual controller could not run: %s\n", error);
        return 2;
    }
    for (int signal : {SIGTERM, SIGINT})
        std::signal(signal, [](int) { _exit(0); }); /* nothing is lost: files are whole at any time, or as after a power cut */
    const char *const settings = argument_count > 4 ? arguments[4] : "", *const flash = argument_count > 5 ? arguments[5] : "";
    static struct nor nor;
    if (*flash) {
        uint8_t *const contents = nor_map(flash);
        if (!contents) {
            std::fprintf(stderr, "the virtual controller could not run: %s: %s\n", flash,
                         errno == EINVAL ? "not a flash's contents" : std::strerror(errno));
            return 2;
        }
        nor_init(&nor, contents);
    }
    if (!fill_memory()) {
        std::fprintf(stderr, "the virtual controller could not run: no memory at 0x%x\n", unsigned(IMAGE_RAM));
        return 2;
    }
    try {
        the = std::make_unique<Twin>(board, *flash ? &nor : nullptr, std::atof(arguments[2]), uint16_t(std::atoi(arguments[3])));
        return run(settings, *flash);
    } catch (const std::exception &reason) {
        std::fprintf(stderr, "the virtual controller could not run: %s\n", reason.what());
        return 2;
    }
}
