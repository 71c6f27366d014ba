# SPDX-License-Identifier: BSD-2-Clause
"""``make sim``: the simulated controller with its serial port on a pseudo-terminal, for host software.

The first line on standard output is ``serial port: PATH``; open PATH with any terminal program or serial library
(the baud rate does not matter).  Every few seconds a line on standard error compares simulated with real time.
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


def parse(arguments=None):
    parser = argparse.ArgumentParser(prog="make sim", description=__doc__.split("\n\n")[0])
    parser.add_argument("plant", nargs="*", metavar="[axis.]name=value",
                        help="change the simulated stage, such as speed_scale=0.5 (names: tb/board/plant.toml)")
    parser.add_argument("--baud", type=float, default=115200, help="of the simulated line (default: %(default)d)")
    parser.add_argument("--vcd", metavar="FILE", help="record the pins of a scan, for 'make jitter FILE=...'")
    parser.add_argument("--report", type=float, default=5, metavar="SECONDS",
                        help="time between reports of the speed (default: %(default)d)")
    return parser.parse_args(arguments)


def main():
    arguments = parse()
    design = controller.build()
    stop = []
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stop.append(True))
    with contextlib.ExitStack() as resources:
        sim = resources.enter_context(design.power_up(plant_overrides=arguments.plant, baud=arguments.baud))
        port = resources.enter_context(contextlib.closing(Port()))
        after_slice = [Stopwatch(sim, arguments.report).look]
        if arguments.vcd:
            after_slice.append(resources.enter_context(recording(sim, arguments.vcd)))
        print(f"serial port: {port.path}", flush=True)
        serve(sim, port, lambda: not stop, *after_slice)


if __name__ == "__main__":
    main()
