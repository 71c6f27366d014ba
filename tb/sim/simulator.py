# SPDX-License-Identifier: BSD-2-Clause
"""The simulated controller on its simulated board, for the demo, the pty and the system tests.

Times are integer picoseconds since power-up::

    with Simulator(boot=..., firmware=...) as sim:
        sim.run(20 * MS)
        print(sim.command("W X"))
        sim.record("x_a", "x_b", "sync", "encoder")
        sim.serial_write(b"SCAN\\r")
        sim.run_until_pin("sync", 1, timeout_ps=2 * S)
        changes = sim.changes()
"""

import ctypes
from pathlib import Path

import numpy

from tb import toolchain
from tb.board import board, plant
from tb.sim import build

US, MS, S = 10**6, 10**9, 10**12  # picoseconds

FAST_PERIOD_PS = 5000
SYNC_PERIOD_PS = 20000
FLASH_BYTES = 16 << 20

#: Pins by name, in the order of ``enum sim_signal``.
SIGNALS = tuple(f"{axis}_{pin}" for pin in ("a", "b", "z", "pwm", "dir") for axis in plant.AXES) + (
    "motor_enable", "estop", "in0", "in1", "serial_rx", "serial_tx", "out0", "sync", "encoder", "report_tx")

#: The pins of ``pins.vcd``.
SCAN_SIGNALS = ("x_a", "x_b", "y_a", "y_b", "sync", "encoder", "in0", "out0")

CHANGE = numpy.dtype([("time_ps", "i8"), ("signal", "u4"), ("level", "u4")])
SAMPLE = numpy.dtype([("time_ps", "i8"), ("position_counts", "f8", 4), ("speed_counts_per_s", "f8", 4)])

TIME, PIN, LINES, FINISHED = range(4)  # why a run ended


#: The generated controller (``python -m soc.verilog``).
CONTROLLER = toolchain.BUILD / "soc" / "abbe.v"


def declare(library):
    """Give the functions of simulator.h their types; returns the library."""
    c, sim, count = ctypes, ctypes.c_void_p, ctypes.c_size_t
    for name, result, *arguments in (
        ("create", sim, c.c_char_p, c.c_double, c.c_int, c.POINTER(c.c_char_p), c.c_char_p, count),
        ("destroy", None, sim),
        ("board", c.c_void_p, sim),
        ("time_ps", c.c_int64, sim),
        ("run", c.c_int, sim, c.c_int64, c.c_uint32, c.c_uint32, count),
        ("schedule_input", None, sim, c.c_int64, c.c_int, c.c_int),
        ("fit_flash", None, sim, c.c_char_p, count),
        ("flash", c.POINTER(c.c_uint8), sim),
        ("set_flash_times", None, sim, c.c_int64, c.c_int64),
        ("serial_write", None, sim, c.c_char_p, count),
        ("serial_read", count, sim, c.c_void_p, c.c_void_p, count),
        ("serial_set_baud", None, sim, c.c_double),
        ("serial_unsent", count, sim),
        ("serial_lines", count, sim),
        ("serial_framing_errors", count, sim),
        ("report_read", count, sim, c.c_void_p, c.c_void_p, count),
        ("report_set_baud", None, sim, c.c_double),
        ("report_framing_errors", count, sim),
        ("set_recording", None, sim, c.c_uint32),
        ("levels", c.c_uint32, sim),
        ("take_changes", count, sim, c.c_void_p, count),
        ("set_sampling", None, sim, c.c_int64),
        ("take_samples", count, sim, c.c_void_p, count),
        ("clocks", None, sim, c.POINTER(c.c_uint64), c.POINTER(c.c_uint64)),
    ):
        function = getattr(library, f"sim_{name}")
        function.restype, function.argtypes = result, arguments
    return library


class Timeout(Exception):
    """What was waited for did not happen in the simulated time allowed."""


