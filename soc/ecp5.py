# SPDX-License-Identifier: BSD-2-Clause
"""What every ECP5 board needs around the controller: clocks from a PLL, and a reset that both domains share.

Sources: Lattice FPGA-TN-02200, "ECP5 and ECP5-5G sysCLOCK PLL/DLL Design and Usage Guide" (EHXPLLL: dividers,
feedback, phase; DCCA: clock enable), and Lattice FPGA-DS-02012, "ECP5 and ECP5-5G Family Data Sheet", table
"sysCLOCK PLL Timing" (ranges).
"""

from dataclasses import dataclass
from fractions import Fraction
from math import ceil

from amaranth import ClockDomain, ClockSignal, Const, Instance, Module, Shape, Signal
from amaranth.lib import wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import In, Out

from soc.memory import Region
from soc.top import CLOCK_HZ, DOMAINS, FAST_CLOCK_HZ, REGIONS, Abbe

__all__ = ["Board", "ClockGate", "ClockGenerator", "ConfigurationClock", "PllSettings", "ResetSequencer"]

MHZ = 1_000_000
INPUT_HZ = 8 * MHZ, 400 * MHZ
OUTPUT_HZ = Fraction(3_125_000), 400 * MHZ
PFD_HZ = 10 * MHZ, 400 * MHZ
VCO_HZ = 400 * MHZ, 800 * MHZ
DIVIDER_MOST = 128


