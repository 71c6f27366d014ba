# SPDX-License-Identifier: BSD-2-Clause
"""soc/generate.py: what is generated says what the design is, and says it the same every time."""

import json
import os
import re
import subprocess
import sys

import pytest
from amaranth import Module, signed
from amaranth.hdl import Fragment
from amaranth.lib import wiring
from amaranth.lib.wiring import In

from rtl.registers import Field, Register, RegisterBank, action, csr
from soc import generate, header, manual
from tb import toolchain

BASE = 0x40000000


class Sample(wiring.Component):
    """A block with registers of every kind.  Not shown: this sentence.

    Nor this.
    """

    class Setting(Register, access="rw"):
        """Two settings."""
        low: Field(action.RW, 5, init=9, unit="clocks", doc="A number.")
        level: Field(action.RW, signed(9), init=-3, doc="""A signed
            number.""")

    class Offset(Register, access="rw"):
        """One signed number."""
        value: Field(action.RW, signed(13), unit="counts", doc="Of an axis.")

    class Position(Register, access="r"):
        """One signed word."""
        value: Field(action.R, signed(32), unit="counts", doc="A position.")

    class Event(Register, access="rw"):
        """Events."""
        first: Field(action.RW1C, 1, doc="Set by hardware.")
        second: Field(action.RW1C, 1, init=1, doc="Set | by hardware.")

    class Command(Register, access="w"):
        """Commands."""
        go: Field(action.W, 1, doc="Go.")

    def __init__(self):
        self.registers = RegisterBank(addr_width=4)
        self.registers.add(self.Setting, offset=0x00)
        self.registers.add(self.Event, offset=0x04)
        for n in range(3):
            self.registers.add(self.Offset, offset=0x10 + 4 * n, name=f"offset{n}")
        self.registers.add(self.Position, offset=0x20)
        self.registers.add(self.Command, offset=0x30)
        memory_map = self.registers.finish()
        super().__init__({"bus": In(self.registers.bus_signature)})
        self.bus.memory_map = memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self.registers
        return m


def used(component):
    """The same component, elaborated: Amaranth complains of those that nobody builds."""
    Fragment.get(component, platform=None)
    return component


