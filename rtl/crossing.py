# SPDX-License-Identifier: BSD-2-Clause
"""The only ways by which a signal passes from one clock domain to another.

=====================  ===============================  ==================================================
what crosses           use                              what it promises
=====================  ===============================  ==================================================
a level                ``amaranth.lib.cdc``             2 destination clocks (3 when it resolves late)
                       ``.FFSynchronizer``
an event               :class:`StrobeCrossing`          each event arrives, none is invented
settings               :class:`Handover`                the last value handed over arrives, whole
results                :class:`Latch`                   one instant of another domain, whole and still
=====================  ===============================  ==================================================

No pattern relies on the ratio or the phase of the two clocks.  The domains are reset together, for at least 3
clocks of the slower one; reset of one domain alone makes a spurious event.

Names, by which a check of the netlist knows these patterns: the only flip-flops that logic of another domain
may read are called ``cross_toggle`` (read through an FFSynchronizer only) and ``cross_hold`` (still while the
other domain reads it).

Latencies count clock edges.  "The Nth destination edge" counts those after the source edge that takes the
strobe; an edge at the same instant does not count.  Each range assumes nothing about phase; "late" is the
extra clock of a synchroniser's first flip-flop that met its input moving.
"""

from amaranth import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import In, Out

__all__ = ["Handover", "Hold", "Latch", "StrobeCrossing"]


def _check_domains(source, destination):
    for name in (source, destination):
        if not isinstance(name, str) or not name:
            raise ValueError(f"a clock domain is named by a string, not {name!r}")
    if source == destination:
        raise ValueError(f"a crossing needs two clock domains, not {source!r} twice")


class StrobeCrossing(wiring.Component):
    """Carry one-clock strobes from ``source`` to ``destination``; an acknowledge paces them.

    A strobe taken while ``ready`` is 1 gives ``o`` after the 3rd destination edge (4th when late).  ``ready``
    then returns 4 destination clocks and 2 source clocks later, each count rounded up to an edge (5 and 3 when
    late): that is the spacing at which strobes pass without waiting.

    A strobe while ``ready`` is 0 is kept and sent as soon as the one under way is acknowledged; further ones
    before that merge with it.  So every ``i`` is followed by an ``o``, there are never more ``o`` than ``i``,
    and ``ready`` = 1 says that all have arrived and been acted upon.

    Parameters
    ----------
    source, destination : str
        Clock domains; :exc:`ValueError` when equal.

    Members
    -------
    i : In(1), source
        Strobe; any rate.
    ready : Out(1), source
        Nothing is under way and nothing is kept.  1 at reset.
    sent : Out(1), source
        Strobe: at the end of this clock a strobe leaves.  The clock of ``i`` if ``ready``, else later.
    o : Out(1), destination
        One-clock strobe from a flip-flop.  What is done at the end of the clock of ``o`` is finished when
        ``ready`` returns.
    """

    def __init__(self, *, source, destination):
        _check_domains(source, destination)
        self._source, self._destination = source, destination
        self._kept = Signal()               # source: one more waits
        self._seen = Signal()               # destination: the toggle as of the last strobe
        super().__init__({"i": In(1), "ready": Out(1), "sent": Out(1), "o": Out(1)})

    def elaborate(self, platform):
        m = Module()
        there, back = self._destination, self._source

        request = Signal(name="cross_toggle")       # flips for each strobe sent
        acknowledged, idle, kept = Signal(), Signal(), self._kept
        m.d.comb += [
            idle.eq(request == acknowledged),
            self.sent.eq(idle & (self.i | kept)),
            self.ready.eq(idle & ~kept),
        ]
        # A strobe that comes as the kept one leaves takes its place.
        m.d[back] += [
            request.eq(request ^ self.sent),
            kept.eq((idle & kept & self.i) | (~idle & (kept | self.i))),
        ]

        arrived, seen = Signal(), self._seen
        m.submodules.forward = FFSynchronizer(request, arrived, o_domain=there)
        m.d[there] += [seen.eq(arrived), self.o.eq(arrived ^ seen)]

        # The answer leaves at the end of the clock of ``o``, with whatever ``o`` makes happen.
        answer = Signal(name="cross_toggle")
        m.d[there] += answer.eq(seen)
        m.submodules.backward = FFSynchronizer(answer, acknowledged, o_domain=back)
        return m


