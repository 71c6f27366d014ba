# SPDX-License-Identifier: BSD-2-Clause
"""Fetch the C libraries of ``firmware/libraries.toml``: each archive is checked and unpacked to ``.venv/sources/<name>``.

Run by ``host/setup.sh``; does nothing for a library that is there in the version wanted.  Ends with 1 and a sentence when an
archive cannot be found or is not the one whose SHA-256 is pinned.
"""

import hashlib
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SOURCES = Path(sys.prefix) / "sources"


def fetch(name, version, sha256):
    """Unpack the source archive of a package.  Raises :exc:`RuntimeError` if it is not the pinned one."""
    target = SOURCES / name
    stamp = target / ".sha256"
    if stamp.is_file() and stamp.read_text() == sha256:
        return
    with tempfile.TemporaryDirectory(dir=sys.prefix) as folder:
        done = subprocess.run([Path(sys.prefix) / "bin" / "unearth", "--no-binary", "--download", folder, f"{name}=={version}"],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        archives = list(Path(folder).glob("*.tar.gz"))
        if done.returncode or len(archives) != 1:
            raise RuntimeError(f"no sources of {name} {version}: {done.stdout.strip()}")
        if (found := hashlib.sha256(archives[0].read_bytes()).hexdigest()) != sha256:
            raise RuntimeError(f"the sources of {name} {version} have the SHA-256 {found}, not {sha256}")
        shutil.unpack_archive(archives[0], Path(folder) / "in")
        inside, = (Path(folder) / "in").iterdir()
        (inside / ".sha256").write_text(sha256)
        shutil.rmtree(target, ignore_errors=True)
        SOURCES.mkdir(exist_ok=True)
        inside.rename(target)


def main():
    libraries = tomllib.loads((ROOT / "firmware" / "libraries.toml").read_text())
    try:
        for name, pinned in libraries.items():
            fetch(name, pinned["version"], pinned["sha256"])
    except RuntimeError as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
