# SPDX-License-Identifier: BSD-2-Clause
"""The controller: which blocks, at which addresses, on which interrupts, and the wires between them."""

from dataclasses import dataclass
from typing import Callable

from amaranth import ClockDomain, Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect

from rtl.adc import AdcPeripheral
from rtl.buttons import BUTTONS, ButtonsPeripheral
from rtl.compare import ComparePeripheral
from rtl.decisions import ClassifierPeripheral
from rtl.divider import DividerPeripheral
from rtl.flash import FlashPeripheral
from rtl.identity import IdentityPeripheral
from rtl.inputs import DIP_SWITCHES, InputsPeripheral
from rtl.interlock import InterlockPeripheral
from rtl.knob import KNOBS, KnobPeripheral
from rtl.led import LedPeripheral
from rtl.line import LinePeripheral
from rtl.monitor import STEP_BITS
from rtl.pwm import PwmPeripheral
from rtl.quadrature import QuadraturePeripheral, StepStream
from rtl.registers import BUS_WIDTH, csr
from rtl.router import RouterPeripheral
from rtl.serial import SerialPeripheral
from rtl.snapshot import SnapshotPeripheral
from rtl.timer import TimerPeripheral
from rtl.trigger import TriggerPeripheral
from rtl.watchdog import WatchdogPeripheral
from soc.bus import BusFaultPeripheral, BusTimeout, RegisterBridge
from soc.cpu import BUS, Cpu
from soc.memory import OnChipMemory, Region
from amaranth_soc import wishbone

__all__ = ["Abbe", "AXES", "PERIPHERALS", "REGISTERS", "REGIONS"]

CLOCK_HZ = 50_000_000
FAST_CLOCK_HZ = 200_000_000
AXES = 4

DOMAINS = {"sync": "", "fast": "fast_", "cpu": "cpu_"}
"""Clock domains, and what their pins' names begin with."""

REGIONS = (
    Region("boot", plusarg="boot", address=0x0000_0000, size=32 << 10, writable=False),
    Region("ram", plusarg="firmware", address=0x0002_0000, size=256 << 10, writable=True),
)
MEMORY_ADDRESS_BITS = 19

REGISTERS = 0xffff_f000
"""First address of the 4 KiB of registers.  The most significant bit set means: not cached."""
REGISTERS_ADDRESS_BITS = 12


@dataclass(frozen=True)
class Peripheral:
    """One line of :data:`PERIPHERALS`: a block of registers.

    ``part`` names the piece of gateware behind it, which ``make`` makes; blocks of the same part share one.
    ``bus`` is its bus for these registers, ``registers`` the class that describes them (default: the part's).
    ``interrupt`` is (name, line).
    """
    name: str
    address: int
    make: Callable
    interrupt: tuple = None
    part: str = None
    bus: str = "bus"
    registers: type = None


PERIPHERALS = (
    Peripheral("identity", 0xffff_f000, IdentityPeripheral),
    Peripheral("bus", 0xffff_f040, BusFaultPeripheral, interrupt=("bus", 4)),
    Peripheral("inputs", 0xffff_f080, InputsPeripheral),
    Peripheral("serial", 0xffff_f0c0, SerialPeripheral, interrupt=("serial", 1)),
    Peripheral("timer", 0xffff_f100, TimerPeripheral, interrupt=("timer", 2)),
    Peripheral("buttons", 0xffff_f140, ButtonsPeripheral),
    Peripheral("knob", 0xffff_f180, KnobPeripheral),
    Peripheral("report", 0xffff_f200, SerialPeripheral, interrupt=("report", 5)),
    Peripheral("led", 0xffff_f240, LedPeripheral),
    Peripheral("watchdog", 0xffff_f280, WatchdogPeripheral),
    Peripheral("flash", 0xffff_f2c0, FlashPeripheral),
    # From here on within reach of one load or store off x0.
    Peripheral("snapshot", 0xffff_f800, SnapshotPeripheral),
    Peripheral("pwm", 0xffff_f880, PwmPeripheral, interrupt=("tick", 0)),
    Peripheral("compare", 0xffff_f900, LinePeripheral, interrupt=("line", 3),
               part="line", bus="compare_bus", registers=ComparePeripheral),
    Peripheral("divider", 0xffff_f940, LinePeripheral, part="line", bus="divider_bus",
               registers=DividerPeripheral),
    Peripheral("router", 0xffff_f980, LinePeripheral, part="line", bus="router_bus",
               registers=RouterPeripheral),
    *(Peripheral(f"quadrature{n}", 0xffff_fa00 + 0x10 * n, QuadraturePeripheral) for n in range(AXES)),
    Peripheral("adc", 0xffff_fb00, AdcPeripheral),
    Peripheral("classifier", 0xffff_fb40, ClassifierPeripheral),
    Peripheral("trigger", 0xffff_fb80, TriggerPeripheral, interrupt=("trigger", 6)),
    Peripheral("interlock", 0xffff_fc00, InterlockPeripheral),
)


