# SPDX-License-Identifier: BSD-2-Clause
"""Command line of the analyser."""

from __future__ import annotations

import argparse
import json
import os
import sys
from fractions import Fraction
from pathlib import Path

from .capture import Capture, CaptureError
from .divide import ONE, Divide
from .report import as_dict, as_text
from .statistics import Settings, measure
from .table import read_table
from .vcd import read_vcd

EXIT_EXACT, EXIT_FINDINGS, EXIT_UNUSABLE, EXIT_STOPPED = 0, 1, 2, 130


class Parser(argparse.ArgumentParser):
    """Says what is wrong with an option in one sentence."""

    def error(self, message):
        self.exit(EXIT_UNUSABLE, f"error: {message} (--help lists the options)\n")


def parser() -> argparse.ArgumentParser:
    """The options, grouped by what they describe."""
    top = Parser(
        prog="python -m host.jitter",
        description="Measure the pixel clock of a scan line against the encoder edges that should have made it.",
        epilog="Exit status: 0; 2 when the file cannot be measured; with --strict 1 when anything is found wrong.",
    )
    top.add_argument("file", nargs="+", type=Path, help="value change dump (.vcd) or logic analyser CSV")
    names = top.add_argument_group("channels")
    names.add_argument("--axis", default="x", help="axis letter: channels <axis>_a and <axis>_b (default x)")
    names.add_argument("--a", help="channel A, when it is not <axis>_a")
    names.add_argument("--b", help="channel B, when it is not <axis>_b")
    names.add_argument("--sync", default="sync", help="line SYNC (default sync)")
    names.add_argument("--pixel", default="encoder", help="pixel clock (default encoder)")
    names.add_argument("--sync-low", action="store_true", help="SYNC is active low")
    names.add_argument("--pixel-low", action="store_true", help="pixel pulses are low-going")
    names.add_argument("--reverse", action="store_true", help="the count rises when B leads")
    names.add_argument("--samplerate", type=_rate, metavar="HZ", help="of a CSV without a time column")
    line = top.add_argument_group("line")
    line.add_argument("--n", help="counts per pixel, as 24 or 24.4 (default: from the data)")
    line.add_argument("--n-fraction", type=_word, help="fraction of N in units of 2^-32, beside a whole --n")
    line.add_argument("--phase", type=_word, default=ONE - 1, help="phase in units of 2^-32 (default 0xFFFFFFFF)")
    line.add_argument("--pixels", type=int, help="pixels in every line (default: as many as SYNC spans)")
    line.add_argument("--serpentine", action="store_true", help="return lines have their pixels on the forward edges")
    line.add_argument("--origin-counts", type=int, default=0, help="count at the start of the file (default 0)")
    line.add_argument("--counts-per-mm", type=float, default=45396, help="default 45396")
    clock = top.add_argument_group("timing")
    clock.add_argument("--clock-ns", type=float, default=5.0, help="period of the sampling clock (default 5)")
    clock.add_argument("--latency-min-ns", type=float, default=0, help="least edge-to-pulse latency (default 0)")
    clock.add_argument("--latency-max-ns", type=float,
                       help="greatest latency (default: half a pixel at the line's speed, but at least 1000)")
    out = top.add_argument_group("output")
    out.add_argument("--json", type=Path, metavar="FILE", help="write the figures as JSON ('-' prints them)")
    out.add_argument("--plot", type=Path, metavar="FILE", help="write the picture")
    out.add_argument("--strict", action="store_true", help="exit 1 when anything is found wrong")
    return top


def main(argv: list[str] | None = None) -> int:
    """Measure every file; return the exit status."""
    try:
        status = _main(argv)
        sys.stdout.flush()
        return status
    except KeyboardInterrupt:
        print("\nstopped", file=sys.stderr)
        return EXIT_STOPPED
    except BrokenPipeError:                                  # whoever read the text has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_UNUSABLE


