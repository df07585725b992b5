"""Analog inputs and outputs: plain numbers, such as those of a sensor of one's own."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from player import layouts
from player.codes import Interface
from player.errors import XdrError
from player.proxies.base import Proxy, reading

_STATE = layouts.data(Interface.AIO)


class AioProxy(Proxy):
    """Player's analog input and output, in volts there; a sensor of one's own has its own units."""

    interface = Interface.AIO

    values: npt.NDArray[np.float64] = reading()
    """The inputs, shape (n,); new at each reading. They travel as 32-bit floats."""

    @property
    def voltages(self) -> npt.NDArray[np.float64]:
        """Player's name for `values`."""
        return self.values

    @property
    def count(self) -> int:
        """The number of inputs."""
        return len(self.values)

    def decode(self, subtype: int, payload: bytes) -> None:
        """STATE; see Proxy."""
        if subtype != 1:
            return
        n = _STATE.count(payload)
        if n is None:
            raise XdrError(f"{self.addr}: {len(payload)} bytes are no values")
        self.values = np.frombuffer(payload, _STATE.element, n, _STATE.head.size).astype(np.float64)

    def set_output(self, number: int, value: float) -> None:
        """Commands output `number` to a value."""
        self._command(1, id=number, voltage=value)
