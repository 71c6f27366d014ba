# SPDX-License-Identifier: BSD-2-Clause
"""The register page of the manual."""

__all__ = ["render_manual"]

HEAD = """\
# Registers

Generated from the design by `python -m soc.generate`; do not edit.

Registers are 32 bits wide and take whole-word accesses only: a narrower access, or one to an address without a
register, is refused. A refused load traps (load access fault); a refused store is lost, kept in the block `bus`,
and interrupts. Every access takes 2 clocks on the bus.

Access: **R** read; **W** write (reads as 0); **RW** both; **RW1C** an event that hardware sets and a written 1
clears; when both happen at once it stays set. Reads have no side effect unless a register says so. Bits not listed
read as 0 and ignore writes. Reset is the value after reset; a dash means that hardware drives it.

In C, register `Register` of block `block` is read and written by `block_register_read()` and
`block_register_write(value)`; a field of a register of several is read by `block_register_field_get()`, and
composed from `REG_BLOCK_REGISTER_FIELD_MASK` and `_SHIFT`. Numbered blocks take their number as first argument;
registers numbered `Name0`, `Name1`, ... have an accessor by number besides: `block_name_read(i)`.
"""


def title(name):
    """``tick_position0`` to ``TickPosition0``: as the register's class is named in the gateware."""
    return "".join(part[:1].upper() + part[1:] for part in name.split("_"))


def bits(field):
    return f"{field.shift}" if field.width == 1 else f"{field.shift + field.width - 1}:{field.shift}"


def kind(field):
    return ("s" if field.signed else "u") + str(field.width)


def reset(field):
    if field.reset is None:
        return "–"
    return str(field.reset)


def cell(text):
    return text.replace("|", "\\|")


def render_manual(blocks, interrupts, regions):
    """Markdown text of ``docs/registers.md``."""
    lines = [HEAD, "## Memory map", "", "| Address | Size | What | Processor may |", "|---|---|---|---|"]
    for region in regions:
        lines.append(f"| `{region.address:#010x}` | {region.size >> 10} KiB | {region.name} | "
                     f"{'read, write' if region.writable else 'read'}, execute; cached |")
    for block in blocks:
        name = block.name if block.count == 1 else f"{block.name}0…{block.count - 1}"
        step = "" if block.count == 1 else f", {block.stride} bytes apart"
        lines.append(f"| `{block.address:#010x}`{step} | | [{name}](#{block.name}) | "
                     "read, write; registers, not cached |")
    lines += ["", "## Interrupts", "", "| Line | Name |", "|---|---|"]
    lines += [f"| {line} | {name} |" for name, line in interrupts.items()]
    for block in blocks:
        lines += ["", f"## {block.name}", "", cell(block.doc)]
        for register in block.registers:
            address = block.address + register.offset
            more = "" if block.count == 1 else f" + {block.stride}·n"
            lines += ["", f"### {title(register.name)}", "", f"`{address:#010x}`{more}. {cell(register.doc)}", "",
                      "| Bits | Field | Access | Type | Reset | Unit | Meaning |", "|---|---|---|---|---|---|---|"]
            lines += [f"| {bits(f)} | `{f.name}` | {f.access} | {kind(f)} | {reset(f)} | {cell(f.unit)} | "
                      f"{cell(f.doc)} |" for f in register.fields]
    return "\n".join([*lines, ""])
