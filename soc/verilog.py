# SPDX-License-Identifier: BSD-2-Clause
"""``python -m soc.verilog``: the controller as one Verilog file, ``build/soc/abbe.v``, top ``abbe``.

Flattened and optimised, which simulates twice as fast as the hierarchy.  The memory arrays stay modules of
their own (:mod:`soc.memory`), loaded at the start of a simulation by ``+boot=<hex>`` and ``+firmware=<hex>``,
so that new firmware needs no new build.
"""

import argparse
from pathlib import Path

from soc import cpu, memory
from soc.top import Abbe
from tb import toolchain

__all__ = ["build_id", "write"]


def _sources(**parameters):
    return toolchain.to_rtlil(Abbe(**parameters), name="abbe"), cpu.netlist(), memory.VERILOG.read_text()


def build_id():
    """32 bits that name the design: the start of a SHA-256 over its RTLIL (with build id 0), the processor's
    netlist and the memory."""
    return int(toolchain.content_key(*_sources())[:8], 16)


def write(directory):
    """Write ``abbe.v`` into ``directory`` unless the one there is of this design.  Returns its path."""
    directory = Path(directory)
    with toolchain.exclusive(directory / "lock"):
        return _write(directory, *_sources(build_id=build_id()))


def _write(directory, design, processor, array):
    result, stamp = directory / "abbe.v", directory / "abbe.key"
    key = toolchain.content_key(design, processor, array, SCRIPT)
    if result.exists() and stamp.exists() and stamp.read_text() == key:
        return result
    stamp.unlink(missing_ok=True)
    for name, text in ("abbe.il", design), ("cpu.v", processor), ("memory.v", array):
        (directory / name).write_text(text)
    toolchain.yosys(SCRIPT, cwd=directory)
    flat = (directory / "flat.v").read_text()
    # The processor is a separate work under the MIT licence; say so where its logic ends up.
    header = ("// Generated from the design of Abbe (BSD-2-Clause); contains VexRiscv, Copyright (c) 2016 "
              "Spinal HDL contributors (MIT).\n")
    result.write_text(header + flat + array)
    stamp.write_text(key)
    return result


SCRIPT = ("read_rtlil abbe.il; read_verilog cpu.v; read_verilog -lib -sv memory.v; hierarchy -check -top abbe; "
          "proc; flatten; opt -full; memory_collect; opt_clean -purge; "
          "write_verilog -norename -noattr flat.v")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=toolchain.BUILD, help="build directory")
    print(write(parser.parse_args().out / "soc"))


if __name__ == "__main__":
    main()
