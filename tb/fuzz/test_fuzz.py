# SPDX-License-Identifier: BSD-2-Clause
"""A short run of the fuzz target, without libFuzzer: the corpus, and inputs made of its pieces."""

import os
import subprocess

from firmware.manual.commands import rows
from tb.firmware.host import build
from tb.fuzz import corpus, update_seeds
from tb.fuzz.dictionary import dictionary, seeds, words

COUNT = 20_000


def test_no_finding_in_the_corpus_and_in_inputs_made_of_it(tmp_path):
    inputs = corpus.write_files(tmp_path, [*seeds(rows()).values(), *corpus.read()])
    seed = os.environ.get("SEED", "1")
    run = subprocess.run([build("host/replay"), str(COUNT), seed, *inputs], capture_output=True, text=True,
                         errors="replace")
    assert run.returncode == 0, f"SEED={seed}: {run.stdout[-2000:]}{run.stderr[-4000:]}"
    assert run.stdout == f"{len(inputs)} files and {COUNT} inputs made of them\n"


def test_no_finding_in_updates_made_of_pieces_of_good_ones(tmp_path):
    inputs = corpus.write_files(tmp_path, update_seeds.seeds())
    seed = os.environ.get("SEED", "1")
    run = subprocess.run([build("host/replay-update"), str(20 * COUNT), seed, *inputs], capture_output=True, text=True,
                         errors="replace")
    assert run.returncode == 0, f"SEED={seed}: {run.stdout[-2000:]}{run.stderr[-4000:]}"
    assert run.stdout == f"{len(inputs)} files and {20 * COUNT} inputs made of them\n"


def test_the_dictionary_holds_every_command():
    modules = rows()
    known = set(words(modules))
    for module in modules:
        assert all(row["name"].encode() + b" " in known for row in module["commands"])
    assert all(line.startswith('"\\x') and line.endswith('"') for line in dictionary(modules).splitlines())


def test_the_corpus_reads_back_as_written(tmp_path, monkeypatch):
    monkeypatch.setattr(corpus, "FILE", tmp_path / "corpus.hex")
    corpus.write([b"\x00\xff", b"a\r\n", b"\x00\xff", b""])
    assert corpus.read() == [b"\x00\xff", b"a\r\n"]
