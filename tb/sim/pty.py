# SPDX-License-Identifier: BSD-2-Clause
"""``make sim``: the simulated controller with its serial port on a pseudo-terminal, for host software.

The first two lines on standard output are ``serial port: PATH`` and ``report port: PATH``; open them with any terminal
program or serial library (the baud rate does not matter).  Every few seconds a line on standard error compares simulated with real time.
Ctrl-C ends it.
"""

import argparse
import contextlib
import os
import select
import signal
import sys
import time
import tty

from tb.board import plant
from tb.sim import controller
from tb.sim.simulator import S, SCAN_SIGNALS, US
from tb.sim.vcd import VcdWriter

SLICE_PS = 500 * US       # time between looks at the pty: half a dozen bytes
QUEUE_BYTES = 32          # read ahead of the serial line, so that bytes follow each other without gaps
UNREAD_BYTES = 1 << 16    # output kept for a reader that is slow, or not there; the oldest goes first


class Port:
    """A pseudo-terminal that stays open, whoever opens and closes its other end."""

    def __init__(self):
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        self._unread = bytearray()
        self.path = os.ttyname(self._slave)

    def read(self, size):
        """Bytes from the host, at most ``size``, without waiting."""
        readable, _, _ = select.select([self._master], [], [], 0)
        return os.read(self._master, size) if readable else b""

    def write(self, data):
        """Bytes to the host, without waiting; kept until there is room."""
        self._unread += data
        del self._unread[:-UNREAD_BYTES]
        if self._unread:
            with contextlib.suppress(BlockingIOError):
                del self._unread[:os.write(self._master, self._unread)]

    def close(self):
        os.close(self._master)
        os.close(self._slave)


class Stopwatch:
    """Says on standard error, every ``period_s``, how simulated time compares with real time."""

    def __init__(self, sim, period_s):
        self._sim, self._period_s = sim, period_s
        self._at_s, self._at_ps = time.monotonic(), sim.time_ps

    def look(self):
        now_s, now_ps = time.monotonic(), self._sim.time_ps
        if now_s - self._at_s < self._period_s:
            return
        ratio = (now_ps - self._at_ps) / S / (now_s - self._at_s)
        print(f"simulated {now_ps / S:.3f} s, at 1/{1 / ratio:.1f} of real time", file=sys.stderr, flush=True)
        self._at_s, self._at_ps = now_s, now_ps


def serve(sim, port, running, *after_slice):
    """Carry bytes between the pty and the controller until ``running()`` is false.

    Each of ``after_slice`` is called about every half millisecond of simulated time.
    """
    while running():
        if sim.serial_unsent < QUEUE_BYTES:
            sim.serial_write(port.read(QUEUE_BYTES))
        sim.run(SLICE_PS)
        port.write(sim.serial_read())
        for call in after_slice:
            call()


@contextlib.contextmanager
def recording(sim, path):
    """Record the pins of a scan into a VCD file; yields what to call every so often."""
    with open(path, "w") as file:
        writer = VcdWriter(file, time_ps=sim.time_ps, levels=sim.levels())
        sim.record(*SCAN_SIGNALS)
        yield lambda: writer.write(sim.changes())
        writer.write(sim.changes())
        writer.finish(sim.time_ps)


class Parser(argparse.ArgumentParser):
    """Says what is wrong with an option in one sentence."""

    def error(self, message):
        self.exit(2, f"error: {message} (--help lists the options)\n")


def positive(text):
    """A number above 0."""
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"expected a number above 0, not {text}")
    return value


def override(text):
    """A change of a plant parameter that the plant takes."""
    try:
        plant.load([text])
    except ValueError as error:
        said = str(error)
        raise argparse.ArgumentTypeError(said if text in said else f"{text!r}: {said}") from None
    return text


def parse(arguments=None):
    parser = Parser(prog="make sim", description=__doc__.split("\n\n")[0])
    parser.add_argument("more_plant", nargs="*", type=override, metavar="[axis.]name=value", help="as --plant")
    parser.add_argument("--plant", action="append", default=[], type=override, metavar="[AXIS.]NAME=VALUE",
                        help="change a parameter of the simulated stage, such as x.running_friction=0.2 "
                             "(tb/board/plant.toml); may be repeated")
    parser.add_argument("--baud", type=positive, default=115200, help="of the simulated line (default: %(default)d)")
    parser.add_argument("--vcd", metavar="FILE", help="record the pins of a scan, for 'make jitter FILE=...'")
    parser.add_argument("--report", type=positive, default=5, metavar="SECONDS",
                        help="time between reports of the speed (default: %(default)d)")
    options = parser.parse_args(arguments)
    options.plant += options.more_plant
    return options


def run(options, build=controller.build):
    """Power up what ``build(say)`` returns and serve it until Ctrl-C.

    Raises :exc:`ValueError` for a plant it does not take, :exc:`OSError` for a file that cannot be written.
    """
    if options.vcd:
        open(options.vcd, "w").close()                       # before minutes of building, if it cannot be written
    design = build(lambda sentence: print(sentence, file=sys.stderr, flush=True))
    stop = []
    with contextlib.ExitStack() as resources:
        sim = resources.enter_context(design.power_up(plant_overrides=options.plant, baud=options.baud))
        port = resources.enter_context(contextlib.closing(Port()))
        report = resources.enter_context(contextlib.closing(Port()))
        after_slice = [Stopwatch(sim, options.report).look, lambda: report.write(sim.report_read())]
        if options.vcd:
            after_slice.append(resources.enter_context(recording(sim, options.vcd)))
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda *_: stop.append(True))
        print(f"serial port: {port.path}\nreport port: {report.path}", flush=True)
        serve(sim, port, lambda: not stop, *after_slice)


def main(arguments=None, build=controller.build):
    """Exit status: 0 after Ctrl-C, 2 when it could not run, 130 when stopped before the port was there."""
    options = parse(arguments)
    try:
        run(options, build)
    except KeyboardInterrupt:
        print("\nstopped before the port was open", file=sys.stderr)
        return 130
    except OSError as error:
        print(f"the simulation could not run: {error.filename or ''}: {error.strerror}", file=sys.stderr)
        return 2
    except (RuntimeError, ValueError) as error:
        print(f"the simulation could not run: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