def _main(argv):
    top = parser()
    options = top.parse_args(argv)
    if options.plot and len(options.file) > 1:
        top.error("--plot draws one file at a time")
    settings = _settings(top, options)
    channels = (options.a or f"{options.axis}_a", options.b or f"{options.axis}_b", options.sync, options.pixel)
    status, results = EXIT_EXACT, {}
    for path in options.file:
        try:
            capture = _polarise(read(path, list(channels), options.samplerate), options)
            a, b, sync, pixel = channels
            figures = measure(capture, *((b, a) if options.reverse else (a, b)), sync, pixel, settings)
        except (CaptureError, OSError) as error:
            said = getattr(error, "strerror", None) or str(error)
            print(said if str(path) in said else f"{path}: {said}", file=sys.stderr)
            status = EXIT_UNUSABLE
            continue
        results[str(path)] = as_dict(figures)
        if options.json != Path("-"):
            print(f"{path}: {as_text(figures)}")
        if options.plot:
            from .plot import draw                           # matplotlib takes a second to load
            draw(figures, capture, channels, options.plot)
        if figures.findings and options.strict:
            status = max(status, EXIT_FINDINGS)
    if options.json:
        text = json.dumps(results if len(options.file) > 1 else next(iter(results.values()), {}), indent=2)
        if options.json == Path("-"):
            print(text)
        else:
            try:
                options.json.write_text(text + "\n")
            except OSError as error:
                print(f"{options.json}: {error.strerror}", file=sys.stderr)
                status = EXIT_UNUSABLE
    return status


def read(path: Path, wanted: list[str], samplerate_hz: Fraction | None = None) -> Capture:
    """Read either kind of file; a dump is known by its name or by its first character, ``$``."""
    path = Path(path)
    with open(path, "rb") as file:
        start = file.read(4096).lstrip()
    if not start:
        raise CaptureError(f"{path}: the file is empty")
    if path.suffix.lower() == ".vcd" or start.startswith(b"$"):
        return read_vcd(path, wanted)
    return read_table(path, wanted, samplerate_hz)


def _word(text: str) -> int:
    """A 32-bit number in any base."""
    value = int(text, 0)
    if not 0 <= value < ONE:
        raise argparse.ArgumentTypeError(f"expected 0 to 0xFFFFFFFF, not {text}")
    return value


def _rate(text: str) -> Fraction:
    """A sample rate in Hz, exactly."""
    try:
        return Fraction(text)
    except (ValueError, ZeroDivisionError):
        raise argparse.ArgumentTypeError(f"expected a number of Hz, not {text!r}") from None


def _settings(top, options) -> Settings:
    divide = None
    try:
        if options.n_fraction is not None:
            divide = Divide(int(options.n), options.n_fraction, options.phase)
        elif options.n is not None:
            divide = Divide.from_decimal(options.n, options.phase)
    except (TypeError, ValueError, ZeroDivisionError):
        whole = "a whole number of" if options.n_fraction is not None else ""
        top.error(f"--n: expected {whole or 'a number of'} counts per pixel, 1 or more, not {options.n or 'nothing'}")
    for name in ("clock_ns", "counts_per_mm", "samplerate", "pixels"):
        value = getattr(options, name)
        if value is not None and not value > 0:
            top.error(f"--{name.replace('_', '-')}: expected a number above 0, not {value}")
    return Settings(
        divide=divide, pixels=options.pixels, clock_ps=options.clock_ns * 1000,
        latency_ps=(round(options.latency_min_ns * 1000),
                    None if options.latency_max_ns is None else round(options.latency_max_ns * 1000)),
        counts_per_mm=options.counts_per_mm, origin_counts=options.origin_counts,
        serpentine=options.serpentine,
    )


def _polarise(capture, options):
    """Make the active level of SYNC and of the pixel pulses high."""
    for name, low in ((options.sync, options.sync_low), (options.pixel, options.pixel_low)):
        if low:
            capture.traces[name] = capture.traces[name].inverted()
    return capture
