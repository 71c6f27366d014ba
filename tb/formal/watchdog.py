# SPDX-License-Identifier: BSD-2-Clause
"""The watchdog: whatever the bus does, a processor that is late is reset, and one that is not is not."""

from amaranth import Mux, Signal

from tb.formal.proof import AnySeq, Assert, Cover, Proof, one_clock


class LateIsReset(Proof):
    """Any strobes and any time-out at any time: ``expired`` comes when and only when it must, told from the time of the
    last kick and the time-out taken with it; the reset follows, whole."""

    block = "rtl.watchdog"
    depth = 3
    cover_depth = 30
    bug_depth = 34
    widths = "timeout 32"
    bugs = {
        "a kick in the last clock is still taken": ("late.eq(self.running & (left == 0))",
                                                    "late.eq(self.running & (left == 0) & ~self.kick)"),
        "enable is a kick": ("(self.enable & ~self.running)", "self.enable"),
        "enable does not take the time-out": (" | (self.enable & ~self.running)", ""),
        "it goes on after the reset": ("self.cpu_reset.eq(1), self.running.eq(0)", "self.cpu_reset.eq(1)"),
        "kicks are taken while stopping": ("with m.If(self.enable & ~resetting):", "with m.If(self.enable):"),
        "the reset does not end": ("self.cpu_reset.eq(0), resetting.eq(0)", "resetting.eq(0)"),
        "a command is no reset": ("with m.Elif(late | self.reset):", "with m.Elif(late):"),
        "the cause is that of a command": ("with m.If(late):", "with m.If(late & ~self.reset):"),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.Watchdog(), "sync")
        for pin in dut.timeout, dut.enable, dut.kick, dut.reset:
            m.d.comb += pin.eq(AnySeq(len(pin)))

        # Clocks since the last kick, the time-out taken with it; clocks since the reset began.
        watched, since, taken = Signal(), Signal(33), Signal(32)
        length = block.DRIVES_OFF_CLOCKS + block.RESET_CLOCKS
        step = Signal(range(length + 1), init=length)
        late, begins, idle = Signal(), Signal(), Signal()
        cause = Signal(2)
        m.d.comb += [
            idle.eq(step == length), late.eq(idle & watched & (since >= taken)), begins.eq(late | (idle & dut.reset)),
        ]
        m.d.formal += [since.eq(since + 1), step.eq(Mux(begins, 0, step + ~idle))]
        with m.If(begins):
            m.d.formal += cause.eq(Mux(late, 1, 2))
        with m.If(idle & (dut.kick | (dut.enable & ~watched))):
            m.d.formal += [since.eq(0), taken.eq(dut.timeout)]
        with m.If(idle & dut.enable):
            m.d.formal += watched.eq(1)
        with m.If(step == block.DRIVES_OFF_CLOCKS - 1):
            m.d.formal += watched.eq(0)

        m.d.comb += [
            Assert(dut.expired == (step == 0)),
            Assert(dut.cpu_reset == ((step >= block.DRIVES_OFF_CLOCKS) & ~idle)),
            Assert(dut.running == watched), Assert(dut.cause.as_value() == cause),
            *self.lemmas(
                dut._resetting == ~idle, step <= length, dut._step == Mux(idle, 0, step),
                ~(watched & idle) | (since <= taken), ~(watched & idle) | (dut._left == (taken - since)[:32]),
                (cause != 3), ~watched | (step < block.DRIVES_OFF_CLOCKS) | idle),
            Cover((step == length) & (cause == 1)), Cover(late & (taken == 5)),
            Cover(watched & (cause == 2) & idle),
        ]
