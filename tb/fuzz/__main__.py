# SPDX-License-Identifier: BSD-2-Clause
"""``make fuzz [RUNS=...]``: libFuzzer on the command language and the binary format, under ASan and UBSan; with
``ARGS="--target update"`` on what reaches the boot program: frames and packets of SMP, and images.

Installs clang if it is not there. Inputs that reach new code are kept in ``corpus.hex``, as few as reach it all; one
that fails is kept in ``build/fuzz/failed``, and the run ends with status 1. At the end the line coverage of the
language is printed, which must be 90 % at least.
"""

import argparse
import re
import shutil
import subprocess
import sys

from firmware.manual.commands import rows
from tb import toolchain
from tb.fuzz import corpus, update_seeds
from tb.fuzz.dictionary import dictionary, seeds

BUILD = toolchain.BUILD / "fuzz"
COVERAGE_MIN = 90       # percent of the lines of PARTS
LENGTH_MAX = 160        # bytes of an input: several lines, or one too long
UPDATE_LENGTH_MAX = 1024


def make(target):
    subprocess.run(["make", "--no-print-directory", "-s", "-C", "firmware", f"../build/{target}"],
                   cwd=toolchain.ROOT, check=True)
    return toolchain.BUILD / target


def fresh(name):
    shutil.rmtree(BUILD / name, ignore_errors=True)
    (BUILD / name).mkdir(parents=True)
    return BUILD / name


def said():
    return (BUILD / "log.txt").read_text(errors="replace")


def last_of(pattern):
    """The groups of the last match in what libFuzzer has said."""
    found = list(re.finditer(pattern, said()))
    return " ".join(found[-1].groups()) if found else "nothing yet"


def ended(process):
    """Wait a minute for it."""
    try:
        process.wait(60)
    except subprocess.TimeoutExpired:
        return False
    return True


def fuzz(target, runs, seconds, *, start, words, length_max):
    """Run libFuzzer; the directory of all inputs it found worth keeping, and whether all was well."""
    found, failed = fresh("found"), fresh("failed")
    corpus.write_files(fresh("start"), start)
    (BUILD / "dictionary").write_text(words)
    command = [target, f"-dict={BUILD / 'dictionary'}", f"-runs={runs}", f"-max_len={length_max}",
               f"-max_total_time={seconds}", "-timeout=20", "-print_final_stats=1", "-entropic=0", "-verbosity=1",
               f"-artifact_prefix={failed}/", found, BUILD / "start"]
    with open(BUILD / "log.txt", "w") as log, subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT) as process:
        while not ended(process):
            print(last_of(r"(#\d+)\s.*(cov: .*)"), flush=True)
    print(f"{last_of(r'executed_units: *(.*)')} executions, log in {BUILD / 'log.txt'}")
    if process.returncode:
        print("\n".join(line for line in said().splitlines() if "ERROR" in line or "SUMMARY" in line))
        print("the failing input:", *failed.iterdir())
    return found, process.returncode == 0


def minimise(target, found):
    """The inputs needed to reach all that is reached."""
    merged = fresh("merged")
    subprocess.run([target, "-merge=1", f"-max_len={LENGTH_MAX}", merged, BUILD / "start", found], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return [path.read_bytes() for path in merged.iterdir()]


def coverage():
    """Print the line coverage of the language by the seeds and the corpus; returns its total in percent."""
    replay = make("fuzz/coverage/replay")
    for old in replay.parent.rglob("*.gcda"):
        old.unlink()
    inputs = corpus.write_files(fresh("replayed"), [*seeds(rows()).values(), *corpus.read()])
    subprocess.run([replay, "0", "1", *inputs], check=True, stdout=subprocess.DEVNULL)
    covered = total = 0
    for folder, names in PARTS.items():
        files = sorted((replay.parent / folder).glob("*.gcda"))
        report = subprocess.run(["gcov", "-n", *files], cwd=BUILD, capture_output=True, text=True, check=True).stdout
        for name, percent, lines in re.findall(r"File '([^']*)'\nLines executed:([\d.]+)% of (\d+)", report):
            if not name.startswith(f"{folder}/") or not re.search(names, name):
                continue
            print(f"  {name:35} {float(percent):6.1f} % of {lines:>4} lines")
            covered += float(percent) * int(lines)
            total += int(lines)
    print(f"  {'all of them':35} {covered / total:6.1f} % of {total:>4} lines")
    return covered / total


# What a line passes through, and what answers it; not what moves axes.
PARTS = {"core": r"(line|console|parser|command|rows|reply|report|number|bignum|settings|fault)\.c$",
         "modules": r"/(?!axis|scan_run|application)\w+\.c$"}


def main():
    parser = argparse.ArgumentParser(prog="make fuzz", description=__doc__.split("\n\n")[0])
    parser.add_argument("--runs", type=int, default=10_000_000, help="executions (default %(default)d)")
    parser.add_argument("--seconds", type=int, default=0, help="end after so long; 0: never (default)")
    parser.add_argument("--target", choices=("language", "update"), default="language", help="what is fuzzed (default %(default)s)")
    options = parser.parse_args()
    if not shutil.which("clang-14"):
        subprocess.run([toolchain.ROOT / "host" / "setup.sh", "clang-14", "libclang-rt-14-dev"], check=True)
    target = make(f"fuzz/clang/{options.target}")
    if options.target == "update":
        _, good = fuzz(target, options.runs, options.seconds, start=update_seeds.seeds(), words=update_seeds.dictionary(),
                       length_max=UPDATE_LENGTH_MAX)
        return 0 if good else 1
    modules = rows()
    found, good = fuzz(target, options.runs, options.seconds, start=[*seeds(modules).values(), *corpus.read()],
                       words=dictionary(modules), length_max=LENGTH_MAX)
    if good:
        corpus.write(minimise(target, found))
        good = coverage() >= COVERAGE_MIN
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
