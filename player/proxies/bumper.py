"""Bumpers: which parts of the body's edge touch something."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from player.codes import Interface
from player.proxies.base import Proxy, reading
from player.table import BumperSegment


class BumperProxy(Proxy):
    """Player's bumper."""

    interface = Interface.BUMPER

    bumped: npt.NDArray[np.bool_] = reading()
    """True per segment while it touches something, shape (n,)."""

    def decode(self, subtype: int, payload: bytes) -> None:
        """STATE; see Proxy."""
        values = self._table(subtype, payload)
        if subtype == 1 and values is not None:
            self.bumped = np.frombuffer(values["bumpers"], np.uint8) != 0

    @property
    def any_bumped(self) -> bool:
        """True if any segment touches something."""
        return bool(self.bumped.any())

    def request_geometry(self) -> list[BumperSegment]:
        """Where the segments are on the robot, their lengths and radii of curvature."""
        return [BumperSegment(*row) for row in self._request(1)["bumpers"].tolist()]
