# SPDX-License-Identifier: BSD-2-Clause
"""The simulated controller's serial line with the interface of a pyserial port, in simulated time."""

import math

from tb.sim.simulator import S, US

__all__ = ["SerialPort"]

SLICE_PS = 200 * US     # time between looks at what has come: two bytes


class SerialPort:
    """Waiting for bytes lets simulated time pass; nothing else does.

    Parameters
    ----------
    sim : tb.sim.simulator.Simulator

    ``timeout`` is in simulated seconds, as is :meth:`clock`.  Whatever is above 0 lets some time pass, so that a
    program that waits for a time by the clock gets there.
    """

    def __init__(self, sim):
        self._sim, self._data, self.timeout = sim, b"", 0.0

    def clock(self):
        return self._sim.time_ps / S

    def write(self, data):
        self._sim.serial_write(data)

    @property
    def in_waiting(self):
        self._data += self._sim.serial_read()
        return len(self._data)

    def reset_input_buffer(self):
        self._data = b""
        self._sim.serial_read()

    def read(self, size=1):
        """At most ``size`` bytes, after waiting for them at most ``timeout``."""
        end_ps = self._sim.time_ps + math.ceil(self.timeout * S)
        while self.in_waiting < size and self._sim.time_ps < end_ps:
            self._sim.run(min(SLICE_PS, end_ps - self._sim.time_ps))
        data, self._data = self._data[:size], self._data[size:]
        return data
