# SPDX-License-Identifier: BSD-2-Clause
"""The words of the language, from the rows of the firmware: libFuzzer's dictionary, and the first corpus."""

from tb.transcripts.runner import VECTORS
from tb.transcripts.transcript import Exchange, load

NUMBERS = ("0", "1", "-1", "0.5", "24", "255", "1e9", "-1e300", "99999", "2147483648", "1e-300")
CONTROLS = (b"\\", b"\r", b"\x08", b"\xffA", b"\xffB", b"\xffH", b"\xffT", b"\xffR", b'"')
FRAMES = tuple(bytes([24, code, size, *data, 58]) for code, size, data in (
    (63, 0, ()), (84, 3, (16, 39, 0)), (97, 3, ()), (108, 3, ()), (126, 1, ()), (68, 3, (1, 2, 3)), (100, 3, ()),
    (43, 0, ()), (45, 0, ()), (71, 0, ()), (66, 0, ()), (74, 0, ()), (75, 0, ())))

# What language.c takes for itself.
PAUSE = b"\x16"         # 2 ms pass
POWER = b"\x14"         # the power goes and comes back


def press(button, length=0):
    """A button is pressed, 0 shortly to 2 extra long."""
    return bytes([0x17, length << 2 | button])


def analog(channel, sevenths):
    """An analog input goes to a level."""
    return bytes([0x17, 1 << 6 | sevenths << 3 | channel])


def ttl(pin, level):
    """An edge at a TTL input."""
    return bytes([0x17, 2 << 6 | level << 1 | pin])


def turn(knob, edges):
    """A knob turns by -8 to 7."""
    return bytes([0x17, 3 << 6 | edges + 8 << 2 | knob])


AT, HOME, ZERO, JOYSTICK = range(4)
HANDS = (*(press(button, length) for button in range(4) for length in range(3)),
         *(analog(channel, sevenths) for channel in range(3) for sevenths in (0, 4, 7)),
         *(ttl(pin, level) for pin in range(2) for level in range(2)), *(turn(knob, edges) for knob in range(4) for edges in (-1, 7)))

def told(*parts):
    """Lines of text, ended by ``;``, where ``...`` lets 24 ms pass, and bytes of hands."""
    return b"".join(part if isinstance(part, bytes) else part.replace(";", "\r").encode().replace(b"...", 12 * PAUSE)
                    for part in parts)


# What takes several commands, or a hand, to get to.
STORIES = tuple(map(told, (
    "LD X=1;LD X=2;LD X+ Y=3;LD X?;TTL X=1;RM;RM;RM F=2;RT Z=0;RM;...RM F?;RM F=3;RM;...RM;RM F=4;RM;RM;RM;RM;",
    "LD X=1;RM F=0;TTL X=12;RM;RM;RM Z=0;RM X=0;RM;",
    "ZS X=1 Y=3 F=1;TTL X=4;RM;...ZS Z=1 F=0;RM;RM;RM;RM;RM;ZS T? M?;ZS M=0;RM;\\;ZS Y=1;RM;RM;",
    "R X=1 Z=1;TTL X=2;RM;TTL X=10;RM;RM;TTL X=5;RT X=20;RM;...TTL X=0;",
    "TTL Y=2;RT Y=1;M X=10;...M X=0;\\;TTL Y=3;M X=100;...",
    "VB X=63;M X=10;...W;DU R=1;M X=1000;...DU;DU Y;DU X;",
    "M X=100;VB X=33;SP;...", "MC X-;M X=1;MC X+;M X=1000;R X=-5;HALT;S X=1;M X=0;...SS Z;SS Y;SS X;SS Q;",
    "NR X=0 Y=0.01;NV X=0 Y=0;TTL X=1;SN;...SN P;\\;", 'LCD "text";LCD;UN;UN;BU Y=65;BU Y?;BU Y-;BU Z+;BU Z-;',
    "S X=1.5;UM X=-10000;SS Z;R X=500;......SP;......" + POWER.decode() + "W X;SS X;SS Y;"))) + (
    told("AZ X;", *15 * ["..."], "AZ Y;..."),
    told("SL X=-0.1;AZ X;", *4 * ["..."], "\\"),
    told("J X+ Y+;", *(analog(channel, 4) for channel in range(3)), "......", analog(0, 7), "...", press(JOYSTICK), "...", analog(0, 4),
         "...", analog(1, 0), "...\\", analog(1, 4), "J X=5 Y=6 Z=4;", *(turn(knob, 7) for knob in range(4)), "......",
         press(JOYSTICK, 2), *(turn(knob, -8) for knob in range(4)), "...J X-;SU Y=0;", analog(1, 7), "..."),
    told("VB X=7;", ttl(1, 1), "...", ttl(1, 0), "...", *(press(JOYSTICK, length) + 2 * PAUSE for length in range(3))),
    *(told(f"TTL X={mode};LD X=1;", ttl(0, 1), "...", ttl(0, 0), "...") for mode in range(13)),
    *(told(lines, *(press(button, length) + 2 * PAUSE for button in range(4) for length in range(3))) for lines in (
        "NR X=0 Y=0.01;LD X=1;", "BE X=0;", "BE Z=33;BCA X=0 Y=2 Z=2 F=2 T=0 R=2 M=2;", "BE R=2 T=2 M=2;BE F=0;BE F=2;BE F=3;")))


def words(modules):
    """All words, as bytes."""
    commands = [row for module in modules for row in module["commands"]]
    parameters = [row for module in modules for row in module["parameters"]]
    for row in commands:
        yield from (name.encode() + b" " for name in (row["name"], row["shortcut"]) if name)
    letters = {row["letter"] for row in parameters if row["letter"].isalpha()} | set("XYZF")
    for letter in sorted(letters):
        yield from (f"{letter}{form}".encode() for form in ("=", "?", "+", "-", " "))
    yield from (number.encode() for number in NUMBERS)
    yield from CONTROLS
    yield from (PAUSE, 12 * PAUSE, POWER, *HANDS)
    yield from FRAMES


def dictionary(modules):
    """Text of a libFuzzer dictionary."""
    return "".join('"' + "".join(f"\\x{byte:02x}" for byte in word) + '"\n' for word in words(modules))


def seeds(modules):
    """``{name: bytes}``: every row set, asked and signed, and every transcript."""
    result = {}
    for module in modules:
        lines = []
        for row in module["commands"]:
            lines += [row["name"], f"{row['shortcut'] or row['name']} X Y Z F"]
            lines += [f"{row['name']} {letter}{form}" for letter in row["letters"][:8] for form in ("", "=1", "?", "-")]
        for row in module["parameters"]:
            for letter in "XF" if row["letter"] == "*" else row["letter"]:
                if letter.isalpha():
                    lines += [f"{row['command']} {letter}{form}" for form in (
                        "?", f"={row['minimum']:.9g}", f"={row['maximum']:.9g}", "=1", f"={row['initial'][0]:.9g}",
                        "+", "-")]
        # RESET and SP are for the application, which is not here.
        result[module["name"].replace(" ", "_")] = "\r".join([*lines, ""]).encode()
    for path in sorted(VECTORS.glob("*.txt")):
        result[f"transcript_{path.stem}"] = b"".join(step.sent for step in load(path) if isinstance(step, Exchange))
    result |= {f"story_{n}": story for n, story in enumerate(STORIES)}
    result["frames"] = b"\xffB" + b"".join(FRAMES) + b"\xffA"
    return {name: data[:4096] for name, data in result.items()}
