# SPDX-License-Identifier: BSD-2-Clause
"""Images for the tests of the boot program, signed by imgtool: ``python -m tb.firmware.boot_images KEY DIRECTORY``.

:func:`sign` is what ``make image`` does, with what a test wants otherwise.  Programs are random bytes behind the words that say
what they are for (firmware/start.S).
"""

import random
import struct
import subprocess
import sys
from pathlib import Path

from rtl.identity import MAP_VERSION

MARK, PRODUCT, RAM, HEADER_BYTES = b"Abbe", 1, 0x2_0000, 32
RAM_BYTES = 240 << 10
IMGTOOL = Path(sys.prefix) / "bin" / "imgtool"


def program(*, size=8000, product=PRODUCT, map_version=MAP_VERSION, mark=MARK, seed=1):
    """A program of ``size`` bytes, with room for the header before it."""
    start = struct.pack("<I4sII", 0x0000_006f, mark, product, map_version)
    return bytes(HEADER_BYTES) + start + random.Random(seed).randbytes(size - len(start))


def sign(path, contents, *options, key, version="1.0.0", load=RAM):
    """Write the image of ``contents`` with imgtool."""
    raw = path.with_suffix(".raw")
    raw.write_bytes(contents)
    arguments = ["--header-size", HEADER_BYTES, "--slot-size", 0x8_0000, "--version", version, "--load-addr", load]
    subprocess.run([IMGTOOL, "sign", *map(str, arguments), *(["--key", str(key)] if key else []), *map(str, options), raw, path],
                   check=True, capture_output=True)
    raw.unlink()
    return path


def make_key(path):
    path.unlink(missing_ok=True)
    subprocess.run([IMGTOOL, "keygen", "-t", "ed25519", "-k", path], check=True, capture_output=True)
    return path


def make_all(key, directory):
    """Every image that test_boot_*.c read."""
    other = make_key(directory / "other.pem")

    def image(name, *options, contents=program(), key=key, **arguments):
        return sign(directory / f"{name}.bin", contents, *options, key=key, **arguments).read_bytes()

    good = image("good")
    image("newer", contents=program(seed=2), version="1.0.1+7")
    image("newest", contents=program(seed=3), version="2.0.0")
    image("older", contents=program(seed=4), version="0.9.9")
    image("rebuilt", contents=program(seed=5), version="1.0.0+9")
    image("sha512", "--sha", "512")
    image("full-key", "--public-key-format", "full")
    image("protected", "--security-counter", "7", "--custom-tlv", "0xa0", "text")
    image("largest", contents=program(size=RAM_BYTES - HEADER_BYTES))
    image("too-large", contents=program(size=RAM_BYTES - HEADER_BYTES + 1))
    image("unsigned", key=None)
    image("other-key", key=other)
    image("other-product", contents=program(product=PRODUCT + 1))
    image("other-mark", contents=program(mark=b"Ebba"))
    image("other-gateware", contents=program(map_version=MAP_VERSION + 1))
    image("elsewhere", load=RAM + 0x1000)
    image("not-bootable", "--non-bootable")
    image("pure", "--pure")
    (directory / "truncated.bin").write_bytes(good[:-60])
    # The key's hash says ours, the signature is by another: what a forger would send.
    theirs = (directory / "other-key.bin").read_bytes()
    assert len(theirs) == len(good)
    (directory / "forged.bin").write_bytes(good[:-64] + theirs[-64:])


if __name__ == "__main__":
    make_all(Path(sys.argv[1]), Path(sys.argv[2]))
