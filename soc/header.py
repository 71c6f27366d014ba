# SPDX-License-Identifier: BSD-2-Clause
"""The C header: one inline function per access, a single load or store on the target."""

import re
from collections import Counter
from itertools import groupby

__all__ = ["render_header"]

HEAD = """\
/* Generated from the design by soc/generate.py. */
#ifndef ABBE_REGS_H
#define ABBE_REGS_H

#include <stdint.h>

#include "hal/mmio.h"
"""


def runs(registers):
    """``[(stem, registers)]`` of the registers numbered 0, 1, ... with equal fields at equal distances."""
    result = []
    for stem, group in groupby(registers, key=lambda r: re.sub(r"\d+$", "", r.name)):
        group = list(group)
        stride = group[1].offset - group[0].offset if len(group) > 1 else 0
        if stride and all(r.name == f"{stem}{n}" and r.offset == group[0].offset + n * stride
                          and (r.access, r.fields) == (group[0].access, group[0].fields)
                          for n, r in enumerate(group)):
            result.append((stem, group))
    return result


def whole(register):
    """The field that is the whole value of the register, or None if the register has several."""
    return register.fields[0] if len(register.fields) == 1 else None


def c_type(field):
    return "int32_t" if field is not None and field.signed else "uint32_t"


def decoded(raw, field):
    """C expression for a field's value, sign-extended, out of the register value ``raw``."""
    if field.shift:
        raw = f"({raw} >> {field.shift})"
    if field.width < 32:
        raw = f"({raw} & {(1 << field.width) - 1:#x}u)"
    if not field.signed:
        return raw
    sign = 1 << (field.width - 1)
    return f"(int32_t)(({raw} ^ {sign:#x}u) - {sign:#x}u)" if field.width < 32 else f"(int32_t){raw}"


def accessors(prefix, address, arguments, register):
    """Inline functions for one register whose address is the C expression ``address``."""
    field = whole(register)
    read_arguments = ", ".join(arguments) or "void"
    if "r" in register.access:
        raw = f"mmio_read32({address})"
        value = decoded(raw, field) if field else raw
        yield f"static inline {c_type(field)} {prefix}_read({read_arguments})\n{{\n    return {value};\n}}\n"
        if not field:
            for part in register.fields:
                if part.access != "W":
                    yield (f"static inline {c_type(part)} {prefix}_{part.name}_get({read_arguments})\n"
                           f"{{\n    return {decoded(raw, part)};\n}}\n")
    if "w" in register.access:
        value = "(uint32_t)value" if field and field.signed else "value"
        if field and field.width < 32:
            value = f"{value} & {field.mask:#x}u"
        write_arguments = ", ".join([*arguments, f"{c_type(field)} value"])
        yield (f"static inline void {prefix}_write({write_arguments})\n"
               f"{{\n    mmio_write32({address}, {value});\n}}\n")


def block_lines(block):
    """Everything about one block."""
    yield f"/* {block.name}: {block.doc} */\n"
    macro = f"REG_{block.name}".upper()
    if block.count > 1:
        yield f"#define {macro}_COUNT {block.count}u"
        yield f"#define {macro}_STRIDE {block.stride:#x}u"
    numbered = ["unsigned n"] if block.count > 1 else []
    functions = []
    for register in block.registers:
        name = f"{macro}_{register.name}".upper()
        yield f"#define {name} {block.address + register.offset:#010x}u"
        for field in register.fields:
            yield f"#define {name}_{field.name.upper()}_SHIFT {field.shift}u"
            yield f"#define {name}_{field.name.upper()}_WIDTH {field.width}u"
            yield f"#define {name}_{field.name.upper()}_MASK {field.mask:#010x}u"
            if field.reset is not None:
                yield f"#define {name}_{field.name.upper()}_RESET {field.reset & (1 << field.width) - 1:#x}u"
        address = f"{name} + n * {macro}_STRIDE" if numbered else name
        functions += [f"/* {register.doc} */",
                      *accessors(f"{block.name}_{register.name}", address, numbered, register)]
    for stem, group in runs(block.registers):
        first = group[0]
        name = f"{macro}_{stem}".upper()
        yield f"#define {name}_COUNT {len(group)}u"
        yield f"#define {name}_STRIDE {group[1].offset - first.offset:#x}u"
        address = f"{macro}_{first.name}".upper() + (f" + n * {macro}_STRIDE" if numbered else "")
        functions += [f"/* {first.name} to {group[-1].name} by number. */",
                      *accessors(f"{block.name}_{stem}", f"{address} + i * {name}_STRIDE",
                                 [*numbered, "unsigned i"], first)]
    yield ""
    yield from functions


def render_header(blocks, constants, interrupts):
    """Text of ``regs.h`` (names: see ``docs/registers.md``)."""
    lines = [HEAD]
    lines += [f"#define {name} {value}u" for name, value in constants.items()]
    lines += ["", "/* Interrupt lines: bits of the processor's mask (CSR 0xbc0) and pending (CSR 0xfc0) words. */"]
    lines += [f"#define INTERRUPT_{name.upper()} {line}u" for name, line in interrupts.items()]
    for block in blocks:
        lines += ["", *block_lines(block)]
    names = Counter(re.findall(r"^(?:#define|static inline \w+) (\w+)", "\n".join(lines), re.MULTILINE))
    twice = [name for name, count in names.items() if count > 1]
    if twice:
        raise ValueError(f"generated twice: {', '.join(twice)}")
    return "\n".join([*lines, "#endif", ""])
