# SPDX-License-Identifier: BSD-2-Clause
"""The corpus kept in the repository: ``corpus.hex``, an input a line."""

from pathlib import Path

FILE = Path(__file__).with_name("corpus.hex")


def read():
    return [bytes.fromhex(line) for line in FILE.read_text().split("\n") if line]


def write(inputs):
    FILE.write_text("".join(f"{data.hex()}\n" for data in sorted(set(inputs), key=lambda data: (len(data), data)) if data))


def write_files(directory, inputs):
    """Each input a file of ``directory``; their paths."""
    paths = [directory / f"{n:05}" for n in range(len(inputs))]
    for path, data in zip(paths, inputs):
        path.write_bytes(data)
    return paths
