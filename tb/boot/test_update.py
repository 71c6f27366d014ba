# SPDX-License-Identifier: BSD-2-Clause
"""The boot program's update server, compiled for the host, and the ``smpmgr`` and ``smpclient`` of PyPI, unmodified."""

import asyncio
import contextlib
import os
import pty
import re
import subprocess
import sys
import tty
from hashlib import sha256
from pathlib import Path

import pytest
from smp.error import MGMT_ERR
from smpclient import SMPClient
from smpclient.generics import error
from smpclient.mcuboot import IMAGE_TLV, ImageInfo
from smpclient.requests.image_management import ImageErase, ImageStatesRead, ImageStatesWrite, ImageUploadWrite
from smpclient.requests.os_management import BootloaderInformationRead, EchoWrite, ResetWrite
from smpclient.transport.serial import SMPSerialTransport

from tb import toolchain
from tb.firmware.host import build

SMPMGR = Path(sys.prefix) / "bin" / "smpmgr"
SLOTS, SLOT_BYTES = 0x40_0000, 0x8_0000


class Controller:
    """A controller's flash in a file, and what its boot program does with it."""

    def __init__(self, file):
        self.file = file

    def _run(self, *arguments):
        return subprocess.run([build("host/boot-server"), self.file, *map(str, arguments)], check=True, capture_output=True,
                              text=True, timeout=60).stdout.strip()

    def start(self):
        return self._run("start")

    def confirm(self, slot):
        self._run("confirm", slot)

    @contextlib.contextmanager
    def serve(self, running=-1):
        """The update server behind a terminal, whose name is yielded; at the end it has to have been reset."""
        master, slave = pty.openpty()
        tty.setraw(slave)
        server = subprocess.Popen([build("host/boot-server"), self.file, "serve", str(running)], stdin=master, stdout=master,
                                  stderr=subprocess.PIPE)
        try:
            yield os.ttyname(slave)
            assert server.wait(timeout=20) == 0, server.stderr.read().decode()
        finally:
            server.kill()
            server.wait()
            os.close(master)
            os.close(slave)

    def flash(self):
        return self.file.read_bytes()


@pytest.fixture
def controller(tmp_path):
    return Controller(tmp_path / "flash")


@pytest.fixture(scope="session")
def images():
    build("host/images/made")
    return toolchain.BUILD / "host" / "images"


def smpmgr(port, *arguments, fails=False):
    run = subprocess.run([SMPMGR, "--port", port, *map(str, arguments)], capture_output=True, text=True, timeout=120,
                         env={**os.environ, "COLUMNS": "400", "NO_COLOR": "1"})
    assert (run.returncode != 0) == fails, run.stdout + run.stderr
    return run.stdout + run.stderr


def hash_of(image):
    return ImageInfo.load_file(str(image)).get_tlv(IMAGE_TLV.SHA256).value.hex()


def talk(port, conversation):
    """Run a coroutine that is given a client."""
    async def run():
        async with SMPClient(SMPSerialTransport(max_smp_encoded_frame_size=1024, line_length=512, line_buffers=2), port) as client:
            return await conversation(client)
    return asyncio.run(run())


async def refused(client, image, **changes):
    """Upload a file; the answer that ends it, which has to be a refusal."""
    async for _ in client.upload(image, **changes):
        pass
    pytest.fail("the image was taken")


def install(controller, image, *, slot):
    """Put an image into the flash as a confirmed one."""
    with controller.serve() as port:
        smpmgr(port, "image", "upload", image)
        smpmgr(port, "image", "state-write", hash_of(image), "--confirm")
        smpmgr(port, "os", "reset")
    assert controller.start().split()[0] == str(slot)


