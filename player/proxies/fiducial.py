"""A fiducial finder: marks in sight, by their ids, and the mark that the robot carries."""

from __future__ import annotations

from player import layouts
from player.codes import Interface
from player.errors import XdrError
from player.proxies.base import Geometry, Proxy, geometry, reading
from player.table import Fiducial

_FIDUCIALS = layouts.data(Interface.FIDUCIAL)


class FiducialProxy(Proxy):
    """Player's fiducial finder. Poses are relative to the detector; yaw is relative heading."""

    interface = Interface.FIDUCIAL

    fiducials: list[Fiducial] = reading()
    """Fiducials in sight."""

    def decode(self, subtype: int, payload: bytes) -> None:
        """The fiducials in sight; see Proxy."""
        if subtype != 1:
            return
        if _FIDUCIALS.count(payload) is None:
            raise XdrError(f"{self.addr}: {len(payload)} bytes are no fiducials")
        rows = _FIDUCIALS.records.iter_unpack(payload[_FIDUCIALS.head.size :])
        self.fiducials = list(map(Fiducial._make, rows))

    def request_geometry(self) -> Geometry:
        """Where the detector is mounted, and its size."""
        return geometry(self._request(1))

    def request_fov(self) -> tuple[float, float, float]:
        """Least range and greatest range, metres, and the view's angle, radians."""
        reply = self._request(2)
        return reply["min_range"], reply["max_range"], reply["view_angle"]

    def request_id(self) -> int:
        """The fiducial that this robot itself carries."""
        return int(self._request(7)["id"])

    def set_id(self, number: int) -> int:
        """Asks for another fiducial on this robot; returns the one it has then."""
        return int(self._request(8, id=number)["id"])
