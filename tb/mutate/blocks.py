# SPDX-License-Identifier: BSD-2-Clause
"""The timing blocks, and what is there to notice that one of them is wrong."""

from dataclasses import dataclass
from typing import Callable

from rtl.classifier import DecisionBatch, PulseClassifier
from rtl.led import LedPwm
from rtl.line import ScanLine
from rtl.pwm import PwmPeripheral
from rtl.quadrature import QuadratureDecoder
from rtl.snapshot import SnapshotPeripheral
from rtl.trigger import TriggerPeripheral
from tb.formal import classifier, compare, divider, led, pulse, pwm, quadrature, router, snapshot, trigger
from tb.rtl import test_classifier, test_trigger

__all__ = ["BLOCKS", "Block", "Suite"]


@dataclass(frozen=True)
class Suite:
    """cocotb tests of ``tb/rtl/<file>.py`` whose names the regular expression ``tests`` finds, in an environment."""
    file: str
    tests: str = None
    env: tuple = ()


@dataclass(frozen=True)
class Block:
    """``part``: the module of ``make()`` that is mutated.  ``suites``: its tests, quick ones first.
    ``proofs``: those whose harness has that module as ``dut``.  ``most``: its mutants that differ, if they are fewer than 200:
    asked for more, yosys looks for them for ever."""
    name: str
    make: Callable
    suites: tuple
    part: str = "dut"
    proofs: tuple = ()
    most: int = 200


def of_size(proof, **size):
    """A proof of a smaller block, of the one that is mutated: mutants are named by its cells."""
    return type(f"{proof.__name__}OfSize", (proof,), size)


CAPTURE = {"axes": test_trigger.AXES, "width": 32}
QUEUE = {"shape": 64 + 32 * test_trigger.AXES, "queue": 6}


LINE = Suite("test_scan_line"),
SCENARIOS = Suite("test_scan_line", "plays_the_scenario"),
PWM = Suite("test_pwm", env=(("PERIOD", "60"),)),

BLOCKS = (
    Block("decoder", QuadratureDecoder, (Suite("test_quadrature", "^(?!.*the_count_wraps)"),),
          proofs=(quadrature.CountsEveryEdge,)),
    Block("compare", ScanLine, LINE, part="dut.compare", proofs=(compare.FiresOncePerArming,)),
    Block("divider", ScanLine, LINE, part="dut.divider", proofs=(divider.PixelsFollowTheRecurrence,)),
    Block("pulse", ScanLine, SCENARIOS, part="dut.pulse", proofs=(pulse.PulsesLastAsLongAsSet,)),
    Block("router", ScanLine, SCENARIOS, part="dut.router", proofs=(router.PinsShowTheirSource,),
          most=107),
    Block("timestamp", SnapshotPeripheral, (Suite("test_snapshot"),), part="dut.timestamp",
          proofs=(snapshot.TimeRisesByOne,), most=164),
    Block("pwm", lambda: PwmPeripheral(period_clocks=60), PWM, part="dut.axis0",
          proofs=(pwm.TheDriveIsWhatWasAskedForOrOff,), most=129),
    Block("servo tick", lambda: PwmPeripheral(period_clocks=60), PWM, part="dut.tick",
          proofs=(pwm.DutiesAreTakenAfterTheirTick,), most=146),
    Block("classifier", PulseClassifier,
          tuple(Suite("test_classifier", "every_pulse|at_the", (("THRESHOLD", str(threshold)),))
                for threshold in test_classifier.THRESHOLDS),
          proofs=(classifier.EveryPulseIsJudgedOnce,)),
    Block("batch", DecisionBatch, (Suite("test_classifier", "batches"),), proofs=(classifier.DecisionsKeepTheirOrder,),
          most=119),
    Block("trigger", test_trigger.Bench, (Suite("test_trigger", "records"), Suite("test_trigger", "any_two")),
          part="dut.capture",
          proofs=(of_size(trigger.ARecordIsOnePulse, **CAPTURE), of_size(trigger.ARecordIsOneSample, **CAPTURE))),
    Block("record queue", lambda: TriggerPeripheral(depth=QUEUE["queue"]), (Suite("test_trigger_registers"),), part="dut.queue",
          proofs=(of_size(trigger.LostRecordsAreCounted, **QUEUE),)),
    Block("led", LedPwm, (Suite("test_led", "three_clocks|exact"),), proofs=(led.EveryPeriodIsHighOnceForItsShare,)),
)
