# SPDX-License-Identifier: BSD-2-Clause
"""``python -m soc.generate``: everything that must agree with the gateware, written from the design object.

============================== ==========================================================================
``build/generated/regs.h``      C accessors, for ``firmware/hal``
``build/generated/memory.ld``   linker memory
``build/generated/registers.json``  the same map for tools
``docs/registers.md``           the register page of the manual (committed)
============================== ==========================================================================

The output depends on the design alone: no dates, no machine, stable order.
"""

import argparse
import json
import re
from dataclasses import dataclass
from functools import cache
from itertools import groupby
from pathlib import Path

from amaranth.hdl import Fragment

from rtl.decisions import BATCHES
from rtl.identity import MAGIC, MAP_VERSION
from rtl.line import LINE_LATENCY
from rtl.pwm import PERIOD_CLOCKS
from rtl.quadrature import DECODER_LATENCY
from rtl.registers import Field, Register
from rtl.router import ROUTER_LATENCY
from rtl.serial import FIFO_BYTES
from rtl.trigger import RECORDS
from rtl.watchdog import KICK_WORD, RESET_WORD
from soc import top
from soc.header import render_header
from soc.manual import render_manual

__all__ = ["BlockMap", "FieldMap", "RegisterMap", "collect", "design", "files"]

STORED = ("RW", "RW1C")


@dataclass(frozen=True)
class FieldMap:
    """One field: where it lies and what it means.  ``reset`` is None where hardware drives the value."""
    name: str
    shift: int
    width: int
    signed: bool
    access: str
    reset: object
    unit: str
    doc: str

    @property
    def mask(self):
        return ((1 << self.width) - 1) << self.shift


@dataclass(frozen=True)
class RegisterMap:
    """One register.  ``offset`` in bytes from the start of its block; ``access`` is r, w or rw."""
    name: str
    offset: int
    access: str
    doc: str
    fields: tuple


@dataclass(frozen=True)
class BlockMap:
    """A block, or several equal ones ``stride`` bytes apart (``count`` > 1; their names are numbered)."""
    name: str
    address: int
    count: int
    stride: int
    doc: str
    registers: tuple


def first_sentence(text):
    """The first paragraph of a docstring on one line, without the marks of reStructuredText."""
    paragraph = re.sub(r"\s+", " ", (text or "").strip().split("\n\n")[0])
    return re.sub(r":\w+:`~?([^`]*)`", r"\1", paragraph).replace("``", "")


def collect_register(register, name, offset):
    """Describe an instance of :class:`rtl.registers.Register`."""
    if not isinstance(register, Register):
        raise ValueError(f"register {name} is not an rtl.registers.Register")
    fields = []
    for field_name, field, shift in type(register).layout():
        if not isinstance(field, Field) or not field.doc.strip():
            raise ValueError(f"field {name}.{field_name} has no description")
        kind = field.action_cls.__name__
        if kind not in ("R", "W", *STORED):
            kind = "RW"
        fields.append(FieldMap(
            name=field_name, shift=shift, width=field.shape.width, signed=field.shape.signed, access=kind,
            reset=field.init if kind in STORED and field.action_cls.__name__ in STORED else None,
            unit=field.unit, doc=re.sub(r"\s+", " ", field.doc.strip())))
    return RegisterMap(name=name, offset=offset, access=register.element.access.value,
                       doc=first_sentence(type(register).__doc__), fields=tuple(fields))


