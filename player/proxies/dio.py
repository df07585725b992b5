"""Digital outputs and inputs: a sprayer, for instance."""

from __future__ import annotations

from player.codes import Interface
from player.errors import XdrError
from player.proxies.base import Proxy, reading


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
        if len(payload) != 8:
            raise XdrError(f"{self.addr}: {len(payload)} bytes of lines (8 expected)")
        self.count = int.from_bytes(payload[:4])
        self.bits = int.from_bytes(payload[4:])

    def set_output(self, bits: int, count: int = 1) -> None:
        """Commands the first `count` lines to the values in `bits`."""
        self._command(1, count=count, bits=bits)