class Simulator(board.Hands):
    """A controller just powered up, at time 0; reset lasts for the first 320 ns.

    Parameters
    ----------
    boot, firmware : path, optional
        Memory images for ``$readmemh``, given to the Verilog as ``+boot=`` and ``+firmware=``.
    plant_overrides : sequence of str
        As for :mod:`tb.board.plant`.
    flash : path or bytes, optional
        Fit a flash with these contents, the rest of it erased.  A path: a file of them, made when there is none, and
        written by :meth:`close`, so that the next power-up finds what this one left.  By default none is fitted.
    baud : float
        Of the host's end of the serial line.
    verilog : path
        The top ``abbe``, in one file.
    """

    def __init__(self, *, boot=None, firmware=None, plant_overrides=(), flash=None, baud=115200.0, verilog=CONTROLLER):
        self._sim = self._flash_file = None
        self._library = declare(board.declare(ctypes.CDLL(str(build.build(verilog)))))
        images = {"boot": boot, "firmware": firmware}
        arguments = [f"+{name}={Path(file).resolve(strict=True)}" for name, file in images.items() if file is not None]
        # Verilator takes the first argument for the program's name.
        strings = [b"abbe", *(argument.encode() for argument in arguments)]
        text = plant.render(plant.load(plant_overrides)).encode()
        error = ctypes.create_string_buffer(200)
        self._sim = self._library.sim_create(
            text, baud, len(strings), (ctypes.c_char_p * len(strings))(*strings), error, len(error))
        if not self._sim:
            raise ValueError(error.value.decode())
        self._board = self._library.sim_board(self._sim)
        self._flash_file = None if flash is None or isinstance(flash, bytes) else Path(flash)
        if self._flash_file:
            flash = self._flash_file.read_bytes() if self._flash_file.exists() else b""
        if flash is not None:
            if len(flash) > FLASH_BYTES:
                raise ValueError(f"the flash has {FLASH_BYTES} bytes, not {len(flash)}")
            self._library.sim_fit_flash(self._sim, flash, len(flash))

    def close(self):
        """Power off; a change of the flash that is under way stays as far as it is done."""
        if self._sim and self._flash_file:
            self._flash_file.write_bytes(self.flash())
        if self._sim:
            self._library.sim_destroy(self._sim)
        self._sim = self._board = None

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self.close()

    # -- Time ------------------------------------------------------------------------------------------------

    @property
    def time_ps(self):
        """All clock edges before this time have been simulated."""
        return self._library.sim_time_ps(self._sim)

    def run(self, duration_ps):
        """Let time pass."""
        self._run(duration_ps)

    def run_until(self, predicate, *, timeout_ps, every_ps=100 * US):
        """Run until ``predicate()`` is true, asked every ``every_ps``; raises :exc:`Timeout`."""
        end_ps = self.time_ps + timeout_ps
        while not predicate():
            if self.time_ps >= end_ps:
                raise Timeout(f"{predicate!r} was not met within {timeout_ps / MS:g} ms")
            self._run(min(every_ps, end_ps - self.time_ps))

    def run_until_pin(self, signal, level, *, timeout_ps):
        """Run until the end of the ``sync`` period in which a pin changes to ``level``; raises :exc:`Timeout`."""
        mask = 1 << SIGNALS.index(signal)
        if self._run(timeout_ps, *((mask, 0) if level else (0, mask))) != PIN:
            raise Timeout(f"{signal} did not become {level} within {timeout_ps / MS:g} ms")

    def run_until_lines(self, count, *, timeout_ps):
        """Run until ``count`` more line feeds have been received; raises :exc:`Timeout`."""
        if self._run(timeout_ps, 0, 0, self._library.sim_serial_lines(self._sim) + count) != LINES:
            raise Timeout(f"expected {count} lines within {timeout_ps / MS:g} ms, and received {self.serial_read()!r}")

    def _run(self, duration_ps, stop_rise=0, stop_fall=0, stop_lines=0):
        reason = self._library.sim_run(self._sim, int(duration_ps), stop_rise, stop_fall, stop_lines)
        if reason == FINISHED:
            raise RuntimeError("the Verilog called $finish")
        return reason

    @property
    def clocks(self):
        """``(sync clocks so far, those that the CPU was awake for)``."""
        counts = ctypes.c_uint64(), ctypes.c_uint64()
        self._library.sim_clocks(self._sim, *map(ctypes.byref, counts))
        return tuple(count.value for count in counts)

    # -- The flash -------------------------------------------------------------------------------------------

    def flash(self, address=0, size=None):
        """Contents of the flash now: all, or ``size`` bytes from an address on."""
        size = FLASH_BYTES - address if size is None else size
        if not 0 <= address <= address + size <= FLASH_BYTES:
            raise ValueError(f"{size} bytes at {address:#x} are not in the flash")
        contents = self._library.sim_flash(self._sim)
        if not contents:
            raise ValueError("no flash is fitted")
        return ctypes.string_at(ctypes.addressof(contents.contents) + address, size)

    def set_flash_times(self, *, program_ps, erase_ps):
        """How long a page programmed and a sector erased take from now on."""
        self._library.sim_set_flash_times(self._sim, program_ps, erase_ps)

    # -- The serial line -------------------------------------------------------------------------------------

    def serial_write(self, data):
        """Send bytes: bits leave from now on, without gaps, after those still waiting."""
        self._library.sim_serial_write(self._sim, bytes(data), len(data))

    def serial_read(self):
        """All bytes received since the last call."""
        return self.serial_read_timed()[0]

    def serial_read_timed(self):
        """The same, and an array of the times (ps) of their start bits."""
        return self._take_received(self._library.sim_serial_read)

    def _take_received(self, read):
        data, times = numpy.empty(0, "u1"), numpy.empty(0, "i8")
        chunk_data, chunk_times = numpy.empty(4096, "u1"), numpy.empty(4096, "i8")
        while count := read(self._sim, chunk_data.ctypes.data, chunk_times.ctypes.data, len(chunk_data)):
            data = numpy.append(data, chunk_data[:count])
            times = numpy.append(times, chunk_times[:count])
        return data.tobytes(), times

    def serial_set_baud(self, baud):
        """For bytes that start from now on, both ways."""
        self._library.sim_serial_set_baud(self._sim, baud)

    @property
    def serial_unsent(self):
        """How many of the bytes written have not left yet, stop bit included."""
        return self._library.sim_serial_unsent(self._sim)

    @property
    def serial_framing_errors(self):
        """Bytes received without a stop bit; they are not in what :meth:`serial_read` returns."""
        return self._library.sim_serial_framing_errors(self._sim)

    def report_read_timed(self):
        """As :meth:`serial_read_timed`, of the report port's line."""
        return self._take_received(self._library.sim_report_read)

    def report_read(self):
        """All bytes received on the report port's line since the last call."""
        return self.report_read_timed()[0]

    def report_set_baud(self, baud):
        """Of the report port's line, for bytes that start from now on; ``baud`` of the other at first."""
        self._library.sim_report_set_baud(self._sim, baud)

    @property
    def report_framing_errors(self):
        """Bytes received on that line without a stop bit."""
        return self._library.sim_report_framing_errors(self._sim)

    def command(self, text, *, lines=1, timeout_ps=200 * MS):
        """Send a command and its carriage return; returns the reply as text, up to its line feed included.

        Bytes received earlier are thrown away, so nothing is taken for the reply that came before the command.
        """
        self.serial_read()
        self.serial_write(text.encode("latin-1") + b"\r")
        self.run_until_lines(lines, timeout_ps=timeout_ps)
        return self.serial_read().decode("latin-1")

    # -- Inputs ----------------------------------------------------------------------------------------------

    def schedule_input(self, time_ps, name, level):
        """Set ``estop``, ``in0`` or ``in1`` at a time to come, to the picosecond. Call in order of time."""
        self._library.sim_schedule_input(self._sim, time_ps, board.INPUTS[name], level)

    # -- Records ---------------------------------------------------------------------------------------------

    def record(self, *signals):
        """Record every change of these pins from now on; none of them: stop.

        Encoder edges are recorded at their true times, the controller's pins at the clock edge that moves them.
        """
        self._library.sim_set_recording(self._sim, sum(1 << SIGNALS.index(signal) for signal in set(signals)))

    def levels(self):
        """``{signal: level}`` of all pins now."""
        word = self._library.sim_levels(self._sim)
        return {signal: word >> n & 1 for n, signal in enumerate(SIGNALS)}

    def changes(self):
        """Take the recorded changes: an array of :data:`CHANGE`, in order of time; ``signal`` indexes :data:`SIGNALS`."""
        return self._take(self._library.sim_take_changes, CHANGE)

    def sample(self, period_ps):
        """Sample the stage's true motion this often from now on; 0 stops."""
        self._library.sim_set_sampling(self._sim, period_ps)

    def samples(self):
        """Take the samples: an array of :data:`SAMPLE`."""
        return self._take(self._library.sim_take_samples, SAMPLE)

    def _take(self, function, dtype):
        taken = []
        while True:
            chunk = numpy.empty(65536, dtype)
            count = function(self._sim, chunk.ctypes.data, len(chunk))
            taken.append(chunk[:count])
            if count < len(chunk):
                return numpy.concatenate(taken)
