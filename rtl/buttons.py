# SPDX-License-Identifier: BSD-2-Clause
"""Push-buttons: debounced, measured, and classed when they are released."""

from amaranth import Module, Mux, Signal, unsigned
from amaranth.lib import wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import In, Out, connect, flipped

from rtl.debounce import Debounce
from rtl.registers import Field, Register, RegisterBank, action

__all__ = ["BUTTONS", "Button", "ButtonsPeripheral", "EXTRA_LONG", "LONG", "SHORT"]

BUTTONS = 4
JOYSTICK = 3
"""The button that a joystick may bring on a wire of its own."""

MILLISECOND_CLOCKS = 50_000
SHORT, LONG, EXTRA_LONG = range(3)


class Button(wiring.Component):
    """Debounce a button and measure how long it is held.  Domain ``sync``.

    A press begins and ends when its level has lasted ``debounce_ms`` (see :class:`rtl.debounce.Debounce`), so
    both ends are late by as much and the duration is right to a millisecond.

    Members
    -------
    level : In(1)
        1 = pressed; of this domain, bouncing.
    millisecond : In(1)
        One-clock strobe.
    debounce_ms : In(6)
    long_ms, extra_long_ms : In(16)
        Shortest presses of the classes ``LONG`` and ``EXTRA_LONG``; the latter wins.
    pressed : Out(1)
        Debounced.
    released : Out(1)
        One-clock strobe, the first clock on which ``pressed`` is low; with it:
    duration_ms : Out(16)
        Milliseconds that the press lasted; stays at 65535 beyond.
    length : Out(2)
        ``SHORT``, ``LONG`` or ``EXTRA_LONG``.
    """

    def __init__(self):
        super().__init__({"level": In(1), "millisecond": In(1), "debounce_ms": In(6), "long_ms": In(16),
                          "extra_long_ms": In(16), "pressed": Out(1), "released": Out(1), "duration_ms": Out(16),
                          "length": Out(2)})

    def elaborate(self, platform):
        m = Module()
        m.submodules.debounce = debounce = Debounce(width=6)
        was = Signal()
        m.d.comb += [
            debounce.i.eq(self.level), debounce.strobe.eq(self.millisecond),
            debounce.periods.eq(self.debounce_ms), self.pressed.eq(debounce.o),
            self.released.eq(was & ~self.pressed),
            self.length.eq(Mux(self.duration_ms >= self.extra_long_ms, EXTRA_LONG,
                               Mux(self.duration_ms >= self.long_ms, LONG, SHORT))),
        ]
        m.d.sync += was.eq(self.pressed)
        with m.If(self.pressed & ~was):
            m.d.sync += self.duration_ms.eq(0)
        with m.Elif(self.pressed & self.millisecond & ~self.duration_ms.all()):
            m.d.sync += self.duration_ms.eq(self.duration_ms + 1)
        return m


