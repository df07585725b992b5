"""A battery: what is left in it, and what it gives or takes."""

from __future__ import annotations

from player import layouts
from player.codes import Interface
from player.errors import XdrError
from player.proxies.base import Proxy, reading

_STATE = layouts.data(Interface.POWER).head

VOLTS, WATTS, JOULES, PERCENT, CHARGING = 1, 2, 4, 8, 16
"""Bits of `valid`."""


class PowerProxy(Proxy):
    """Player's power: a robot's battery."""

    interface = Interface.POWER

    known: int = reading()
    """Bits of what the server tells: 1 volts, 2 watts, 4 joules, 8 percent, 16 charging."""
    volts: float = reading()
    percent: float = reading()
    """What is left, 0 to 100."""
    joules: float = reading()
    """What is left."""
    watts: float = reading()
    """What it takes in at present; below 0: what is drawn from it."""
    charging: int = reading()
    """1 while it is charged, -1 while it charges another one, else 0."""

    def decode(self, subtype: int, payload: bytes) -> None:
        """STATE; see Proxy."""
        if subtype != 1:
            return
        if len(payload) != _STATE.size:
            raise XdrError(f"{self.addr}: {len(payload)} bytes of a state ({_STATE.size} expected)")
        told = _STATE.unpack(payload)
        self.known, self.volts, self.percent, self.joules, self.watts, self.charging = told

    def set_charging_policy(self, take: bool, give: bool = True) -> None:
        """Whether it may be charged, and may charge others."""
        self._request(1, enable_input=int(take), enable_output=int(give))
