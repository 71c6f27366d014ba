# SPDX-License-Identifier: BSD-2-Clause
"""Run ``powercut.c``: its scenarios, shared among processes."""

import os
import re
import subprocess
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field


@dataclass
class Cuts:
    """What has become of the cuts so far; ``failures``: a line each."""
    passed: int = 0
    failed: int = 0
    failures: list[str] = field(default_factory=list)

    def __add__(self, other):
        return Cuts(self.passed + other.passed, self.failed + other.failed, self.failures + other.failures)

    def __str__(self):
        return f"{self.passed} passed, {self.failed} failed"


class Broken(Exception):
    """A scenario that cannot be run at all."""


def scenarios(program):
    return subprocess.run([program], capture_output=True, text=True, check=True).stdout.splitlines()


def _share(program, name, part, parts, pairs, seed, progress):
    """One process, to its end."""
    cuts = Cuts()
    command = [program, name, str(part), str(parts), str(pairs), str(seed)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        for line in process.stdout:
            if counted := re.fullmatch(r"passed (\d+) failed (\d+)\n", line):
                cuts.passed, cuts.failed = int(counted[1]), int(counted[2])
                progress(part, cuts)
            elif ": cut before step " in line:
                cuts.failures.append(line.rstrip())
        error = process.stderr.read()
    if process.returncode not in (0, 1):
        raise Broken(f"{name}: {error.strip() or process.returncode}")
    return cuts


def run(program, name, *, every=1, pairs=0, seed=1, progress=lambda cuts: None):
    """Cut before each ``every``-th step of a scenario, ``pairs`` more times after each cut; :class:`Cuts`."""
    jobs = os.cpu_count()
    shares = {}

    def more(part, cuts):
        shares[part] = Cuts(cuts.passed, cuts.failed)
        progress(sum(list(shares.values()), Cuts()))

    with ThreadPoolExecutor(jobs) as pool:
        work = [pool.submit(_share, program, name, every * n + seed % every, every * jobs, pairs, seed, more) for n in range(jobs)]
        return sum((done.result() for done in work), Cuts())
