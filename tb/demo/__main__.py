# SPDX-License-Identifier: BSD-2-Clause
"""``python -m tb.demo``: exit status 0 when the pulse train is exact, 1 when not, 2 when it could not run."""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from pathlib import Path

from .scenario import Scenario

ROOT = Path(__file__).resolve().parents[2]


class Parser(argparse.ArgumentParser):
    """Says what is wrong with an option in one sentence."""

    def error(self, message):
        self.exit(2, f"error: {message} (--help lists the options)\n")


def parser() -> argparse.ArgumentParser:
    default = Scenario()
    top = Parser(prog="python -m tb.demo", description="Scan one line on the simulated controller "
                                  "and measure its pins.", epilog=__doc__.split(": ", 1)[1])
    top.add_argument("--speed", default=default.speed, help=f"line speed, mm/s (default {default.speed})")
    top.add_argument("--n", default=default.n, help=f"counts per pixel, as 24 or 24.4 (default {default.n})")
    top.add_argument("--start", default=default.start, help="start of the line, mm (default 0.0)")
    top.add_argument("--stop", default=default.stop, help="end of the line, mm (default 1.0)")
    top.add_argument("--negative", action="store_true", help="exchange start and stop: scan in the negative direction")
    top.add_argument("--axis", default=default.axis, choices=("x", "y"), help="the fast axis (default x)")
    top.add_argument("--mirrored", action="store_true", help="mirror the axis first (UM X=-10000 Y=10000)")
    top.add_argument("--flood", action="store_true", help="flood the serial line with W X Y during the scan")
    top.add_argument("--half-speed", action="store_true", help="a motor that reaches half its free speed")
    top.add_argument("--plant", action="append", default=[], metavar="[AXIS.]NAME=VALUE",
                     help="change a parameter of the board model (tb/board/plant.toml); may be repeated")
    top.add_argument("--cut-pwm", action="store_true", help="cut the PWM wire half-way: the stage must stop")
    top.add_argument("--out", type=Path, default=ROOT / "build" / "demo", help="directory (default build/demo)")
    return top


def scenario_of(options) -> Scenario:
    """Raises :exc:`ValueError` for what makes no sense."""
    start, stop = (options.stop, options.start) if options.negative else (options.start, options.stop)
    plant = tuple(options.plant) + (("speed_scale=0.5",) if options.half_speed else ())
    return Scenario(n=options.n, speed=options.speed, axis=options.axis, start=start, stop=stop,
                    mirrored=options.mirrored, flood=options.flood, cut_pwm=options.cut_pwm, plant=plant)


def power_up(plant_overrides):
    """The simulated controller with today's gateware and firmware, at time 0."""
    from tb.sim import controller
    return controller.build(lambda sentence: print(sentence, flush=True)).power_up(plant_overrides=plant_overrides)


def run(scenario: Scenario, directory: Path, make_simulator=None, show=None) -> dict:
    """Run a scenario, leave its files in ``directory`` and return the report; ``failures`` is empty when exact.

    ``make_simulator(plant_overrides)`` stands in for the simulated controller in tests of the demo itself.
    ``show(text)`` is given the report for a person, without the transcript that was shown meanwhile.
    Files get their names when they are complete: of two runs into one directory, the later one's remain.
    """
    from .session import Session
    from .verdict import judge

    directory.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".running-", dir=directory) as running:
        with (make_simulator or power_up)(scenario.plant) as sim:
            outcome = Session(sim, scenario, Path(running) / "pins.vcd").run()
        report, text = judge(scenario, outcome, Path(running))
        for file in sorted(Path(running).iterdir()):
            file.replace(directory / file.name)
    if show:
        show(text)
    return report


def main(argv=None, make_simulator=None) -> int:
    top = parser()
    options = top.parse_args(argv)
    try:
        scenario = scenario_of(options)
    except ValueError as error:
        top.error(str(error))
    from host.jitter import CaptureError
    try:
        print(f"Abbe: {scenario.title()}: {scenario.pixels()} pixels expected", flush=True)
        report = run(scenario, options.out, make_simulator, show=lambda text: print(f"\n{text}"))
        shown = options.out.relative_to(Path.cwd()) if options.out.is_relative_to(Path.cwd()) else options.out
        print(f"{shown}: report.json report.txt scan.png pins.vcd", flush=True)
    except KeyboardInterrupt:
        print("\nstopped: nothing was measured", file=sys.stderr)
        return 130
    except BrokenPipeError:                                  # whoever read the text has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 2
    except (RuntimeError, OSError, ValueError, CaptureError) as error:
        print(f"the demonstration could not run: {error}", file=sys.stderr)
        return 2
    return 1 if report["failures"] else 0


if __name__ == "__main__":
    sys.exit(main())
