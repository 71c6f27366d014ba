# SPDX-License-Identifier: BSD-2-Clause
"""What may force the motor drives off with no help from the processor."""

from amaranth import Module
from amaranth.lib import wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import In, Out

__all__ = ["Interlock"]


class Interlock(wiring.Component):
    """The emergency stop, brought into the domain ``sync``.

    A level: the drives are held off for as long as the pin is high, and this block remembers nothing; what
    happens after release is defined by :class:`rtl.pwm.Pwm`.

    Members
    -------
    estop : In(1)
        Pin, asynchronous; 1 = drives off.
    inhibit : Out(1)
        A level of ``estop`` that clock 0 samples shows after clock 1 (2 flip-flops, of which the first samples), so
        pins that the next clock forces off go off after clock 2.  1 after reset, until the pin has been seen low.
    """

    estop: In(1)
    inhibit: Out(1, init=1)

    def elaborate(self, platform):
        m = Module()
        # Resets to 1: no drive moves before the pin has been looked at.
        m.submodules.estop_sync = FFSynchronizer(self.estop, self.inhibit, init=1, reset_less=False)
        return m