class Hold(wiring.Component):
    """A register that another domain may read while it is still.

    ``o`` takes ``i`` at the end of a clock with ``take``.  Whoever reads it elsewhere must know, by a
    :class:`StrobeCrossing` or :class:`Latch`, that no ``take`` can come meanwhile.

    Parameters
    ----------
    shape : shape-like
    domain : str
        Clock domain of all members.
    init
        Value of ``o`` at reset.
    """

    def __init__(self, shape, *, domain, init=None):
        self._shape, self._domain, self._init = shape, domain, init
        super().__init__({"i": In(shape), "take": In(1), "o": Out(shape, init=init)})

    def elaborate(self, platform):
        m = Module()
        hold = Signal(self._shape, name="cross_hold", init=self._init)
        with m.If(self.take):
            m.d[self._domain] += hold.eq(self.i)
        m.d.comb += self.o.eq(hold)
        return m


class Handover(wiring.Component):
    """Hand a payload (settings) from ``source`` to ``destination``, whole.

    A request taken while ``ready`` is 1 copies ``payload`` at the end of that clock; ``o`` shows it after the
    4th destination edge (5th when late), with ``o_stb``.  ``ready`` returns as for :class:`StrobeCrossing`.

    A request while ``ready`` is 0 is kept, and ``payload`` copied when the one under way has been acknowledged:
    keep it on ``payload`` until ``ready``.  Payloads replaced before that do not arrive; the last always does.

    Parameters
    ----------
    shape : shape-like
        Of the payload; a structure from :mod:`amaranth.lib.data` will do.
    source, destination : str
        Clock domains; :exc:`ValueError` when equal.
    init
        Value of ``o`` at reset.

    Members
    -------
    payload : In(shape), source
    request : In(1), source
        Strobe: hand ``payload`` over.
    ready : Out(1), source
        Everything requested has arrived at ``o``.
    o : Out(shape), destination
        The last payload that arrived; changes with ``o_stb`` only.
    o_stb : Out(1), destination
        One-clock strobe: ``o`` is new as of this clock.
    """

    def __init__(self, shape, *, source, destination, init=None):
        self._crossing = StrobeCrossing(source=source, destination=destination)
        self._hold = Hold(shape, domain=source, init=init)
        self._destination = destination
        super().__init__({
            "payload": In(shape), "request": In(1), "ready": Out(1),
            "o": Out(shape, init=init), "o_stb": Out(1),
        })

    def elaborate(self, platform):
        m = Module()
        m.submodules.crossing = crossing = self._crossing
        m.submodules.hold = hold = self._hold
        m.d.comb += [
            crossing.i.eq(self.request), self.ready.eq(crossing.ready),
            hold.i.eq(self.payload), hold.take.eq(crossing.sent),
        ]
        # The copy is still from the clock it leaves until the answer is back; it is taken well inside.
        m.d[self._destination] += self.o_stb.eq(crossing.o)
        with m.If(crossing.o):
            m.d[self._destination] += self.o.eq(hold.o)
        return m


class Latch(wiring.Component):
    """Latch a value of the ``source`` domain on request of the ``reader`` domain, and read it there.

    A request taken while ``busy`` is 0 latches ``i`` as it is at the 4th source edge (5th when late).  ``done``
    comes 2 reader clocks after that edge, rounded up to an edge (3 when late).

    A request while ``busy`` is kept: the value is latched anew when the one under way has been acknowledged,
    and ``done`` comes once, for the last.  So what is read at ``done`` was latched after every request.

    Parameters
    ----------
    shape : shape-like
        Of the value; a structure from :mod:`amaranth.lib.data` will do.
    source, reader : str
        Clock domains; :exc:`ValueError` when equal.

    Members
    -------
    i : In(shape), source
        The live value.
    capture : Out(1), source
        One-clock strobe from a flip-flop: ``i`` is latched at the end of this clock.  Values latched elsewhere
        by the same strobe (in a :class:`Hold`) are readable together with ``o``.
    request : In(1), reader
        Strobe.
    busy : Out(1), reader
        From the clock after the request until ``done``.  0 at reset.
    done : Out(1), reader
        One-clock strobe: ``o`` is readable as of this clock.
    o : Out(shape), held in source, for the reader
        The latched value.  Do not read it while ``busy``.  0 at reset.
    """

    def __init__(self, shape, *, source, reader):
        self._crossing = StrobeCrossing(source=reader, destination=source)
        self._hold = Hold(shape, domain=source)
        self._reader = reader
        self._was_busy = Signal()
        super().__init__({
            "i": In(shape), "capture": Out(1),
            "request": In(1), "busy": Out(1), "done": Out(1), "o": Out(shape),
        })

    def elaborate(self, platform):
        m = Module()
        m.submodules.crossing = crossing = self._crossing
        m.submodules.hold = hold = self._hold
        m.d.comb += [
            crossing.i.eq(self.request), self.busy.eq(~crossing.ready),
            self.capture.eq(crossing.o), hold.take.eq(crossing.o),
            hold.i.eq(self.i), self.o.eq(hold.o),
            self.done.eq(self._was_busy & ~self.busy),
        ]
        m.d[self._reader] += self._was_busy.eq(self.busy)
        return m
