# SPDX-License-Identifier: BSD-2-Clause
"""Registers with a description and a unit: the one place that knows the habits of amaranth-soc.

A block writes each register once, as a nested class whose docstring says what it is and whose annotated
fields say their access, shape, unit and meaning::

    class Width(Register, access="rw"):
        \"\"\"Length of a pulse.\"\"\"
        value: Field(action.RW, 24, unit="fast clocks", doc="Taken at the next pulse.")

and collects them in a :class:`RegisterBank`.  Headers, linker scripts and manual pages are generated from
these classes by :mod:`soc.generate`; nobody types an offset or a description twice.

amaranth-soc is installed inside luna-soc only (the PyPI package of its own name is an empty placeholder), so
this module finds it there without importing luna-soc itself.
"""

import importlib.util
import os
import re
import sys

if importlib.util.find_spec("amaranth_soc") is None:
    _luna_soc = importlib.util.find_spec("luna_soc").submodule_search_locations[0]
    sys.path.append(os.path.join(_luna_soc, "gateware", "vendor"))

from amaranth import Module, Shape
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped
from amaranth_soc import csr
from amaranth_soc.csr import action

__all__ = ["BUS_WIDTH", "Field", "FifoPort", "Register", "RegisterBank", "action", "csr", "snake_case"]

BUS_WIDTH = 32
"""Bits of every register access.  The bus knows no narrower access."""


def snake_case(name):
    """``CapWords`` to ``cap_words``; digits stay with the word before them (``Duty0`` to ``duty0``)."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


class Field(csr.Field):
    """A field of a register.

    Parameters
    ----------
    action_cls : :class:`csr.FieldAction`
        ``action.R`` (hardware drives ``r_data``), ``action.W`` (write strobe and data for one clock),
        ``action.RW`` (storage) or ``action.RW1C`` (event: hardware sets, a written 1 clears, a set wins).
    shape : shape-like
        Width and sign.  At most 32 bits.
    unit : str
        Unit of the number; empty for flags and codes.
    doc : str
        What the field means, in the words of the manual.  Required.
    """

    def __init__(self, action_cls, shape, *, unit="", doc, **kwargs):
        if not doc:
            raise ValueError("a register field needs a description")
        if Shape.cast(shape).width > BUS_WIDTH:
            raise ValueError(f"a register field has at most {BUS_WIDTH} bits, not {shape!r}")
        super().__init__(action_cls, shape, **kwargs)
        self.shape, self.unit, self.doc = Shape.cast(shape), unit, doc
        self.action_cls, self.init = action_cls, kwargs.get("init", 0)


class FifoPort(csr.FieldAction):
    """A field whose read takes a value from one FIFO and whose write puts one into another."""

    def __init__(self, shape):
        super().__init__(shape, access="rw", members={
            "r_data": In(shape), "r_stb": Out(1), "w_data": Out(shape), "w_stb": Out(1),
        })

    def elaborate(self, platform):
        m = Module()
        m.d.comb += [
            self.port.r_data.eq(self.r_data), self.r_stb.eq(self.port.r_stb),
            self.w_data.eq(self.port.w_data), self.w_stb.eq(self.port.w_stb),
        ]
        return m


class Register(csr.Register):
    """A register of at most 32 bits; fields lie from bit 0 upward in the order they are written."""

    def __init_subclass__(cls, *, access=None, **kwargs):
        if not cls.__doc__:
            raise ValueError(f"register {cls.__qualname__} needs a docstring")
        super().__init_subclass__(access=access, **kwargs)

    def __init__(self):
        super().__init__()
        if self.element.width > BUS_WIDTH:
            raise ValueError(f"register {type(self).__qualname__} has {self.element.width} bits, "
                             f"at most {BUS_WIDTH} fit")

    @classmethod
    def layout(cls):
        """``[(name, field, first bit)]`` in bit order: what the generators read."""
        result, bit = [], 0
        for name, field in cls.__annotations__.items():
            result.append((name, field, bit))
            bit += field.shape.width
        return result


class RegisterBank(wiring.Component):
    """The registers of one block behind its ``bus``.

    A read is answered one ``sync`` clock after ``r_stb``; a write takes effect on the clock after ``w_stb``.

    Parameters
    ----------
    addr_width : int
        Address bits, in 32-bit words: the block occupies ``4 << addr_width`` bytes.
    """

    def __init__(self, *, addr_width):
        self._builder = csr.Builder(addr_width=addr_width, data_width=BUS_WIDTH, granularity=8)
        self._signature = csr.Signature(addr_width=addr_width, data_width=BUS_WIDTH)
        self._bridge = None
        super().__init__({"bus": wiring.In(self._signature)})

    def add(self, register, *, offset, name=None):
        """Add an instance of a register class at a byte ``offset``; returns the instance."""
        instance = register() if isinstance(register, type) else register
        return self._builder.add(name or snake_case(type(instance).__name__), instance, offset=offset)

    @property
    def bus_signature(self):
        return self._signature

    def finish(self):
        """Close the bank and return its memory map (set it as ``self.bus.memory_map`` of the block)."""
        self._bridge = csr.Bridge(self._builder.as_memory_map())
        self.bus.memory_map = self._bridge.bus.memory_map
        return self.bus.memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.bridge = self._bridge
        connect(m, flipped(self.bus), self._bridge.bus)
        return m
