"""What a camera would see, after recognition: blobs of colour, and fiducials."""

from __future__ import annotations

import struct
from typing import Any

from player.codes import Interface
from player.errors import XdrError
from player.proxies.base import Geometry, Proxy, geometry
from player.table import Blob, Fiducial

_HEAD = struct.Struct(">4I")
_BLOB = struct.Struct(">9If")
_COUNTS = struct.Struct(">II")
_FIDUCIAL = struct.Struct(">i12d")


class BlobfinderProxy(Proxy):
    """Player's blobfinder. Pixels: x grows to the robot's right, y downward."""

    interface = Interface.BLOBFINDER

    width = 0
    """Pixels of the image."""
    height = 0

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        self.blobs: list[Blob] = []
        """Blobs in sight; `color` is 0xRRGGBB, `range` metres."""
        super().__init__(*args, **kwargs)

    def decode(self, subtype: int, payload: bytes) -> None:
        """BLOBS; see Proxy."""
        if subtype != 1:
            return
        size = len(payload)
        if size < 16 or (size - 16) % 40:
            raise XdrError(f"{self.addr}: {size} bytes are no blobs")
        self.width, self.height, n, again = _HEAD.unpack_from(payload)
        if n != again or size != 16 + 40 * n:
            raise XdrError(f"{self.addr}: {n} blobs do not fit {size} bytes")
        self.blobs = list(map(Blob._make, _BLOB.iter_unpack(payload[16:])))

    def set_tracking_color(
        self, red: tuple[int, int], green: tuple[int, int], blue: tuple[int, int], channel: int = 0
    ) -> None:
        """Says which colours are looked for: least and greatest red, green and blue, 0..255."""
        self._request(
            1,
            channel=channel,
            red_min=red[0],
            red_max=red[1],
            green_min=green[0],
            green_max=green[1],
            blue_min=blue[0],
            blue_max=blue[1],
        )


class FiducialProxy(Proxy):
    """Player's fiducial finder. Poses are relative to the detector; yaw is relative heading."""

    interface = Interface.FIDUCIAL

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        self.fiducials: list[Fiducial] = []
        """Fiducials in sight."""
        super().__init__(*args, **kwargs)

    def decode(self, subtype: int, payload: bytes) -> None:
        """The fiducials in sight; see Proxy."""
        if subtype != 1:
            return
        size = len(payload)
        if size < 8 or (size - 8) % 100:
            raise XdrError(f"{self.addr}: {size} bytes are no fiducials")
        n, again = _COUNTS.unpack_from(payload)
        if n != again or size != 8 + 100 * n:
            raise XdrError(f"{self.addr}: {n} fiducials do not fit {size} bytes")
        self.fiducials = list(map(Fiducial._make, _FIDUCIAL.iter_unpack(payload[8:])))

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