def blocks_of(*names, spacing=0x40):
    decoder = csr.Decoder(addr_width=10, data_width=32)
    for n, name in enumerate(names):
        decoder.add(used(Sample()).bus, name=name, addr=n * spacing // 4)
    return generate.collect(used(decoder).bus.memory_map, dict.fromkeys(names, Sample.__doc__), base=BASE)


@pytest.fixture(scope="module")
def block():
    (block,) = blocks_of("sample")
    return block


def register(block, name):
    (result,) = [r for r in block.registers if r.name == name]
    return result


def test_positions_signs_access_and_resets(block):
    assert block.address == BASE and block.doc == "A block with registers of every kind. Not shown: this sentence."
    assert [(r.name, r.offset, r.access) for r in block.registers] == [
        ("setting", 0x00, "rw"), ("event", 0x04, "rw"), ("offset0", 0x10, "rw"), ("offset1", 0x14, "rw"),
        ("offset2", 0x18, "rw"), ("position", 0x20, "r"), ("command", 0x30, "w")]
    low, level = register(block, "setting").fields
    assert (low.shift, low.width, low.signed, low.access, low.reset, low.unit) == (0, 5, False, "RW", 9, "clocks")
    assert (level.shift, level.width, level.signed, level.reset, level.mask) == (5, 9, True, -3, 0x3fe0)
    assert level.doc == "A signed number."
    assert [(f.access, f.reset) for f in register(block, "event").fields] == [("RW1C", 0), ("RW1C", 1)]
    assert [(f.access, f.reset) for f in register(block, "position").fields] == [("R", None)]
    assert [(f.access, f.reset) for f in register(block, "command").fields] == [("W", None)]


def test_equal_blocks_with_a_number_become_one():
    other, numbered = blocks_of("other", "sample0", "sample1", "sample2")
    assert (other.name, other.count) == ("other", 1)
    assert (numbered.name, numbered.count, numbered.stride, numbered.address) == ("sample", 3, 0x40, BASE + 0x40)


@pytest.mark.parametrize("names", [("sample1", "sample2"), ("sample0", "sample2")])
def test_numbered_blocks_must_start_at_0_and_leave_none_out(names):
    with pytest.raises(ValueError, match="numbered from 0"):
        blocks_of(*names)


def test_a_field_without_description_fails_the_build():
    class Bare(csr.Register, access="r"):
        value: csr.Field(csr.action.R, 1)
    with pytest.raises(ValueError, match="bare"):
        generate.collect_register(used(Bare()), "bare", 0)

    class Blank(Register, access="r"):
        """A register."""
        value: Field(action.R, 1, doc=" ")
    with pytest.raises(ValueError, match="blank.value"):
        generate.collect_register(used(Blank()), "blank", 0)


def test_a_name_generated_twice_fails_the_build(block):
    with pytest.raises(ValueError, match="REG_SAMPLE_SETTING"):
        header.render_header([block, block], {}, {})


def test_the_manual_shows_every_register_and_field(block):
    page = manual.render_manual([block], {"tick": 0}, [])
    assert "`0x40000010`. One signed number." in page
    assert "| 13:5 | `level` | RW | s9 | -3 |  | A signed number. |" in page
    assert "| 1 | `second` | RW1C | u1 | 1 |  | Set \\| by hardware. |" in page
    assert "| 31:0 | `value` | R | s32 | – | counts | A position. |" in page


MMIO = """
#include <stdint.h>
extern uint32_t words[64];
extern unsigned reads, writes;
static inline uint32_t mmio_read32(uintptr_t address) { reads++; return words[(address - 0x40000000u) / 4]; }
static inline void mmio_write32(uintptr_t address, uint32_t value)
{
    writes++;
    words[(address - 0x40000000u) / 4] = value;
}
"""

PROGRAM = """
#include <stdio.h>
#include "regs.h"
uint32_t words[64];
unsigned reads, writes;
#define SHOW(expression) printf("%lld\\n", (long long)(expression))
int main(void)
{
    words[0] = 0xffffffe0u | 17; SHOW(sample_setting_low_get(0)); SHOW(sample_setting_level_get(0));
    words[0] = 255u << 5; SHOW(sample_setting_level_get(0));
    words[4] = 0x1fffu; SHOW(sample_offset0_read(0));
    words[4] = 0x1000u; SHOW(sample_offset0_read(0));
    words[4] = 0xffff0fffu; SHOW(sample_offset0_read(0));
    words[8] = 0x80000000u; SHOW(sample_position_read(0));
    words[16 + 6] = 5; SHOW(sample_offset_read(1, 2));
    SHOW(reads);
    sample_offset_write(1, 1, -2); SHOW(words[16 + 5]);
    sample_offset2_write(0, -4096); SHOW(words[6]);
    sample_command_write(1, 3); SHOW(words[16 + 12]);
    sample_event_write(0, REG_SAMPLE_EVENT_SECOND_MASK); SHOW(words[1]);
    SHOW(writes);
    SHOW(REG_SAMPLE_SETTING_LEVEL_MASK); SHOW(REG_SAMPLE_SETTING_LEVEL_SHIFT); SHOW(REG_SAMPLE_SETTING_LEVEL_WIDTH);
    SHOW(REG_SAMPLE_POSITION); SHOW(REG_SAMPLE_STRIDE); SHOW(INTERRUPT_TICK);
    return 0;
}
"""

SHOWN = [17, -1, 255, -1, -4096, 4095, -(1 << 31), 5, 8,
         0x1ffe, 0x1000, 1, 2, 4,
         0x3fe0, 5, 9, BASE + 0x20, 0x40, 7]


def test_accessors_read_and_write_what_the_layout_says(tmp_path):
    (tmp_path / "hal").mkdir()
    (tmp_path / "hal" / "mmio.h").write_text(MMIO)
    (tmp_path / "regs.h").write_text(header.render_header(blocks_of("sample0", "sample1"), {}, {"tick": 7}))
    (tmp_path / "program.c").write_text(PROGRAM)
    toolchain.run(["gcc", "-std=c11", "-Wall", "-Wextra", "-Wconversion", "-Wsign-conversion", "-Werror",
                   "-fsanitize=undefined", "-fno-sanitize-recover", f"-I{tmp_path}", "-o", tmp_path / "program",
                   tmp_path / "program.c"])
    assert list(map(int, toolchain.run([tmp_path / "program"]).split())) == SHOWN


def test_the_header_of_the_design_compiles_and_names_the_contract(tmp_path):
    (tmp_path / "hal").mkdir()
    (tmp_path / "hal" / "mmio.h").write_text(MMIO)
    text = generate.files()["build/generated/regs.h"]
    (tmp_path / "regs.h").write_text(text)
    (tmp_path / "program.c").write_text('#include "regs.h"\nuint32_t words[64];\nunsigned reads, writes;\n')
    toolchain.run(["gcc", "-std=c11", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-c", f"-I{tmp_path}",
                   "-o", tmp_path / "program.o", tmp_path / "program.c"])
    for name in ("snapshot_tick_position_read(unsigned i)", "pwm_duty_write(unsigned i, int32_t value)",
                 "quadrature_index_position_read(unsigned n)", "compare_control_write(uint32_t value)",
                 "INTERRUPT_LINE 3u", "REG_MAGIC 1096966757u"):
        assert name in text


def test_addresses_of_the_design_match_its_table():
    from soc.top import PERIPHERALS
    blocks = json.loads(generate.files()["build/generated/registers.json"])["blocks"]
    starts = {b["name"] + (str(n) if b["count"] > 1 else ""): b["address"] + n * b["stride"]
              for b in blocks for n in range(b["count"])}
    assert starts == {p.name: p.address for p in PERIPHERALS}
    hot = [b for b in blocks if b["name"] in ("snapshot", "pwm", "compare", "divider", "router", "quadrature")]
    assert len(hot) == 6 and all(b["address"] >= 0xfffff800 for b in hot)


def test_the_output_depends_on_the_design_alone():
    script = "import sys; from soc import generate, verilog; " \
             "print(generate.files(), verilog.build_id())"
    outputs = {subprocess.run([sys.executable, "-c", script], cwd=toolchain.ROOT, check=True, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                              env={**os.environ, "PYTHONHASHSEED": seed}).stdout for seed in ("1", "2")}
    assert len(outputs) == 1


def test_linker_memory_holds_the_regions_of_the_design():
    text = generate.files()["build/generated/memory.ld"]
    assert re.findall(r"(\w+) \((\w+)\) : ORIGIN = (\w+), LENGTH = (\w+)", text) == [
        ("boot", "rx", "0x00000000", "0x8000"), ("ram", "rwx", "0x00020000", "0x40000")]


def test_the_committed_page_is_of_this_design():
    assert (toolchain.ROOT / "docs" / "registers.md").read_text() == generate.files()["docs/registers.md"]