def collect(memory_map, docs, *, base):
    """Walk a CSR memory map at byte address ``base``; ``docs`` gives each block's docstring by name.

    Blocks named alike but for a number at the end, with equal registers, become one numbered block.
    """
    blocks = []
    for window, (name,), (start, _end, _ratio) in memory_map.windows():
        registers = tuple(collect_register(register, "_".join(map(str, path)), 4 * first)
                          for register, path, (first, _last) in window.resources())
        blocks.append(BlockMap(name=name, address=base + 4 * start, count=1, stride=0,
                               doc=first_sentence(docs[name]), registers=registers))
    blocks.sort(key=lambda block: block.address)

    merged = []
    for (stem, _registers), group in groupby(blocks, key=lambda b: (re.sub(r"\d+$", "", b.name), b.registers)):
        group = list(group)
        first = group[0]
        if len(group) > 1:
            stride = group[1].address - first.address
            expected = [(f"{stem}{n}", first.address + n * stride) for n in range(len(group))]
            if [(b.name, b.address) for b in group] != expected:
                raise ValueError(f"the blocks {stem}* must be numbered from 0 and equally spaced")
            first = BlockMap(name=stem, address=first.address, count=len(group), stride=stride, doc=first.doc,
                             registers=first.registers)
        merged.append(first)
    return merged


def render_memory(regions):
    """Linker memory."""
    lines = [f"  {r.name} ({'rwx' if r.writable else 'rx'}) : ORIGIN = {r.address:#010x}, LENGTH = {r.size:#x}"
             for r in regions]
    return "\n".join(["/* Generated from the design by soc/generate.py. */", "MEMORY", "{", *lines, "}", ""])


def render_json(blocks, constants, interrupts):
    def plain(item):
        result = dict(vars(item))
        for key in ("registers", "fields"):
            if key in result:
                result[key] = [plain(child) for child in result[key]]
        return result
    return json.dumps({"constants": constants, "interrupts": interrupts, "blocks": [plain(b) for b in blocks]},
                      indent=1) + "\n"


@cache
def design():
    """The design that is described; one object for the whole process."""
    result = top.Abbe()
    # Elaborated for nothing but Amaranth's peace: it complains of components that nobody builds.
    Fragment.get(result, platform=None)
    return result


def files():
    """``{path below the root: text}`` of everything generated."""
    docs = {p.name: (p.registers or p.make).__doc__ for p in top.PERIPHERALS}
    blocks = collect(design().register_map, docs, base=top.REGISTERS)
    interrupts = dict(sorted((p.interrupt for p in top.PERIPHERALS if p.interrupt), key=lambda i: i[1]))
    constants = {"REG_MAGIC": MAGIC, "REG_MAP_VERSION": MAP_VERSION, "CLOCK_HZ": top.CLOCK_HZ,
                 "FAST_CLOCK_HZ": top.FAST_CLOCK_HZ, "DECODER_LATENCY": DECODER_LATENCY,
                 "LINE_LATENCY": LINE_LATENCY, "ROUTER_LATENCY": ROUTER_LATENCY,
                 "PWM_PERIOD_CLOCKS": PERIOD_CLOCKS, "SERIAL_FIFO_BYTES": FIFO_BYTES, "CLASSIFIER_BATCHES": BATCHES,
                 "TRIGGER_RECORDS": RECORDS, "WATCHDOG_KICK_WORD": KICK_WORD, "WATCHDOG_RESET_WORD": RESET_WORD}
    return {
        "build/generated/regs.h": render_header(blocks, constants, interrupts),
        "build/generated/memory.ld": render_memory(top.REGIONS),
        "build/generated/registers.json": render_json(blocks, constants, interrupts),
        "docs/registers.md": render_manual(blocks, interrupts, top.REGIONS),
    }


def main():
    root = Path(__file__).resolve().parent.parent
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=root / "build", help="build directory")
    parser.add_argument("--check", action="store_true",
                        help="write nothing; fail if the committed page differs from the design")
    arguments = parser.parse_args()
    for name, text in files().items():
        path = arguments.out / name.removeprefix("build/") if name.startswith("build/") else root / name
        old = path.read_text() if path.exists() else None
        if old == text:
            continue
        if not arguments.check:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        elif not name.startswith("build/"):
            raise SystemExit(f"{name} is not of this design: run python -m soc.generate")


if __name__ == "__main__":
    main()
