# SPDX-License-Identifier: BSD-2-Clause
"""The virtual controller from Python: build it, run it, and end it."""

import subprocess

from tb import toolchain
from tb.board import plant

__all__ = ["Twin", "build", "command"]


def build():
    """Path of the program, made if it is not up to date; :exc:`RuntimeError` if that fails."""
    with toolchain.firmware_lock():
        toolchain.run(["make", "--no-print-directory", "-C", "firmware", "../build/twin/abbe-twin"],
                      cwd=toolchain.ROOT)
    return toolchain.BUILD / "twin" / "abbe-twin"


def command(program, *, parameters, speed=1, tcp_port=0, settings=None, flash=None):
    """Its command line; ``parameters``: the board's, as text."""
    return [str(program), parameters, repr(float(speed)), str(tcp_port), str(settings or ""), str(flash or "")]


class Twin:
    """A running virtual controller; use it in a ``with`` statement.

    ``port`` is the path of its serial port, ``tcp_port`` the number of its TCP port on the loopback interface;
    ``report_port`` and ``report_tcp_port`` those of the report port.
    """

    def __init__(self, *, plant_overrides=(), **options):
        parameters = plant.render(plant.load(plant_overrides))
        self.process = subprocess.Popen(command(build(), parameters=parameters, **options), stdout=subprocess.PIPE,
                                        stdin=subprocess.DEVNULL, text=True)
        lines = [self.process.stdout.readline() for _ in range(4)]
        if not lines[1].startswith("tcp port: "):
            raise RuntimeError(f"the virtual controller ended with status {self.process.wait()}")
        self.port = lines[0].removeprefix("serial port: ").rstrip("\n")
        self.tcp_port = int(lines[1].removeprefix("tcp port: "))
        self.report_port = lines[2].removeprefix("report port: ").rstrip("\n")
        self.report_tcp_port = int(lines[3].removeprefix("report tcp port: "))

    @property
    def url(self):
        """For :func:`serial.serial_for_url`."""
        return f"socket://127.0.0.1:{self.tcp_port}"

    def close(self):
        """End it; its exit status."""
        self.process.terminate()
        status = self.process.wait(timeout=10)
        self.process.stdout.close()
        return status

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