class Abbe(wiring.Component):
    """The whole controller.  Domains ``sync`` 50 MHz, ``fast`` 200 MHz, and ``cpu``, which is ``sync`` but may
    be stopped while ``cpu_asleep`` is high (see :class:`soc.cpu.Cpu`), and which the watchdog resets alone.

    Parameters
    ----------
    build_id : int
        Readable in the identity block; see :func:`soc.verilog.build_id`.
    regions : sequence of Region
        Memory; a board may have less than :data:`REGIONS`, for which firmware is linked.
    arguments : dict
        ``{part: {parameter: value}}`` for parts that are made otherwise than they are by default.

    Members: pins, all active high but those in _n.  Inputs are asynchronous, outputs come from flip-flops.
    -------
    clk, rst, fast_clk, fast_rst, cpu_clk, cpu_rst : In(1)
        Clocks, and resets that fall in step with them.
    enc_a, enc_b, enc_z : In(4)
        Encoders of X, Y, Z, F; the count goes up when A leads B.
    limit_lower, limit_upper : In(4)
        1 = closed, at the limit.
    estop : In(1)
        1 = drives off.
    in0, in1 : In(1)
        TTL inputs.
    button, joystick_button : In(4), In(1)
        1 = pressed: @, HOME, ZERO, the joystick's; and the joystick's on a wire of its own.
    dip : In(4)
        DIP switches 4, 5, 7, 8; 1 = on.
    knob_a, knob_b : In(3)
        Hand-wheels: control knob, X, Y; up when A leads B.
    adc_cs_n, adc_sck, adc_mosi, adc_miso : Out(1), Out(1), Out(1), In(1)
        Analog-to-digital converter, see :mod:`rtl.adc`.
    flash_cs_n, flash_sck, flash_mosi, flash_miso : Out(1), Out(1), Out(1), In(1)
        Configuration flash, see :mod:`rtl.flash`; ``flash_miso`` 1 where there is none.
    serial_rx, serial_tx : In(1), Out(1)
        Serial port, idle high.
    report_tx : Out(1)
        Report port, idle high: sends only.
    pwm, dir : Out(4)
        Motor drive; ``dir`` 1 = toward +.
    motor_enable : Out(1)
        Power stages on.
    out0, sync_out, encoder_out : Out(1)
        TTL outputs, see :mod:`rtl.router`.
    cpu_asleep : Out(1)
        Simulation only.
    """

    def __init__(self, *, build_id=0, regions=REGIONS, arguments={}):
        self._regions = regions
        arguments = {"identity": {"clock_hz": CLOCK_HZ, "fast_clock_hz": FAST_CLOCK_HZ, "build_id": build_id},
                     "bus": {"signature": BUS}} | arguments
        self._parts = {}
        self._decoder = csr.Decoder(addr_width=REGISTERS_ADDRESS_BITS - 2, data_width=BUS_WIDTH)
        for p in PERIPHERALS:
            name = p.part or p.name
            if name not in self._parts:
                self._parts[name] = p.make(**arguments.get(name, {}))
            self._decoder.add(getattr(self._parts[name], p.bus), name=p.name, addr=(p.address - REGISTERS) // 4)
        self.register_map = self._decoder.bus.memory_map
        super().__init__({
            **{f"{prefix}{signal}": In(1) for prefix in DOMAINS.values() for signal in ("clk", "rst")},
            "enc_a": In(AXES), "enc_b": In(AXES), "enc_z": In(AXES),
            "limit_lower": In(AXES), "limit_upper": In(AXES), "estop": In(1), "in0": In(1), "in1": In(1),
            "button": In(BUTTONS), "joystick_button": In(1), "dip": In(DIP_SWITCHES),
            "knob_a": In(KNOBS), "knob_b": In(KNOBS),
            "adc_cs_n": Out(1, init=1), "adc_sck": Out(1), "adc_mosi": Out(1), "adc_miso": In(1),
            "flash_cs_n": Out(1, init=1), "flash_sck": Out(1), "flash_mosi": Out(1), "flash_miso": In(1, init=1),
            "serial_rx": In(1, init=1), "serial_tx": Out(1, init=1),
            "report_tx": Out(1, init=1),
            "pwm": Out(AXES), "dir": Out(AXES), "motor_enable": Out(1),
            "out0": Out(1), "sync_out": Out(1), "encoder_out": Out(1),
            "cpu_asleep": Out(1),
        })

    def elaborate(self, platform):
        m = Module()
        for name, prefix in DOMAINS.items():
            domain = ClockDomain(name)
            m.domains += domain
            reset = getattr(self, f"{prefix}rst") | (self._parts["watchdog"].cpu_reset if name == "cpu" else 0)
            m.d.comb += [domain.clk.eq(getattr(self, f"{prefix}clk")), domain.rst.eq(reset)]
        for name, part in self._parts.items():
            m.submodules[name] = part
        self._connect_processor(m)
        self._connect_blocks(m)
        return m

    def _connect_processor(self, m):
        m.submodules.cpu = cpu = Cpu(reset_vector=self._regions[0].address)
        m.submodules.memory = memory = OnChipMemory(self._regions, addr_width=MEMORY_ADDRESS_BITS)
        m.submodules.registers = self._decoder
        m.submodules.bridge = bridge = RegisterBridge(self._decoder.bus)
        connect(m, bridge.csr, self._decoder.bus)
        for name, targets in ("ibus", [(memory.ibus, 0)]), ("dbus", [(memory.dbus, 0), (bridge.bus, REGISTERS)]):
            decoder = wishbone.Decoder(addr_width=BUS.addr_width, data_width=BUS_WIDTH, granularity=8,
                                       features=BUS.features)
            for target, address in targets:
                decoder.add(target, addr=address, name="registers" if address else "memory")
            timeout = BusTimeout(BUS)
            m.submodules[f"{name}_decoder"], m.submodules[f"{name}_timeout"] = decoder, timeout
            connect(m, getattr(cpu, name), timeout.initiator)
            connect(m, timeout.target, decoder.bus)
        for p in PERIPHERALS:
            if p.interrupt:
                m.d.comb += cpu.interrupts[p.interrupt[1]].eq(self._parts[p.part or p.name].interrupt)
        fault = self._parts["bus"]
        for name in "cyc", "stb", "we", "err", "adr":
            m.d.comb += getattr(fault, name).eq(getattr(cpu.dbus, name))
        m.d.comb += self.cpu_asleep.eq(cpu.asleep)

    def _connect_blocks(self, m):
        parts = self._parts
        inputs, serial, report, pwm, flash = (parts[name] for name in ("inputs", "serial", "report", "pwm", "flash"))
        snapshot, line, trigger, interlock = parts["snapshot"], parts["line"], parts["trigger"], parts["interlock"]
        for name in "limit_lower", "limit_upper", "estop", "in0", "in1", "dip":
            m.d.comb += getattr(inputs, name).eq(getattr(self, name))
        self._connect_panel(m)
        m.d.comb += [
            serial.rx.eq(self.serial_rx), self.serial_tx.eq(serial.tx), self.report_tx.eq(report.tx),
            self.flash_cs_n.eq(flash.cs_n), self.flash_sck.eq(flash.sck), self.flash_mosi.eq(flash.mosi),
            flash.miso.eq(self.flash_miso),
            interlock.estop.eq(self.estop), interlock.expired.eq(parts["watchdog"].expired),
            pwm.inhibit.eq(interlock.inhibit),
            self.pwm.eq(pwm.pwm), self.dir.eq(pwm.dir), self.motor_enable.eq(pwm.motor_enable),
            snapshot.tick.eq(pwm.tick_stb), pwm.latched_stb.eq(snapshot.tick_done),
            self.out0.eq(line.out0), self.sync_out.eq(line.sync_out), self.encoder_out.eq(line.encoder_out),
            trigger.in0.eq(self.in0), trigger.out0.eq(line.out0), trigger.time.eq(snapshot.time),
            parts["classifier"].pin.eq(self.in0),
        ]
        m.d.comb += line.light.eq(parts["led"].light)
        for n in range(AXES):
            encoder = parts[f"quadrature{n}"]
            m.d.comb += [
                encoder.a.eq(self.enc_a[n]), encoder.b.eq(self.enc_b[n]), encoder.z.eq(self.enc_z[n]),
                encoder.sample.eq(snapshot.sample), snapshot.positions[n].eq(encoder.steps.count),
                trigger.filter[n].eq(encoder.filter), trigger.count[n].eq(encoder.steps.count),
                interlock.low[n].eq(encoder.steps.count[:STEP_BITS]), interlock.illegal[n].eq(encoder.error),
                interlock.drive[n].eq(pwm.drive[n]),
            ]
            for name in StepStream().members:
                m.d.comb += getattr(getattr(line, f"step{n}"), name).eq(getattr(encoder.steps, name))

    def _connect_panel(self, m):
        """What a hand is on: buttons, hand-wheels, joystick; and the time of it."""
        parts = self._parts
        buttons, knob, adc = parts["buttons"], parts["knob"], parts["adc"]
        m.d.comb += [
            buttons.button.eq(self.button), buttons.joystick_button.eq(self.joystick_button),
            knob.a.eq(self.knob_a), knob.b.eq(self.knob_b),
            self.adc_cs_n.eq(adc.cs_n), self.adc_sck.eq(adc.sck), self.adc_mosi.eq(adc.mosi),
            adc.miso.eq(self.adc_miso), adc.tick.eq(parts["pwm"].tick_stb),
            *(parts[name].count.eq(parts["timer"].count) for name in ("buttons", "inputs")),
        ]
