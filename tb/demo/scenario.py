# SPDX-License-Identifier: BSD-2-Clause
"""One scan line as a user asks for it, and what must come out of it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from math import floor

from tb.board import plant

AXES = {"x": 0, "y": 1}
# Share of its maximum speed at which an axis can still be controlled.
HEADROOM = 0.95


@dataclass(frozen=True)
class Scenario:
    """The settings, as decimal text where they are sent as such.

    Members
    -------
    n : str
        Counts per pixel, may have a fraction.
    speed : str
        Line speed, mm/s.
    axis : str
        The fast axis, ``x`` or ``y``.
    start, stop : str
        Of the line, mm, user coordinates; start above stop scans in the negative direction.
    mirrored : bool
        Mirror the user coordinates of the fast axis first, as hosts do with ``UM X=-10000 Y=10000``.
    flood : bool
        Send ``W X Y`` without pause while the line is scanned.
    cut_pwm : bool
        Cut the PWM wire of the fast axis half-way along the line: the stage must stop.
    plant : tuple of str
        Overrides of the board model's parameters (:mod:`tb.board.plant`).
    """

    n: str = "24"
    speed: str = "2.64"
    axis: str = "x"
    start: str = "0.0"
    stop: str = "1.0"
    mirrored: bool = False
    flood: bool = False
    cut_pwm: bool = False
    plant: tuple[str, ...] = ()

    def __post_init__(self):
        if self.axis not in AXES:
            raise ValueError(f"expected axis x or y, not {self.axis!r}")
        for name in ("n", "speed", "start", "stop"):
            # As the controller reads it, to which it is sent as it stands.
            if not re.fullmatch(r"-?(\d+\.?\d*|\.\d+)", getattr(self, name)):
                raise ValueError(f"expected a decimal number for {name}, not {getattr(self, name)!r}")
        for override in self.plant:
            try:
                plant.load([override])
            except ValueError as error:
                raise ValueError(str(error) if override in str(error) else f"plant {override}: {error}") from None
        if Fraction(self.n) < 1:
            raise ValueError(f"expected at least 1 count per pixel, not {self.n}")
        if Fraction(self.start) == Fraction(self.stop):
            raise ValueError(f"expected a line with a length, not {self.start} to {self.stop} mm")
        if not 0 < Fraction(self.speed) <= self.maximum_speed_mm_s():
            raise ValueError(f"expected a speed up to {float(self.maximum_speed_mm_s()):g} mm/s on this plant, "
                             f"not {self.speed}")
        lower, upper = self.travel_mm()
        for name in ("start", "stop"):
            if not lower < Fraction(getattr(self, name)) < upper:
                raise ValueError(f"expected a {name} within the stage's travel, {float(lower):g} to {float(upper):g} "
                                 f"mm, not {getattr(self, name)}")
        if not self.pixels():
            raise ValueError(f"expected a line of at least one pixel: {float(self.length_mm()):g} mm are "
                             f"{float(self.length_mm() * self.counts_per_mm()):g} counts, and a pixel is {self.n}")

    def commands(self) -> list[str]:
        """The worked example: what a host sends, in order, up to the start of the scan."""
        roles = "SCAN F=0" if self.axis == "x" else "SCAN X=2 Y=1 Z=0 F=0"
        mirror = ["UM X=-10000 Y=10000" if self.axis == "x" else "UM X=10000 Y=-10000"] if self.mirrored else []
        return [
            *mirror,
            f"SCANR X={self.start} Y={self.stop} Z={self.n}",
            "SCANV X=0.0 Y=1.0 Z=1",
            f"SPEED {self.axis.upper()}={self.speed}",
            roles,
            "TTL X=1",
            "SCAN",
        ]

    def parameters(self) -> dict[str, float]:
        """The plant's, of the fast axis."""
        prefix = f"{self.axis}."
        return {name.removeprefix(prefix): value for name, value in plant.load(self.plant).items()
                if name.startswith(prefix)}

    def counts_per_mm(self) -> Fraction:
        """As the encoder has it; exact, from its decimal text."""
        return Fraction(repr(self.parameters()["counts_per_mm"]))

    def maximum_speed_mm_s(self) -> Fraction:
        """What the plant can be asked for."""
        own = self.parameters()
        return Fraction(own["maximum_speed_mm_per_s"]) * min(1, Fraction(own["speed_scale"]) * Fraction(HEADROOM)
                                                             if own["speed_scale"] < 1 else 1)

    def travel_mm(self) -> tuple[Fraction, Fraction]:
        """Where the limit switches are, in user coordinates: power-up is 0."""
        own = self.parameters()
        ends = [Fraction(own[name]) - Fraction(own["start_counts"]) / self.counts_per_mm()
                for name in ("limit_lower_mm", "limit_upper_mm")]
        return (-ends[1], -ends[0]) if self.mirrored else (ends[0], ends[1])

    def length_mm(self) -> Fraction:
        return abs(Fraction(self.stop) - Fraction(self.start))

    def pixels(self) -> int:
        """floor(K * L / N): what the line must have, from the definition and not from the controller."""
        return floor(self.counts_per_mm() * self.length_mm() / Fraction(self.n))

    def left_over_counts(self) -> Fraction:
        """Counts of the line beyond its last whole pixel."""
        return self.counts_per_mm() * self.length_mm() - self.pixels() * Fraction(self.n)

    def direction(self) -> int:
        """Of the count along the line."""
        rising = Fraction(self.stop) > Fraction(self.start)
        return 1 if rising != self.mirrored else -1

    def start_counts(self) -> int:
        """The count at which SYNC must come: the nearest to the start."""
        counts = Fraction(self.start) * self.counts_per_mm() * (-1 if self.mirrored else 1)
        return floor(abs(counts) + Fraction(1, 2)) * (1 if counts >= 0 else -1)

    def line_s(self) -> float:
        """Duration of the active line."""
        return float(self.length_mm() / Fraction(self.speed))

    def approach_s(self) -> float:
        """About how long it takes from power-up to the start of the line, to scale the progress bar."""
        retrace_mm_s = float(self.maximum_speed_mm_s()) * 0.67
        return 0.3 + abs(float(Fraction(self.start))) / retrace_mm_s

    def title(self) -> str:
        """One line for the picture and the report."""
        words = [f"{self.axis.upper()} from {self.start} to {self.stop} mm at {self.speed} mm/s, N = {self.n}"]
        words += ["coordinates mirrored"] if self.mirrored else []
        words += ["host floods W X Y"] if self.flood else []
        words += ["PWM wire cut half-way"] if self.cut_pwm else []
        words += [", ".join(self.plant)] if self.plant else []
        return "; ".join(words)
