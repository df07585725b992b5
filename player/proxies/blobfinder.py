"""A camera that reports blobs of colour."""

from __future__ import annotations

import contextlib
from math import isfinite, tau
from typing import Any, NamedTuple

from player import layouts
from player.codes import Interface
from player.errors import PlayerRefused, PlayerTimeout, XdrError
from player.familiar import Stretch
from player.proxies.base import Proxy, reading
from player.table import Blob as WireBlob

_BLOBS = layouts.data(Interface.BLOBFINDER)
_HEAD, _BLOB = _BLOBS.head, _BLOBS.records
_new = tuple.__new__  # a quarter of the time that the named tuple's own constructor takes

GET_DOUBLE_PROPERTY = 252
"""Player's request for a number that a driver knows by name."""


class Image(NamedTuple):
    """Where a blob was seen: the camera, and how many columns its image has."""

    camera: BlobfinderProxy
    width: int


class Blob(WireBlob):
    """A blob of the blobfinder: pixels, x to the robot's right, y downward; range in metres.

    Fields: id, color (0xRRGGBB), area, x, y, left, right, top, bottom, range.
    """

    image: Image | None = None
    """Where it was seen; None for a blob that no camera has made."""

    @property
    def bearing(self) -> float:
        """Where its middle is: radians, counter-clockwise, 0 straight ahead of the camera.

        Columns stand for equal angles, as those of a simulated camera do. ValueError where the
        field of view is not known: see BlobfinderProxy.fov.
        """
        if self.image is None:
            raise ValueError("this blob comes from no camera: nobody knows its bearing")
        camera, width = self.image
        fov = camera.fov
        if fov is None:
            raise ValueError(
                f"{camera.addr}: the server does not tell the camera's field of view: "
                "set the proxy's `fov`, in radians"
            )
        return (0.5 - 0.5 * (self.left + self.right) / (width - 1)) * fov if width > 1 else 0.0

    def __reduce__(self) -> tuple[Any, ...]:
        return (Blob, tuple(self))  # its camera is a connection, and stays here


class BlobfinderProxy(Proxy):
    """Player's blobfinder. Pixels: x grows to the robot's right, y downward."""

    interface = Interface.BLOBFINDER
    varying = ("blobs",)
    _kind: type[Blob] | None = None

    def _make_blobs(self) -> list[Blob] | None:
        place = self._place
        if place is not None:
            rows = self.rounds.data[place.begin + _HEAD.size : place.end]
        elif self._rows is None:
            return None
        else:
            rows = self._rows
        kind = self._kind
        if kind is None or kind.image is None or kind.image.width != self.width:
            kind = self._find_kind()
        return [_new(kind, row) for row in _BLOB.iter_unpack(rows)]

    def _find_kind(self) -> type[Blob]:
        """Blobs of this camera and its present image: what they share stands in their class."""
        found: type[Blob] = type("Blob", (Blob,), {"image": Image(self, self.width)})
        self._kind = found
        return found

    blobs: list[Blob] = reading(_make_blobs)
    """Blobs in sight; `color` is 0xRRGGBB, `range` metres, `bearing` radians."""
    width: int = reading()
    """Pixels of the image."""
    height: int = reading()

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        self._rows: bytes | None = None
        self._fov: float | None = None
        self._fov_asked = False
        super().__init__(*args, **kwargs)

    @property
    def fov(self) -> float | None:
        """The image's width as an angle, radians; None if the server does not tell.

        Player's blobs come without it. The server is asked for its property `fov` when it is first
        needed; ours knows it, where another does not, set it to what you know of your camera.
        """
        if not self._fov_asked:
            with contextlib.suppress(PlayerRefused, PlayerTimeout):
                told = self._request(GET_DOUBLE_PROPERTY, key="fov", value=0.0)["value"]
                if isfinite(told) and 0.0 < told <= tau:
                    self._fov = told
            self._fov_asked = True
        return self._fov

    @fov.setter
    def fov(self, radians: float) -> None:
        if not 0.0 < radians <= tau:
            raise ValueError(f"a field of view is an angle from 0 to 2 pi ({radians!r} given)")
        self._fov = radians
        self._fov_asked = True

    def alike(self, subtype: int, payload: bytes) -> Stretch | None:
        """As many blobs in an image of that size."""
        fits = subtype == 1 and _BLOBS.count(payload) is not None
        return (_HEAD.size, len(payload)) if fits else None

    def decode(self, subtype: int, payload: bytes) -> None:
        """BLOBS; see Proxy."""
        if subtype != 1:
            return
        size = len(payload)
        if size < _HEAD.size:
            raise XdrError(f"{self.addr}: {size} bytes are no blobs")
        width, height, n, again = _HEAD.unpack_from(payload)
        if n != again or size != _HEAD.size + n * _BLOB.size:
            raise XdrError(f"{self.addr}: {n} blobs do not fit {size} bytes")
        self.width, self.height, self._rows = width, height, payload[_HEAD.size :]
        self.__dict__.pop("blobs", None)

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
