# SPDX-License-Identifier: BSD-2-Clause
"""``python -m host.update PORT IMAGE``: put an update into a controller and start it.

Asks the application for the boot loader (``BU R=1``), unless that is what answers already; uploads the image with the
:mod:`smpclient` of PyPI, marks it for a test, resets, and waits until the application answers.  The image confirms itself
after some seconds; if it does not, the next reset goes back to what ran before.
"""

import argparse
import asyncio
import sys
import time
from pathlib import Path

import serial
from rich.progress import BarColumn, DownloadColumn, Progress, TimeRemainingColumn, TransferSpeedColumn
from smpclient import SMPClient
from smpclient.exceptions import SMPUploadError
from smpclient.generics import error
from smpclient.requests.image_management import ImageStatesRead, ImageStatesWrite
from smpclient.requests.os_management import EchoWrite, ResetWrite
from smpclient.transport.serial import SMPSerialTransport

BOOT_RATE = 115200
"""Bits per second of the boot loader's port, whatever the application's are."""

LINES = {"max_smp_encoded_frame_size": 1024, "line_length": 512, "line_buffers": 2}


class Refused(Exception):
    """The controller does not take the image, or does not do what it should; the message says why."""


def enter_boot_loader(port, rate):
    """Ask the application, if there is one, to leave for the boot loader."""
    with serial.Serial(port, rate, timeout=0.5) as line:
        line.write(b"\rBU R=1\r")
        line.read_until(b"\n")


async def checked(client, request):
    """The answer to a request; a refusal is raised, with the controller's reason."""
    answer = await client.request(request)
    if error(answer):
        raise Refused(getattr(answer, "rsn", None) or str(answer))
    return answer


async def is_boot_loader(client):
    try:
        return (await client.request(EchoWrite(d="?"), timeout_s=0.5)).r == "?"
    except (TimeoutError, OSError):
        return False


async def connect(port, rate):
    """A client of the boot loader, which is asked for if need be."""
    for _ in range(2):
        client = SMPClient(SMPSerialTransport(baudrate=BOOT_RATE, **LINES), port, timeout_s=5)
        await client._transport.connect(port, 5)
        if await is_boot_loader(client):
            return client
        await client.disconnect()
        enter_boot_loader(port, rate)
    raise Refused(f"neither the controller nor its boot loader answers at {port}")


async def upload(client, image):
    """Send the image; a bar says how far that is."""
    with Progress("update", BarColumn(), DownloadColumn(), TransferSpeedColumn(), TimeRemainingColumn()) as progress:
        task = progress.add_task("", total=len(image))
        try:
            async for offset in client.upload(image):
                progress.update(task, completed=offset)
        except SMPUploadError as refusal:
            raise Refused(getattr(refusal.args[0], "rsn", None) or str(refusal)) from None


async def update(port, image, rate):
    """The whole update.  Raises :exc:`Refused`."""
    client = await connect(port, rate)
    try:
        before = {entry.slot: entry.hash for entry in (await checked(client, ImageStatesRead())).images}
        await upload(client, image)
        new = [entry for entry in (await checked(client, ImageStatesRead())).images
               if before.get(entry.slot) != entry.hash or len(before) == 0]
        for entry in new:
            await checked(client, ImageStatesWrite(hash=entry.hash))
            print(f"version {entry.version} is started from slot {entry.slot}")
        if not new:
            print("the controller has this image already")
        await checked(client, ResetWrite())
    finally:
        await client.disconnect()


def wait_for_application(port, rate, *, seconds=20):
    """Wait until the application answers."""
    end = time.monotonic() + seconds
    with serial.Serial(port, rate, timeout=0.5) as line:
        while time.monotonic() < end:
            line.reset_input_buffer()
            line.write(b"BU\r")
            if line.read_until(b"\n").startswith(b"ABBE"):
                return
    raise Refused("the application does not answer; after a reset the one before it is started")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0], prog="make update")
    parser.add_argument("port")
    parser.add_argument("image", type=Path)
    parser.add_argument("--rate", type=int, default=115200, help="bits per second of the application's port")
    parser.add_argument("--no-wait", action="store_true", help="do not wait for the application")
    options = parser.parse_args()
    try:
        asyncio.run(update(options.port, options.image.read_bytes(), options.rate))
        if not options.no_wait:
            wait_for_application(options.port, options.rate)
    except (Refused, OSError, TimeoutError) as problem:
        sys.exit(f"update: {problem}")


if __name__ == "__main__":
    main()
