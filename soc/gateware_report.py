# SPDX-License-Identifier: BSD-2-Clause
"""What place and route reached, in our terms: use of the chip, frequencies, slack, the worst path, crossings."""

import re

from soc.top import CLOCK_HZ, FAST_CLOCK_HZ

__all__ = ["DOMAINS", "crossings_ns", "domain", "frequencies", "missed", "part", "path", "pins_ns", "summary", "use"]

DOMAINS = {"fast": FAST_CLOCK_HZ / 1e6, "sync": CLOCK_HZ / 1e6}
"""Clock domains of the controller, and the MHz that the PLL's settings ask of them; no two are equal."""

CELLS = "TRELLIS_FF|TRELLIS_DPR16X4|TRELLIS_COMB|LUT4|CCU2C|CCU2|PFUMX|L6MUX21|DP16KD|MULT18X18D"
USE = {"lut4": "TRELLIS_COMB", "ff": "TRELLIS_FF", "ebr": "DP16KD", "dsp": "MULT18X18D"}


def domain(report, clock):
    """Our name of a clock as nextpnr writes it, ``posedge <net>`` or ``<net>``: ``pins`` for no clock, ``board`` for
    one that is not the controller's.

    A net has whichever of its names yosys kept, so a clock is known by the frequency that nextpnr derived for it from
    the PLL's settings; one that comes from a pad is the oscillator.
    """
    if clock == "<async>":
        return "pins"
    net = clock.split()[-1]
    if not net.endswith("TRELLIS_IO_IN"):
        for name, wanted in DOMAINS.items():
            if abs(report["fmax"][net]["constraint"] / wanted - 1) < 1e-3:
                return name
    return "board"


def use(report):
    """``{lut4, ff, ebr, dsp: {used, available}}``.  ``lut4`` counts places of LUTs, also those that carry chains
    and distributed RAM take."""
    return {name: {key: report["utilization"][kind][key] for key in ("used", "available")}
            for name, kind in USE.items()}


def frequencies(report):
    """``{domain: (achieved, wanted)}`` in MHz for the controller's domains.  Raises :exc:`ValueError` if
    nextpnr was not asked for one of them."""
    result = {}
    for clock, values in report["fmax"].items():
        if (name := domain(report, clock)) in DOMAINS:
            result[name] = values["achieved"], values["constraint"]
    if set(result) != set(DOMAINS):
        raise ValueError(f"expected clocks {sorted(DOMAINS)}, found {sorted(report['fmax'])}")
    return result


def _paths(report, start, end):
    return [p["path"] for p in report["critical_paths"]
            if (domain(report, p["from"]), domain(report, p["to"])) == (start, end)]


def _delay(steps):
    return sum(step["delay"] for step in steps)


def crossings_ns(report):
    """``{"sync to fast": ns, ...}``: the longest delay from a flip-flop of one domain to one of the other, from
    clock edge to set-up."""
    result = {}
    for start in DOMAINS:
        for end in DOMAINS:
            if start != end and (paths := _paths(report, start, end)):
                result[f"{start} to {end}"] = max(map(_delay, paths))
    return result


def pins_ns(report):
    """``{"pins to fast": ns, "fast to pins": ns, ...}``: the longest delay between a pad and a flip-flop; the pad's
    own delay is not in it."""
    result = {}
    for name in DOMAINS:
        for start, end in ((name, "pins"), ("pins", name)):
            if paths := _paths(report, start, end):
                result[f"{start} to {end}"] = max(map(_delay, paths))
    return result


def missed(result):
    """What is too slow of a report as :mod:`soc.gateware` writes it: names of domains and of crossings.

    A crossing's payload is still for two clocks of its reader before it is read (:mod:`rtl.crossing`).
    """
    return [*(name for name, slack in result["slack_ns"].items() if slack < 0),
            *(way for way, ns in result["crossings_ns"].items() if ns >= 2 * 1000 / DOMAINS[way.split()[-1]])]


def part(cell):
    """The piece of the design a cell belongs to, from its name: ``line.divider.pixels``."""
    name = re.sub(rf"[_.]?({CELLS})(_.*)?$", "", re.split(rf"_(?:{CELLS})_", cell)[0])
    name = re.sub(r"\.words\.\d+\.\d+.*$", "", name)
    names = [re.sub(r"\$\d+$", "", part) for part in name.split(".")]
    return ".".join(n for n in names if n and not n.startswith("$") and n != "controller")


def path(report, name):
    """The worst path within a domain: ``{delay_ns, logic_ns, routing_ns, levels, through}``.

    ``levels`` counts the cells of logic between the flip-flops; ``through`` the parts of the design, in order.
    """
    steps = max(_paths(report, name, name), key=_delay, default=[])
    through = []
    for step in steps:
        for end in ("from", "to"):
            here = part(step[end]["cell"])
            if not through or through[-1] != here:
                through.append(here)
    return {
        "delay_ns": round(_delay(steps), 3),
        "logic_ns": round(_delay(s for s in steps if s["type"] != "routing"), 3),
        "routing_ns": round(_delay(s for s in steps if s["type"] == "routing"), 3),
        "levels": sum(s["type"] == "logic" for s in steps),
        "through": through,
    }


def summary(result):
    """Text of a report as :mod:`soc.gateware` writes it."""
    share = "   ".join(f"{name.upper()} {n['used']} of {n['available']} ({100 * n['used'] / n['available']:.0f} %)"
                       for name in USE for n in [result[name]])
    lines = [f"{result['board']} ({result['device']}), seed {result['seed']}", f"  {share}"]
    for name in DOMAINS:
        worst = result["critical_path"][name]
        lines += [
            f"  {name}: {result['fmax_mhz'][name]:.1f} MHz of {result['wanted_mhz'][name]:.0f}, "
            f"slack {result['slack_ns'][name]:+.2f} ns",
            f"    worst path {worst['delay_ns']:.2f} ns, {worst['levels']} levels, {worst['logic_ns']:.2f} logic and "
            f"{worst['routing_ns']:.2f} routing:",
            f"    {' > '.join(worst['through'])}",
        ]
    lines.append("  crossings: " + ", ".join(f"{name} {ns:.2f} ns" for name, ns in result["crossings_ns"].items()))
    lines.append("  pads: " + ", ".join(f"{name} {ns:.2f} ns" for name, ns in result["pins_ns"].items()))
    lines.append(f"  memory: {result['memory']}")
    if result["bitstream_sha256"]:
        lines.append(f"  bitstream {result['bitstream_bytes']} bytes, SHA-256 {result['bitstream_sha256'][:16]}...")
    lines.append(f"  built in {result['wall_s']:.0f} s")
    return "\n".join(lines)