def test_smpmgr_uploads_lists_tests_confirms_and_resets(controller, images):
    good, newer = images / "good.bin", images / "newer.bin"
    install(controller, good, slot=0)
    with controller.serve() as port:
        smpmgr(port, "image", "upload", newer)
        listed = smpmgr(port, "image", "state-read")
        assert re.findall(r"slot=(\d),\s*version='([\d.]+)'", listed) == [("0", "1.0.0"), ("1", "1.0.1.7")]
        assert hash_of(newer).upper() in listed
        smpmgr(port, "image", "state-write", hash_of(newer))
        assert re.findall(r"pending=(\w+)", smpmgr(port, "image", "state-read")) == ["False", "True"]
        smpmgr(port, "os", "reset")
    assert controller.start() == "1 1.0.1"
    assert controller.start() == "0 1.0.0"          # not confirmed: reverted
    with controller.serve() as port:
        smpmgr(port, "image", "state-write", hash_of(newer))
        smpmgr(port, "os", "reset")
    assert controller.start() == "1 1.0.1"
    with controller.serve(running=1) as port:       # asked for by the application under test
        assert re.findall(r"active=(\w+)", smpmgr(port, "image", "state-read")) == ["False", "True"]
        smpmgr(port, "image", "state-write", "--confirm")
        smpmgr(port, "os", "reset")
    assert [controller.start() for _ in range(2)] == ["1 1.0.1"] * 2


def test_upgrade_of_smpmgr_tests_the_image(controller, images):
    install(controller, images / "good.bin", slot=0)
    with controller.serve() as port:
        smpmgr(port, "upgrade", "--slot", 1, images / "newer.bin")
    assert controller.start() == "1 1.0.1"
    controller.confirm(1)
    assert controller.start() == "1 1.0.1"


def test_echo_and_what_boot_loader_it_is(controller):
    async def conversation(client):
        assert (await client.request(EchoWrite(d="Abbe"))).r == "Abbe"
        assert (await client.request(BootloaderInformationRead())).bootloader == "MCUboot"
        await client.request(ResetWrite())
    with controller.serve() as port:
        talk(port, conversation)


REFUSALS = {
    "unsigned": (MGMT_ERR.EACCESSDENIED, "image not signed"),
    "other-key": (MGMT_ERR.EACCESSDENIED, "image signed with another key"),
    "forged": (MGMT_ERR.EACCESSDENIED, "wrong image signature"),
    "truncated": (MGMT_ERR.EINVAL, "image truncated"),
    "too-large": (MGMT_ERR.EINVAL, "image too large"),
    "other-product": (MGMT_ERR.EINVAL, "image for another product"),
    "other-gateware": (MGMT_ERR.EINVAL, "image for other gateware"),
    "older": (MGMT_ERR.EACCESSDENIED, "image older than allowed"),
}
BEFORE_ERASING = {"too-large", "other-product", "other-gateware", "older"}


@pytest.mark.parametrize("name", REFUSALS)
def test_a_refused_image_changes_nothing(controller, images, name):
    install(controller, images / "good.bin", slot=0)
    before = controller.flash()
    with controller.serve() as port:
        async def conversation(client):
            with pytest.raises(Exception) as refusal:
                await refused(client, (images / f"{name}.bin").read_bytes())
            answer = refusal.value.args[0]
            assert (answer.rc, answer.rsn) == REFUSALS[name]
            states = await client.request(ImageStatesRead())
            assert [(image.slot, image.version, image.confirmed) for image in states.images] == [(0, "1.0.0", True)]
            await client.request(ResetWrite())
        talk(port, conversation)
    after = controller.flash()
    free = slice(SLOTS + SLOT_BYTES, SLOTS + 2 * SLOT_BYTES)
    assert before[:free.start] == after[:free.start] and before[free.stop:] == after[free.stop:]
    if name in BEFORE_ERASING:
        assert before == after
    assert controller.start() == "0 1.0.0"


def test_smpmgr_says_why(controller, images):
    install(controller, images / "good.bin", slot=0)
    with controller.serve() as port:
        assert "image signed with another key" in smpmgr(port, "image", "upload", images / "other-key.bin", fails=True)
        smpmgr(port, "os", "reset")


def test_an_upload_goes_on_where_the_line_broke(controller, images):
    image = (images / "largest.bin").read_bytes()
    with controller.serve() as port:
        async def first(client):
            async for offset in client.upload(image):
                if offset > 100_000:
                    return offset
        async def second(client):
            offsets = [offset async for offset in client.upload(image)]
            await client.request(ResetWrite())
            return offsets
        broken = talk(port, first)
        offsets = talk(port, second)
    assert offsets[0] == broken and offsets[-1] == len(image)
    assert controller.flash()[SLOTS:SLOTS + len(image)] == image


