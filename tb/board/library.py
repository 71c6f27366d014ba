# SPDX-License-Identifier: BSD-2-Clause
"""C++ sources to a shared library, once per content."""

import fcntl
from contextlib import contextmanager
from pathlib import Path

from tb import toolchain

# No contraction of a*b+c: the model gives the same bits on every machine.
FLAGS = ["-std=c++17", "-O3", "-fPIC", "-ffp-contract=off", "-Wall", "-Wextra", "-Wconversion", "-Werror"]


@contextmanager
def exclusive(path):
    """Hold a lock file, made if need be, against other processes that ask for it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


@contextmanager
def cached(directory):
    """Hold ``directory``; yields whether it still has to be filled.

    It counts as filled once the body has ended without an exception.
    """
    done = directory / "done"
    with exclusive(directory / "lock"):
        yield not done.exists()
        done.touch()


def build(name, sources, *, headers=(), flags=()):
    """Path of ``build/<name>/<hash>/lib<name>.so``, compiled if these sources, headers and flags are new."""
    command = ["g++", *FLAGS, "-shared", *flags]
    key = toolchain.content_key(" ".join(map(str, command)), *sources, *headers)
    directory = toolchain.BUILD / name / key
    library = directory / f"lib{name}.so"
    with cached(directory) as empty:
        if empty:
            toolchain.run([*command, "-o", library, *sources])
    return Path(library)
