# SPDX-License-Identifier: BSD-2-Clause
"""C++ sources to a shared library, once per content."""

from pathlib import Path

from tb import toolchain

# No contraction of a*b+c: the model gives the same bits on every machine.
FLAGS = ["-std=c++17", "-O3", "-fPIC", "-ffp-contract=off", "-Wall", "-Wextra", "-Wconversion", "-Werror"]


def build(name, sources, *, headers=(), flags=()):
    """Path of ``build/<name>/<hash>/lib<name>.so``, compiled if these sources, headers and flags are new."""
    command = ["g++", *FLAGS, "-shared", *flags]
    key = toolchain.content_key(" ".join(map(str, command)), *sources, *headers)
    directory = toolchain.BUILD / name / key
    library = directory / f"lib{name}.so"
    with toolchain.cached(directory) as empty:
        if empty:
            toolchain.run([*command, "-o", library, *sources])
    return Path(library)