class ButtonsPeripheral(wiring.Component):
    """Four buttons on the CSR bus.  Domain ``sync``.

    0 is @, 1 HOME, 2 ZERO, 3 the joystick's.  What a release has left stays until the next one of the same button,
    which comes two debounce times later at the earliest; it is readable on the clock after ``released`` is set.

    Parameters
    ----------
    millisecond_clocks : int
        Clocks of a millisecond.

    Members
    -------
    button : In(4)
        Asynchronous; 1 = pressed.
    joystick_button : In(1)
        Asynchronous; a second button 3: pressed is either.
    count : In(32)
        Time, for stamps: the timer's.
    """

    class Levels(Register, access="r"):
        """The buttons now."""
        pressed: Field(action.R, BUTTONS, doc="Bit n: button n is pressed, debounced. 0 is @, 1 HOME, 2 ZERO, 3 the "
                                              "joystick's.")
        pins: Field(action.R, BUTTONS, doc="Bit n: button n as it is, bouncing.")

    class Events(Register, access="rw"):
        """Presses that have ended."""
        released: Field(action.RW1C, BUTTONS, doc="Bit n: button n was released; Press and Time of it tell more. "
                                                  "Write 1 to clear, then read those.")
        lost: Field(action.RW1C, BUTTONS, doc="Bit n: that happened again before it was cleared. Write 1 to clear.")

    class Debounce(Register, access="rw"):
        """What is a bounce."""
        value: Field(action.RW, unsigned(6), init=10, unit="ms",
                     doc="Time that a level must last to count, to 1 ms less. 0 is 1.")

    class Long(Register, access="rw"):
        """Shortest long press."""
        value: Field(action.RW, unsigned(16), init=1000, unit="ms", doc="Taken at a release.")

    class ExtraLong(Register, access="rw"):
        """Shortest extra long press."""
        value: Field(action.RW, unsigned(16), init=3000, unit="ms", doc="Taken at a release.")

    class Press(Register, access="r"):
        """The last press of a button."""
        duration: Field(action.R, unsigned(16), unit="ms", doc="How long it was held; at most 65535.")
        length: Field(action.R, unsigned(2), doc="Its class: 0 short, 1 long, 2 extra long.")

    class Time(Register, access="r"):
        """When a button was released."""
        value: Field(action.R, unsigned(32), unit="clocks", doc="The timer's Count as the release was taken.")

    def __init__(self, *, millisecond_clocks=MILLISECOND_CLOCKS):
        if not isinstance(millisecond_clocks, int) or millisecond_clocks < 2:
            raise ValueError(f"millisecond_clocks must be an integer of at least 2, not {millisecond_clocks!r}")
        self._millisecond_clocks = millisecond_clocks
        self._registers = registers = RegisterBank(addr_width=4)
        self._levels = registers.add(self.Levels, offset=0x00)
        self._events = registers.add(self.Events, offset=0x04)
        self._debounce = registers.add(self.Debounce, offset=0x08)
        self._long = registers.add(self.Long, offset=0x0c)
        self._extra_long = registers.add(self.ExtraLong, offset=0x10)
        self._press = [registers.add(self.Press, offset=0x20 + 4 * n, name=f"press{n}") for n in range(BUTTONS)]
        self._time = [registers.add(self.Time, offset=0x30 + 4 * n, name=f"time{n}") for n in range(BUTTONS)]
        memory_map = registers.finish()
        super().__init__({"bus": In(registers.bus_signature), "button": In(BUTTONS), "joystick_button": In(1),
                          "count": In(32)})
        self.bus.memory_map = memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self._registers
        connect(m, flipped(self.bus), self._registers.bus)

        since = Signal(range(self._millisecond_clocks))
        millisecond = Signal()
        m.d.comb += millisecond.eq(since == self._millisecond_clocks - 1)
        m.d.sync += since.eq(Mux(millisecond, 0, since + 1))

        level, joystick = Signal(BUTTONS), Signal()
        m.submodules.button_sync = FFSynchronizer(self.button, level)
        m.submodules.joystick_sync = FFSynchronizer(self.joystick_button, joystick)

        events, levels = self._events.f, self._levels.f
        for n in range(BUTTONS):
            m.submodules[f"button{n}"] = button = Button()
            pin = level[n] | joystick if n == JOYSTICK else level[n]
            duration, length = Signal(16, name=f"duration{n}"), Signal(2, name=f"length{n}")
            time = Signal(32, name=f"time{n}")
            m.d.comb += [
                button.level.eq(pin), button.millisecond.eq(millisecond),
                button.debounce_ms.eq(self._debounce.f.value.data),
                button.long_ms.eq(self._long.f.value.data),
                button.extra_long_ms.eq(self._extra_long.f.value.data),
                levels.pressed.r_data[n].eq(button.pressed), levels.pins.r_data[n].eq(pin),
                events.released.set[n].eq(button.released),
                events.lost.set[n].eq(button.released & events.released.data[n]),
                self._press[n].f.duration.r_data.eq(duration), self._press[n].f.length.r_data.eq(length),
                self._time[n].f.value.r_data.eq(time),
            ]
            with m.If(button.released):
                m.d.sync += [duration.eq(button.duration_ms), length.eq(button.length), time.eq(self.count)]
        return m