@dataclass(frozen=True)
class PllSettings:
    """Dividers of an EHXPLLL that is fed back from its first output.

        pfd = input / input_divider,   first output = pfd * feedback_divider,
        vco = first output * output_dividers[0],   output n = vco / output_dividers[n]

    All outputs rise together: each divider starts ``divider - 1`` periods of the VCO in (parameter CPHASE).
    """
    input_hz: int
    input_divider: int
    feedback_divider: int
    output_dividers: tuple

    @property
    def vco_hz(self):
        return (Fraction(self.input_hz, self.input_divider) * self.feedback_divider * self.output_dividers[0])

    @property
    def outputs_hz(self):
        return tuple(self.vco_hz / divider for divider in self.output_dividers)

    @classmethod
    def find(cls, input_hz, outputs_hz):
        """Settings that give these frequencies exactly, the VCO as near the middle of its range as may be and the
        comparison as fast as may be.  Raises :exc:`ValueError` if there are none."""
        def within(frequency, limits):
            return limits[0] <= frequency <= limits[1]

        best = None
        if within(input_hz, INPUT_HZ) and all(within(hz, OUTPUT_HZ) for hz in outputs_hz):
            first = Fraction(outputs_hz[0])
            for input_divider in range(1, DIVIDER_MOST + 1):
                pfd = Fraction(input_hz, input_divider)
                if not within(pfd, PFD_HZ) or (first / pfd).denominator != 1 or first / pfd > DIVIDER_MOST:
                    continue
                for divider in range(1, DIVIDER_MOST + 1):
                    vco = first * divider
                    dividers = [vco / hz for hz in outputs_hz]
                    if not within(vco, VCO_HZ) or any(d.denominator != 1 or d > DIVIDER_MOST for d in dividers):
                        continue
                    merit = (abs(vco - sum(VCO_HZ) // 2), input_divider)
                    if best is None or merit < best[0]:
                        best = merit, cls(input_hz, input_divider, int(first / pfd), tuple(map(int, dividers)))
        if best is None:
            raise ValueError(f"no setting of the PLL makes {outputs_hz!r} Hz from {input_hz!r} Hz")
        return best[1]

    def parameters(self):
        """Parameters of the primitive."""
        result = {
            "CLKI_DIV": self.input_divider, "CLKFB_DIV": self.feedback_divider, "FEEDBK_PATH": "CLKOP",
            "PLLRST_ENA": "DISABLED", "INTFB_WAKE": "DISABLED", "STDBY_ENABLE": "DISABLED",
            "DPHASE_SOURCE": "DISABLED",
        }
        for n, letter in enumerate(("P", "S", "S2", "S3")):
            used = n < len(self.output_dividers)
            result[f"CLKO{letter}_ENABLE"] = "ENABLED" if used else "DISABLED"
            if used:
                divider = self.output_dividers[n]
                result |= {f"CLKO{letter}_DIV": divider, f"CLKO{letter}_CPHASE": divider - 1,
                           f"CLKO{letter}_FPHASE": 0, f"OUTDIVIDER_MUX{'ABCD'[n]}": f"DIV{'ABCD'[n]}"}
        return result


class ResetSequencer(wiring.Component):
    """Resets domains that share a PLL, without ever changing their reset while they have clock edges.

    Domain ``board``, a clock that runs whether or not the PLL does.  A reset net that reaches thousands of
    flip-flops does not cross the chip within a clock of 5 ns, and half the design leaving reset a clock early is a
    spurious event.  So the order is: stop the clocks, raise ``reset``, run the clocks (``hold_clocks``), stop
    them, lower ``reset``, run.  Every domain sees the same reset, whole, and they restart together.

    The sequence starts when the configuration ends, when ``locked`` falls and when ``request`` rises; it waits,
    with ``reset`` high, until ``locked`` has been high and ``request`` low for ``hold_clocks``.

    Parameters
    ----------
    hold_clocks, quiet_clocks : int
        Clocks of ``board`` in reset with the clocks running, and from stopping the clocks to a change of
        ``reset`` as from that to running them again; at least 1.

    Members
    -------
    locked, request : In(1)
        Asynchronous; they act after 2 clocks.
    reset : Out(1)
        For all domains.  From a flip-flop; 1 after configuration.
    run : Out(1)
        Let the clocks run.  From a flip-flop.
    safe : Out(1)
        From a flip-flop: 1 while nothing may be driven.  Rises 3 clocks after its cause is sampled, whatever the
        PLL does; falls as the clocks start after reset.
    """

    def __init__(self, *, hold_clocks, quiet_clocks):
        for name, value in (("hold_clocks", hold_clocks), ("quiet_clocks", quiet_clocks)):
            if not isinstance(value, int) or value < 1:
                raise ValueError(f"{name} must be an integer of at least 1, not {value!r}")
        self._hold_clocks, self._quiet_clocks = hold_clocks, quiet_clocks
        super().__init__({"locked": In(1), "request": In(1),
                          "reset": Out(1, init=1), "run": Out(1), "safe": Out(1, init=1)})

    def elaborate(self, platform):
        m = Module()
        locked, request = Signal(), Signal(init=1)
        m.submodules.locked_sync = FFSynchronizer(self.locked, locked, o_domain="board")
        m.submodules.request_sync = FFSynchronizer(self.request, request, o_domain="board", init=1)
        wanted = request | ~locked
        left = Signal(range(max(self._hold_clocks, self._quiet_clocks)))
        m.d.board += left.eq(left - 1)

        def wait(clocks, state):
            m.d.board += left.eq(clocks - 1)
            m.next = state

        with m.FSM(domain="board", init="assert"):
            with m.State("stop"):               # clocks stopped, reset still low
                with m.If(left == 0):
                    m.d.board += self.reset.eq(1)
                    wait(self._quiet_clocks, "assert")
            with m.State("assert"):             # clocks stopped, reset high
                with m.If(left == 0):
                    m.d.board += self.run.eq(1)
                    wait(self._hold_clocks, "hold")
            with m.State("hold"):               # clocks running, reset high
                with m.If(wanted):
                    m.d.board += left.eq(self._hold_clocks - 1)
                with m.Elif(left == 0):
                    m.d.board += self.run.eq(0)
                    wait(self._quiet_clocks, "settle")
            with m.State("settle"):             # clocks stopped, reset still high
                with m.If(left == 0):
                    m.d.board += self.reset.eq(0)
                    wait(self._quiet_clocks, "release")
            with m.State("release"):            # clocks stopped, reset low
                with m.If(left == 0):
                    m.d.board += [self.run.eq(1), self.safe.eq(0)]
                    m.next = "run"
            with m.State("run"):
                with m.If(wanted):
                    m.d.board += [self.run.eq(0), self.safe.eq(1)]
                    wait(self._quiet_clocks, "stop")
        return m


class ClockGate(wiring.Component):
    """A clock that can be stopped without a short pulse: the primitive DCCA, which drives a primary clock net.

    Members
    -------
    i : In(1)
        Clock.
    enable : In(1)
        From any domain; acts at a falling edge of ``i``.
    o : Out(1)
    """

    i: In(1)
    enable: In(1)
    o: Out(1)

    def elaborate(self, platform):
        m = Module()
        m.submodules.dcca = Instance("DCCA", i_CLKI=self.i, i_CE=self.enable, o_CLKO=self.o)
        return m


class ClockGenerator(wiring.Component):
    """The domains of the controller from a board's oscillator.

    Makes the domain ``board`` for its own use; ``sync`` and ``fast`` leave as signals.  Reset takes as long with any
    oscillator: ``HOLD_NS`` and ``QUIET_NS``, see :class:`ResetSequencer`.

    Parameters
    ----------
    input_hz, sync_hz, fast_hz : int
        Frequencies; :exc:`ValueError` if the PLL cannot make them exactly.

    Attributes
    ----------
    settings : PllSettings
    hold_clocks, quiet_clocks : int
        Of the oscillator.

    Members
    -------
    oscillator : In(1)
    request : In(1)
        Reset, asynchronous, 1 = reset.
    fast_clk, sync_clk : Out(1)
        Phase-aligned; stopped while ``reset`` changes.
    reset : Out(1)
        For both domains: see :class:`ResetSequencer`.
    safe : Out(1)
        1 = drive nothing that moves.
    """

    HOLD_NS = 10_240                # 512 clocks of 50 MHz, where 3 would do
    QUIET_NS = 640                  # for the reset to reach every flip-flop

    def __init__(self, *, input_hz, sync_hz, fast_hz):
        self.settings = PllSettings.find(input_hz, (fast_hz, sync_hz))
        self.hold_clocks, self.quiet_clocks = (ceil(Fraction(ns * input_hz, 10**9)) for ns in (self.HOLD_NS, self.QUIET_NS))
        super().__init__({"oscillator": In(1), "request": In(1), "fast_clk": Out(1), "sync_clk": Out(1),
                          "reset": Out(1, init=1), "safe": Out(1, init=1)})

    def elaborate(self, platform):
        m = Module()
        m.domains.board = ClockDomain("board", reset_less=True, local=True)
        m.d.comb += ClockSignal("board").eq(self.oscillator)
        fast, sync, locked = Signal(), Signal(), Signal()
        m.submodules.pll = Instance(
            "EHXPLLL",
            # The loop filter, as the project Trellis's ecppll sets it; the vendor's tool alone knows its formula.
            ("a", "ICP_CURRENT", "12"), ("a", "LPF_RESISTOR", "8"), ("a", "MFG_ENABLE_FILTEROPAMP", "1"),
            ("a", "MFG_GMCREF_SEL", "2"),
            *(("p", name, value) for name, value in self.settings.parameters().items()),
            i_CLKI=self.oscillator, i_CLKFB=fast, o_CLKOP=fast, o_CLKOS=sync, o_LOCK=locked,
            i_RST=Const(0), i_STDBY=Const(0), i_PLLWAKESYNC=Const(0), i_ENCLKOP=Const(0), i_ENCLKOS=Const(0),
            i_PHASESEL0=Const(0), i_PHASESEL1=Const(0), i_PHASEDIR=Const(1), i_PHASESTEP=Const(1),
            i_PHASELOADREG=Const(1),
        )
        m.submodules.sequencer = sequencer = ResetSequencer(hold_clocks=self.hold_clocks,
                                                            quiet_clocks=self.quiet_clocks)
        m.submodules.fast_gate = fast_gate = ClockGate()
        m.submodules.sync_gate = sync_gate = ClockGate()
        m.d.comb += [
            sequencer.locked.eq(locked), sequencer.request.eq(self.request),
            fast_gate.i.eq(fast), fast_gate.enable.eq(sequencer.run), self.fast_clk.eq(fast_gate.o),
            sync_gate.i.eq(sync), sync_gate.enable.eq(sequencer.run), self.sync_clk.eq(sync_gate.o),
            self.reset.eq(sequencer.reset), self.safe.eq(sequencer.safe),
        ]
        return m


class ConfigurationClock(wiring.Component):
    """The clock pin of the flash that holds the configuration: the primitive USRMCLK, as the pin is no other I/O's.

    After configuration the first edges may not reach the pin (Lattice FPGA-TN-02039, "ECP5 and ECP5-5G sysCONFIG Usage Guide").

    Members
    -------
    i : In(1)
        Its level.
    """

    i: In(1)

    def elaborate(self, platform):
        m = Module()
        m.submodules.usrmclk = Instance("USRMCLK", i_USRMCLKI=self.i, i_USRMCLKTS=Const(0))
        return m


INTERNAL = {f"{prefix}{signal}" for prefix in DOMAINS.values() for signal in ("clk", "rst")} | {"cpu_asleep"}
"""Members of the controller that are no pins of a board."""

FLASH_CLOCK = "flash_sck"
"""The output that leaves by a :class:`ConfigurationClock`: no pin of a board either."""

FLASH_STRAPS = "flash_wp_n", "flash_hold_n"
"""Pins of the flash that are held at 1: four-bit transfers have other uses for them."""

MOVES = "pwm", "motor_enable"
"""Outputs that move things: held low, behind their flip-flops, while the clocks cannot be trusted."""

STOPS = "estop", "limit_lower", "limit_upper"
"""Inputs that stop things when they are 1, as with a broken wire."""


class Board(wiring.Component):
    """The controller on a board: every pin of :class:`soc.top.Abbe` under its own name, clocks and reset.

    A board is a subclass in ``soc/board_<family>.py`` and ``constraints/<name>.lpf``, which gives every member
    a place; those of the flash are the ones that the FPGA is configured by.  It may add members of its own by ``PINS`` and use them in :meth:`system`, and do without some of the
    controller's by ``ABSENT``.  docs/porting.md walks through one.

    Class attributes
    ----------------
    name : str
        As in ``make gateware BOARD=<name>``.
    device, package, speed : str
        As Lattice writes them, without the rest of the part number: ``LFE5U-85F``, ``CABGA381``, ``6``.
    oscillator : (str, int)
        Its pin and its frequency in Hz.
    programmer : str
        The board's name for openFPGALoader, or None.
    ram_bytes : int
        RAM.  Firmware is linked for that of :data:`soc.top.REGIONS`; with less the build is a check of area and
        timing, see :mod:`soc.contents`.
    ecppack : tuple of str
        Options for the bitstream.
    PINS : dict
        Members of the board itself.
    ABSENT : dict
        Members of the controller that are no pins of this board: ``{input: the level it reads, output: None}``.
        Inputs that stop things, :data:`STOPS`, can only read all ones; :exc:`ValueError` if one is to read
        anything else, if a level does not fit, and for a name that is no pin of the controller.

    Parameters
    ----------
    build_id : int
        For the identity block.
    """

    name = device = package = speed = oscillator = programmer = None
    ram_bytes = REGIONS[-1].size
    ecppack = ()
    PINS = {}
    ABSENT = {}

    @classmethod
    def regions(cls):
        """The memory of the controller on this board."""
        return tuple(Region(r.name, plusarg=r.plusarg, address=r.address, writable=r.writable,
                            size=cls.ram_bytes if r.name == "ram" else r.size) for r in REGIONS)

    def __init__(self, *, build_id=0):
        self.controller = Abbe(build_id=build_id, regions=self.regions())
        pins = {name: member for name, member in self.controller.signature.members.items()
                if name not in INTERNAL | {FLASH_CLOCK}}
        for name, level in self.ABSENT.items():
            self._check_absent(name, pins.get(name), level)
        self._pins = {name: member for name, member in pins.items() if name not in self.ABSENT}
        self._straps = dict.fromkeys(FLASH_STRAPS, Out(1)) if "flash_cs_n" in self._pins else {}
        super().__init__({self.oscillator[0]: In(1), **self._pins, **self._straps, **self.PINS})

    def _check_absent(self, name, member, level):
        if member is None:
            raise ValueError(f"{self.name}: {name!r} in ABSENT is no pin of the controller")
        highest = (1 << Shape.cast(member.shape).width) - 1
        if member.flow is Out:
            allowed, expected = level is None, "None, as it is an output"
        elif name in STOPS:
            allowed, expected = level == highest, f"{highest}, as with a broken wire"
        else:
            allowed, expected = isinstance(level, int) and 0 <= level <= highest, f"an integer from 0 to {highest}"
        if not allowed:
            raise ValueError(f"{self.name}: {name} in ABSENT must be {expected}, not {level!r}")

    def system(self, m, clocks):
        """Connect the members of the board itself; ``clocks`` is its :class:`ClockGenerator`."""

    def elaborate(self, platform):
        m = Module()
        controller = m.submodules.controller = self.controller
        clocks = m.submodules.clocks = ClockGenerator(input_hz=self.oscillator[1], sync_hz=CLOCK_HZ,
                                                      fast_hz=FAST_CLOCK_HZ)
        m.d.comb += clocks.oscillator.eq(getattr(self, self.oscillator[0]))
        for domain, prefix in DOMAINS.items():
            m.d.comb += [
                getattr(controller, f"{prefix}clk").eq(clocks.fast_clk if domain == "fast" else clocks.sync_clk),
                getattr(controller, f"{prefix}rst").eq(clocks.reset),
            ]
        for name, member in self._pins.items():
            inside, outside = getattr(controller, name), getattr(self, name)
            if member.flow is In:
                m.d.comb += inside.eq(outside)
            else:
                m.d.comb += outside.eq(inside & ~clocks.safe.replicate(len(inside)) if name in MOVES else inside)
        if self._straps:
            m.submodules.flash_clock = flash_clock = ConfigurationClock()
            m.d.comb += [flash_clock.i.eq(getattr(controller, FLASH_CLOCK)), *(getattr(self, name).eq(1) for name in self._straps)]
        for name, level in self.ABSENT.items():
            if level is not None:
                m.d.comb += getattr(controller, name).eq(level)
        self.system(m, clocks)
        return m
