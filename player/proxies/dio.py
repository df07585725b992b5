"""Digital outputs and inputs: a sprayer, for instance."""

from __future__ import annotations

from player import layouts
from player.codes import Interface
from player.errors import XdrError
from player.proxies.base import Proxy, reading

_VALUES = layouts.data(Interface.DIO)


class DioProxy(Proxy):
    """Player's digital input and output; bit i is line i."""

    interface = Interface.DIO

    count: int = reading()
    """The number of lines."""
    bits: int = reading()
    """Their values."""

    def decode(self, subtype: int, payload: bytes) -> None:
        """VALUES; see Proxy."""
        if subtype != 1:
            return
        if len(payload) != _VALUES.head.size:
            raise XdrError(
                f"{self.addr}: {len(payload)} bytes of lines ({_VALUES.head.size} expected)"
            )
        self.count, self.bits = _VALUES.head.unpack(payload)

    def set_output(self, bits: int, count: int = 1) -> None:
        """Commands the first `count` lines to the values in `bits`."""
        self._command(1, count=count, bits=bits)
