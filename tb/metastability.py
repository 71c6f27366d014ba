# SPDX-License-Identifier: BSD-2-Clause
"""A platform whose synchronisers resolve late at random, as real ones do.

A flip-flop that samples a moving input settles to the old or to the new value; seen from outside, the change
arrives now or one clock later.  With ``RandomDelayPlatform`` every :class:`FFSynchronizer` bit does either,
chosen by its own 16-bit LFSR, so one simulation run meets every combination of early and late crossings.
"""

from amaranth import Cat, Module, Mux, Signal


class RandomDelayPlatform:
    """Pass as ``platform`` when elaborating.  ``seed`` selects the sequence of delays."""

    def __init__(self, seed=1):
        self._seed = seed

    def get_ff_sync(self, ff):
        m = Module()
        domain = ff._o_domain
        stages = [Signal(ff.i.shape(), name=f"stage{n}", init=ff._init, reset_less=True)
                  for n in range(ff._stages)]
        previous = Signal(ff.i.shape(), init=ff._init, reset_less=True)
        for index, (bit, last) in enumerate(zip(stages[0], previous)):
            self._seed = self._seed * 1103515245 + 12345 & 0x7fffffff
            lfsr = Signal(16, name=f"lfsr{index}", init=(self._seed >> 8) & 0xffff or 1, reset_less=True)
            m.d[domain] += lfsr.eq(Cat(lfsr[15] ^ lfsr[14] ^ lfsr[12] ^ lfsr[3], lfsr[:15]))
            # The first flip-flop catches this clock's input, or still the one of the clock before.
            late = lfsr[0] & lfsr[5]
            source = ff.i[index] if len(ff.i) > 1 else ff.i
            m.d[domain] += [last.eq(source), bit.eq(Mux(late, last, source))]
        for i, o in zip(stages, stages[1:]):
            m.d[domain] += o.eq(i)
        m.d.comb += ff.o.eq(stages[-1])
        return m
