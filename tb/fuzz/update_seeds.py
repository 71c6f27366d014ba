# SPDX-License-Identifier: BSD-2-Clause
"""Inputs to begin with for update.c: every request as the smp package writes it, as a packet and as lines; images; and the words."""

from smp import packet
from smpclient.requests.image_management import ImageErase, ImageStatesRead, ImageStatesWrite, ImageUploadWrite
from smpclient.requests.os_management import BootloaderInformationRead, EchoWrite, MCUMgrParametersRead, ResetWrite

from tb import toolchain
from tb.firmware.host import build

WORDS = ("off", "data", "len", "sha", "image", "upgrade", "hash", "confirm", "slot", "d", "query")


def requests(image):
    yield from (EchoWrite(d="Abbe"), ResetWrite(), MCUMgrParametersRead(), BootloaderInformationRead(query="mode"))
    yield from (ImageStatesRead(), ImageStatesWrite(hash=bytes(32)), ImageStatesWrite(confirm=True), ImageErase(slot=1))
    yield ImageUploadWrite(off=0, data=image[:64], image=0, len=len(image), sha=bytes(32), upgrade=False)
    yield ImageUploadWrite(off=64, data=image[64:128])


def seeds():
    """A list of inputs."""
    build("host/images/made")
    image = (toolchain.BUILD / "host" / "images" / "good.bin").read_bytes()
    small = image[:200]
    packets = [request.BYTES for request in requests(image)]
    result = [b"L" + b"".join(packet.encode(bytes_)) for bytes_ in packets]
    result += [b"P" + len(bytes_).to_bytes(2, "big") + bytes_ for bytes_ in packets]
    # An upload of two pieces, the second of which is the end.
    first = ImageUploadWrite(off=0, data=small[:100], len=len(small)).BYTES
    second = ImageUploadWrite(off=100, data=small[100:]).BYTES
    result.append(b"P" + b"".join(len(bytes_).to_bytes(2, "big") + bytes_ for bytes_ in (first, second)))
    for name in "good", "protected", "sha512", "full-key", "unsigned":
        whole = (toolchain.BUILD / "host" / "images" / f"{name}.bin").read_bytes()
        result.append(b"I\0\0" + whole[8032:])
    return result


def dictionary():
    """For libFuzzer: the keys of the maps, and what begins a line."""
    return "".join(f'"\\x{0x60 + len(word):02x}{word}"\n' for word in WORDS) + '"\\x06\\x09"\n"\\x04\\x14"\n"\\x0a"\n'
