# SPDX-License-Identifier: BSD-2-Clause
"""The firmware's host build (``controller.c``) behind a pseudo-terminal."""

import contextlib
import os
import subprocess
import tty

from tb.firmware.host import build


@contextlib.contextmanager
def controller(settings=None):
    """Power up a controller; yields the path of its serial port. ``settings`` is a file that outlives it."""
    master, slave = os.openpty()
    tty.setraw(slave)
    command = [build("host/controller"), *([] if settings is None else [settings])]
    process = subprocess.Popen(command, stdin=master, stdout=master)
    try:
        yield os.ttyname(slave)
    finally:
        process.terminate()
        process.wait()
        os.close(master)
        os.close(slave)
