# SPDX-License-Identifier: BSD-2-Clause
"""A mechanical contact, and what a debouncer must make of it.

The reference looks at the whole history of a level: a level is believed when it has lasted, without a break, for a
number of strobes.  No counter that runs along.
"""

__all__ = ["bounces", "expected"]


def bounces(rng, level, count, longest):
    """``[(clocks, level)]`` of a contact on its way to ``level``: at most ``count`` bounces of at most ``longest``."""
    result = []
    for _ in range(rng.randrange(count + 1)):
        result += [(rng.randint(1, longest), level), (rng.randint(1, longest), 1 - level)]
    return result


def expected(levels, strobes, periods):
    """Debounced level on every clock, and one more.  ``levels`` and ``strobes`` are one element for each clock."""
    shown = [0]
    for now, level in enumerate(levels):
        change = False
        if level != shown[-1] and strobes[now]:
            # The run of this level up to now, as far back as it differs from what is shown.
            begin = now
            while begin > 0 and levels[begin - 1] == level and shown[begin - 1] != level:
                begin -= 1
            change = sum(strobes[begin:now + 1]) >= max(periods, 1)
        shown.append(level if change else shown[-1])
    return shown
