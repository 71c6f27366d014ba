# SPDX-License-Identifier: BSD-2-Clause
"""The divide N, as the gateware holds it: whole counts and a 32-bit binary fraction."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

ONE = 1 << 32


@dataclass(frozen=True)
class Divide:
    """Pixel k is complete when progress reaches floor(k*N + phi), k = 1, 2, ...

    Members
    -------
    whole, fraction : int
        N = whole + fraction / 2^32 counts per pixel.
    phase : int
        phi = phase / 2^32. The largest, 0xFFFFFFFF, makes the floor a ceiling of k*N.
    """

    whole: int
    fraction: int = 0
    phase: int = ONE - 1

    def __post_init__(self):
        if not (1 <= self.whole < ONE and 0 <= self.fraction < ONE and 0 <= self.phase < ONE):
            raise ValueError(f"expected N from 1 to 2^32 and 32-bit fraction and phase, not {self!r}")

    @classmethod
    def from_decimal(cls, text: str, phase: int = ONE - 1) -> Divide:
        """N as a person writes it (``24``, ``24.4``), rounded down to 2^-32 as the firmware does.

        Rounding down keeps every ceil(k*N) that of the decimal N; a hair more would not.
        """
        whole, fraction = divmod(math.floor(Fraction(text) * ONE), ONE)
        return cls(whole, fraction, phase)

    def returning(self, pixels: int) -> Divide:
        """The divide of a return line whose pixels fall on the edges of a forward line of so many pixels.

        With length = ceil(pixels*N), length - ceil((pixels - k)*N) = floor(k*N + phi) for phi = -pixels*N modulo 1.
        """
        return Divide(self.whole, self.fraction, -(pixels * self.fraction) % ONE)

    def value(self) -> float:
        """N, near enough to print."""
        return self.whole + self.fraction / ONE

    def progress(self, pixels: int) -> np.ndarray:
        """floor(k*N + phi) for k = 1..pixels, exactly; pixels below 2^31."""
        k = np.arange(1, pixels + 1, dtype=np.uint64)
        carried = (k * np.uint64(self.fraction) + np.uint64(self.phase)) >> np.uint64(32)
        return (k * np.uint64(self.whole) + carried).astype(np.int64)

    def pixels_within(self, progress: int) -> int:
        """How many pixels are complete after that much progress."""
        return max(0, (progress * ONE + ONE - 1 - self.phase) // (self.whole * ONE + self.fraction))