def test_pieces_out_of_order_and_too_long_are_not_stored(controller, images):
    image = (images / "good.bin").read_bytes()
    pieces = image[:200], image[200:400], image[400:]

    async def conversation(client):
        async def send(offset, data, **more):
            return await client.request(ImageUploadWrite(off=offset, data=data, **more))
        assert error(await send(200, pieces[1]))                                        # nothing was begun
        assert (await send(0, pieces[0], len=len(image), sha=sha256(image).digest())).off == 200
        assert (await send(100, pieces[1])).off == 200
        assert (await send(400, pieces[2][:100])).off == 200
        assert (await send(200, pieces[1])).off == 400
        for offset in range(400, len(image), 500):
            last = await send(offset, image[offset:offset + 500])
        assert last.off == len(image) and last.match
        assert error(await send(0, pieces[0], len=8035, sha=bytes(32)))                  # shorter than its header says
        assert error(await send(0, b"", len=len(image)))
        await client.request(ResetWrite())
    with controller.serve() as port:
        talk(port, conversation)
    assert controller.flash()[SLOTS:SLOTS + len(image)] == image


def test_a_wrong_sha_is_noticed(controller, images):
    image = (images / "good.bin").read_bytes()

    async def conversation(client):
        for offset in range(0, len(image), 500):
            more = {"len": len(image), "sha": bytes(32)} if offset == 0 else {}
            answer = await client.request(ImageUploadWrite(off=offset, data=image[offset:offset + 500], **more))
        assert (answer.rc, answer.rsn) == (MGMT_ERR.ECORRUPT, "not the SHA-256 announced")
        assert (await client.request(ImageStatesRead())).images == []
        await client.request(ResetWrite())
    with controller.serve() as port:
        talk(port, conversation)


def test_what_to_fall_back_to_is_neither_erased_nor_overwritten(controller, images):
    install(controller, images / "good.bin", slot=0)

    async def conversation(client):
        assert error(await client.request(ImageErase(slot=0)))
        async for _ in client.upload((images / "newer.bin").read_bytes()):
            pass
        assert error(await client.request(ImageErase(slot=0)))
        assert not error(await client.request(ImageErase(slot=1)))
        assert error(await client.request(ImageErase(slot=2)))
        assert [image.slot for image in (await client.request(ImageStatesRead())).images] == [0]
        assert error(await client.request(ImageStatesWrite(hash=bytes(32))))
        await client.request(ResetWrite())
    with controller.serve() as port:
        talk(port, conversation)
    assert controller.start() == "0 1.0.0"


def test_while_an_image_is_tested_an_upload_takes_its_place(controller, images):
    install(controller, images / "good.bin", slot=0)
    with controller.serve() as port:
        smpmgr(port, "upgrade", "--slot", 1, images / "newer.bin")
    assert controller.start() == "1 1.0.1"
    with controller.serve(running=1) as port:
        smpmgr(port, "upgrade", "--slot", 1, images / "newest.bin")
    assert controller.start() == "1 2.0.0"
    assert controller.start() == "0 1.0.0"


def make_update(port, image, fails=False):
    run = subprocess.run([sys.executable, "-m", "host.update", port, image, "--no-wait"], capture_output=True, text=True,
                         cwd=toolchain.ROOT, timeout=60)
    assert (run.returncode != 0) == fails, run.stdout + run.stderr
    return run.stdout + run.stderr


def test_make_update_uploads_and_starts_a_test(controller, images):
    install(controller, images / "good.bin", slot=0)
    with controller.serve() as port:
        assert "version 1.0.1.7 is started from slot 1" in make_update(port, images / "newer.bin")
    assert controller.start() == "1 1.0.1"


def test_make_update_says_why_not(controller, images):
    install(controller, images / "good.bin", slot=0)
    with controller.serve() as port:
        assert "update: image for another product" in make_update(port, images / "other-product.bin", fails=True)
        smpmgr(port, "os", "reset")
