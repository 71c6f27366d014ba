# SPDX-License-Identifier: BSD-2-Clause
"""A host that never stops asking, and knows what it must be told: random commands, each with the reply it must get.

:class:`Host` is a small model of the controller, written from the manual and not from the firmware: the settings, their
forms, decimals and ranges, the errors and which of them comes first, a counter (BUILD Z) that gives every second command
or so a number of its own, and the rules for what moves.  Where a reply is not determined, as that of WHERE in motion, its
form is checked, and axis F, which creeps upward for as long as a round lasts, must never be seen to go back.
"""

import random
import re
from dataclasses import dataclass
from decimal import Decimal

AXES = "XYZF"
ORDER = AXES + "TRM"            # of the values of an answer
DONE = ":A "
LINE_MAX = 128
REACH = 5000                    # tenths of a micron, either way
WAY_FROM_0 = REACH + 5000        # and the way to brake from 6.8 mm/s in 100 ms and 10 ms of jerk, and the last ways of moves
CREEP_MM_S = 0.5                # of F
COUNT = 0.3                     # tenths of a micron: a count, rounded

NO_COMMAND, NO_AXIS, MISSING, RANGE, STRAY = ":N-1", ":N-2", ":N-3", ":N-4", ":N-6"


@dataclass(frozen=True)
class Setting:
    """Values from ``low`` to ``high`` are harmless here; they have ``decimals`` and are printed so."""
    name: str
    shortcut: str
    letters: str
    low: str
    high: str
    decimals: int = 0
    a_last: bool = False        # answers ':X=1 A', not ':A X=1'
    distinct: tuple = ()        # no two letters may have the same value; what they have at the start
    outside: tuple = ()         # values that are refused


SETTINGS = (
    Setting("SPEED", "S", "XYZ", "0.5", "6.8", 6, outside=("0", "-1")),
    Setting("ACCEL", "AC", "XYZ", "15", "100", a_last=True, outside=("0", "32768", "-3")),
    Setting("PCROS", "PC", "XYZ", "0.00005", "0.002", 6, outside=("1001", "1e9")),
    Setting("ERROR", "E", "XYZ", "0.0004", "0.01", 6, a_last=True, outside=("1000.1",)),
    Setting("WAIT", "WT", "XYZ", "0", "20", a_last=True, outside=("-1", "40000")),
    Setting("BACKLASH", "B", "XYZ", "0", "0.02", 6, a_last=True, outside=("-0.01", "101")),
    Setting("JERK", "JERK", "XYZ", "0", "10", outside=("1001",)),
    Setting("SETHOME", "HM", AXES, "-100", "100", 3, outside=("1e6",)),
    Setting("SETLOW", "SL", AXES, "-110", "-60", 3, outside=("-100001",)),
    Setting("SETUP", "SU", AXES, "60", "110", 3, outside=("1e300",)),
    Setting("RUNAWAY", "RU", "XYZ", "2", "1000", 6, outside=("0", "1e4")),
    Setting("LLADDR", "LL", AXES, "0", "254", distinct=(24, 25, 26, 27), outside=("255", "-1")),
    Setting("RTIME", "RT", "X", "20", "32700", outside=("19", "32701")),
    Setting("RTIME", "RT", "YZ", "0", "32767", outside=("32768",)),
    Setting("JSSPD", "JS", "XYZFT", "1", "100", outside=("0", "101", "-101")),
    Setting("SCANR", "NR", "X", "-1000", "1000", 6, outside=("2e5",)),
    Setting("SCANR", "NR", "R", "1", "100", 6, outside=("0", "101")),
    Setting("SCANR", "NR", "T", "0", "80000", 6, outside=("80001",)),
    Setting("SCANV", "NV", "XY", "-1000", "1000", 6, outside=("-2e5",)),
    Setting("SCANV", "NV", "Z", "1", "99999", outside=("0",)),
    Setting("SCANV", "NV", "RM", "0", "4", outside=("5",)),
    Setting("ZS", "ZS", "Y", "1", "32767", outside=("0",)),
    Setting("ZS", "ZS", "F", "0", "32767", outside=("-1",)),
    Setting("VERSION", "V", "Z", "97", "122", outside=("47", "123")),
)


@dataclass
class Command:
    """``sent`` with its CR; ``reply``: without CR LF, or a function that says what is wrong with one, or nothing."""
    sent: bytes
    reply: object

    def judge(self, got):
        """What is wrong with a reply; None: nothing."""
        if callable(self.reply):
            return self.reply(got)
        return None if got == self.reply else f"expected {self.reply!r}"


class Host:
    def __init__(self, seed):
        self.random = random.Random(seed)
        self.known = {}                 # {(name, letter): Decimal}, of what has been set
        self.decimals = 1               # of positions
        self.mark = 0
        self.target = dict.fromkeys(AXES, 0.0)      # tenths of a micron
        self.crept = float("-inf")      # the last seen of F
        kinds = ((self.set_values, 30), (self.ask_values, 18), (self.set_and_ask, 12), (self.where, 12), (self.busy, 3),
                 (self.state, 4), (self.move, 8), (self.count, 25), (self.wrong, 6), (self.all_or_nothing, 3),
                 (self.set_decimals, 1), (self.creep, 1), (self.info, 0.1))
        self.kinds, self.weights = zip(*kinds)

    def next(self):
        kind = self.random.choices(self.kinds, self.weights)[0]
        text, reply = kind()
        return self.command(text, reply)

    def command(self, text, reply):
        """In upper or lower case, behind lines that are empty now and then."""
        chance = self.random.random()
        if chance < 0.1:
            text = text.lower()
        blank = "\r" if 0.1 < chance < 0.13 else "\n" if 0.13 < chance < 0.16 else "  \r" if 0.16 < chance < 0.17 else ""
        return Command(f"{blank}{text}\r".encode(), reply)

    # --- settings ------------------------------------------------------------------------------------------------

    def value(self, setting):
        step = Decimal(1).scaleb(-setting.decimals)
        return step * self.random.randint(int(Decimal(setting.low) / step), int(Decimal(setting.high) / step))

    def written(self, value):
        """A number as hosts write it."""
        form = self.random.randrange(6)
        if form == 0:
            return f"{value:e}"
        if form == 1:
            return f"{value.normalize():f}"
        if form == 2 and value > 0:
            return f"+{value}"
        if form == 3 and 0 < value < 1:
            return f"{value:f}"[1:]
        return f"{value:f}"

    def letters(self, setting):
        return self.random.sample(setting.letters, self.random.randint(1, len(setting.letters)))

    def assignments(self, values):
        glue = self.random.choice((" ", " ", "  ", " V"))
        return glue.removesuffix("V") + glue.join(f"{letter}={self.written(value)}" for letter, value in values.items())

    def draw(self):
        """A setting, and values for some of its letters."""
        while True:
            setting = self.random.choice(SETTINGS)
            values = {letter: self.value(setting) for letter in self.letters(setting)}
            if setting.distinct and not self.are_new(setting, list(values.values())):
                continue
            text = self.random.choice((setting.name, setting.shortcut)) + self.assignments(values)
            if len(text) <= LINE_MAX - 30:
                return setting, values, text

    def are_new(self, setting, values):
        """No letter has one of them, or has had it from the start, and they differ."""
        taken = {*setting.distinct, *(value for (name, _), value in self.known.items() if name == setting.name)}
        return len({*values}) == len(values) and taken.isdisjoint(values)

    def keep(self, setting, values):
        self.known |= {(setting.name, letter): value for letter, value in values.items()}

    def answer(self, setting, letters):
        fields = " ".join(f"{letter}={self.known[setting.name, letter]:.{setting.decimals}f}"
                          for letter in sorted(letters, key=ORDER.index))
        return f":{fields} A" if setting.a_last else f":A {fields}"

    def set_values(self):
        setting, values, text = self.draw()
        self.keep(setting, values)
        return text, DONE

    def ask_values(self):
        setting = self.random.choice(SETTINGS)
        letters = [letter for letter in self.letters(setting) if (setting.name, letter) in self.known]
        if not letters:
            return self.set_values()
        return (f"{self.random.choice((setting.name, setting.shortcut))} " + " ".join(f"{letter}?" for letter in letters),
                self.answer(setting, letters))

    def set_and_ask(self):
        """Queries are answered after the sets."""
        setting, values, text = self.draw()
        self.keep(setting, values)
        return text + "".join(f" {letter}?" for letter in values), self.answer(setting, values)

    def all_or_nothing(self):
        """A line with one wrong value changes nothing, as later queries will tell."""
        setting, values, text = self.draw()
        letter = self.random.choice(setting.letters)
        if letter in values:
            return f"{setting.name} {letter}={self.random.choice(setting.outside)}", RANGE
        return f"{text} {letter}={self.random.choice(setting.outside)}", RANGE

    def set_decimals(self):
        self.decimals = self.random.randint(1, 4)
        return f"VB Z={self.decimals}", DONE

    def count(self):
        if self.random.random() < 0.2:
            self.mark = self.random.randrange(65536)
            return f"BU Z={self.mark} Z?", f":A {self.mark}"
        self.mark = (self.mark + 1) % 65536
        return "BU Z+ Z?", f":A {self.mark}"

    # --- errors ----------------------------------------------------------------------------------------------------

    def wrong(self):
        setting = self.random.choice(SETTINGS)
        name, letter = setting.shortcut, self.random.choice(setting.letters)
        value = self.random.randrange(10)
        return self.random.choice((
            (f"Q{self.random.choice('ABCXYZ')}{value} X={value}", NO_COMMAND),
            (f"{self.random.choice('XYT')}={value}", NO_COMMAND),
            (setting.name if setting.name != "VERSION" else "SPEED", MISSING),
            (f"{name} {letter}=", MISSING),
            (f"{name} G={value}", NO_AXIS),
            (f"{name} {letter}={setting.outside[0]} G?", NO_AXIS),
            (f"W X G{value}", NO_AXIS),
            (f"{name} {letter}={setting.outside[0]}", RANGE),
            (f"{name} {letter}=1,", STRAY),
            (f"{name} {letter}={'0' * LINE_MAX}", STRAY)))

    # --- motion ----------------------------------------------------------------------------------------------------

    def move(self):
        axes = self.random.sample("XYZ", self.random.randint(1, 3))
        values = {axis: Decimal(self.random.randint(-10 * REACH, 10 * REACH)) / 10 for axis in axes}
        self.target |= {axis: float(value) for axis, value in values.items()}
        return f"{self.random.choice(('M', 'MOVE'))}{self.assignments(values)}", DONE

    def where(self):
        axes = self.random.sample(AXES, self.random.randint(1, 4))
        return f"{self.random.choice(('W', 'WHERE'))} {' '.join(axes)}", self.places(axes)

    def places(self, axes):
        """The check of a line of positions."""
        axes, decimals = sorted(axes, key=AXES.index), self.decimals
        form = re.compile(":A " + rf"(-?\d+\.\d{{{decimals}}}) " * len(axes))

        def check(got):
            match = form.fullmatch(got)
            if not match:
                return f"expected {len(axes)} positions with {decimals} decimals"
            for axis, text in zip(axes, match.groups()):
                if axis == "F":
                    if float(text) < self.crept - 2 * COUNT:
                        return f"F was at {self.crept} before"
                    self.crept = max(self.crept, float(text))
                elif abs(float(text)) > WAY_FROM_0:
                    return f"{axis} is where no command has sent it"
            return None
        return check

    def busy(self):
        return "/", lambda got: None if got in "BN" and got else "expected B or N"

    def state(self):
        axes = self.random.sample(AXES, self.random.randint(1, 4))
        if self.random.random() < 0.5:
            form = re.compile(f":A [BN]{{{len(axes)}}}")
            return f"RS {' '.join(f'{axis}?' for axis in axes)}", lambda got: None if form.fullmatch(got) else "expected B and N"
        form = re.compile(":A" + r" (\d{1,3})" * len(axes))
        return f"RS {' '.join(axes)}", lambda got: None if form.fullmatch(got) else f"expected {len(axes)} bytes"

    def creep(self):
        return "VE F?", f":A F={CREEP_MM_S:.6f}"

    def info(self):
        axis = self.random.choice("XYZ")
        speed = self.known.get(("SPEED", axis))

        def check(got):
            found = re.search(r"Run Speed +: +([\d.]+)", got)
            if not got.startswith(f"Axis Name Ch{axis}:") or not found or "\rWait Time" not in got:
                return f"expected a page about {axis}"
            if speed is not None and abs(Decimal(found[1]) - speed) > Decimal("0.00001"):
                return f"expected a speed of {speed}"
            return None
        return f"I {axis}", check
