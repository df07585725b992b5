"""A ranger: a scanning range finder, or a ring of single beams such as sonars."""

from __future__ import annotations

import contextlib
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from player import layouts
from player.codes import Interface
from player.errors import PlayerRefused, PlayerTimeout, XdrError
from player.proxies.base import Proxy, Size, reading
from player.xdr import Pose3d, Values

Floats = npt.NDArray[np.float64]

_RANGES, _INTENSITIES = 1, 3
_PLAIN = {subtype: layouts.data(Interface.RANGER, subtype) for subtype in (_RANGES, _INTENSITIES)}


class RangerConfig(NamedTuple):
    """How a ranger measures: radians, metres, hertz."""

    min_angle: float
    max_angle: float
    angular_resolution: float
    min_range: float
    max_range: float
    range_resolution: float
    frequency: float


class RangerGeometry(NamedTuple):
    """Where a ranger and its elements are: poses (k, 6) as Pose3d, sizes (k, 3) length first."""

    pose: Pose3d
    size: Size
    element_poses: Floats
    element_sizes: Floats


def _geometry(values: Values) -> RangerGeometry:
    width, length, height = values["size"]
    return RangerGeometry(
        values["pose"],
        Size(length, width, height),
        values["element_poses"],
        values["element_sizes"][:, [1, 0, 2]],
    )


class RangerProxy(Proxy):
    """Player's ranger.

    Its configuration and geometry are asked for when it is made, because its data does not say
    where the ranges point; a server may refuse either (then `config` or `geometry` is None).
    """

    interface = Interface.RANGER

    ranges: Floats = reading()
    """Metres, shape (n,)."""
    intensities: Floats = reading()
    """What came back along each ray, shape (n,), or (0,) if the ranger does not tell."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        self.config: RangerConfig | None = None
        self.geometry: RangerGeometry | None = None
        super().__init__(*args, **kwargs)
        with contextlib.suppress(PlayerRefused, PlayerTimeout):
            self.request_configuration()
        with contextlib.suppress(PlayerRefused, PlayerTimeout):
            self.request_geometry()

    @property
    def count(self) -> int:
        """The number of ranges."""
        return len(self.ranges)

    @property
    def hits(self) -> npt.NDArray[np.bool_]:
        """Which ranges have hit something, shape (n,); the others are the greatest range.

        ValueError if the server did not tell the greatest range.
        """
        ranges = self.ranges
        if self.config is None:
            raise ValueError(f"{self.addr}: the server did not tell how far it measures")
        return ranges < self.config.max_range

    @property
    def bearings(self) -> Floats:
        """Where the ranges point, radians in the ranger's frame, shape (n,).

        Of a scan: evenly from the least to the greatest angle. Of several elements: their yaw.
        ValueError if the server did not tell.
        """
        n = len(self.ranges)
        if self.geometry is not None and n > 1 and len(self.geometry.element_poses) == n:
            return self.geometry.element_poses[:, 5]
        if self.config is None:
            raise ValueError(f"{self.addr}: the server did not tell where its ranges point")
        return np.linspace(self.config.min_angle, self.config.max_angle, n)

    def decode(self, subtype: int, payload: bytes) -> None:
        """RANGE and INTNS, with or without stamps, and GEOM; see Proxy."""
        form = _PLAIN.get(subtype)
        if form is not None:
            n = form.count(payload)
            if n is None:
                raise XdrError(f"{self.addr}: {len(payload)} bytes are no ranges")
            numbers = np.frombuffer(payload, form.element, n, form.head.size).astype(np.float64)
            if subtype == _RANGES:
                self._take_ranges(numbers)
            else:
                self.intensities = numbers
            return
        values = self._table(subtype, payload)
        if values is None:
            return
        if "ranges" in values:
            self._take_ranges(values["ranges"])
        if "intensities" in values:
            self.intensities = values["intensities"]
        if values.get("have_geometry", True):
            self.geometry = _geometry(values)
        if values.get("have_config", False):
            self.config = RangerConfig(*(values[f"config_{f}"] for f in RangerConfig._fields))

    def _take_ranges(self, ranges: Floats) -> None:
        self.ranges = ranges
        if "intensities" not in vars(self):
            self.intensities = np.zeros(0)  # until some come, if ever

    def request_geometry(self) -> RangerGeometry:
        """Where the ranger and its elements are mounted."""
        self.geometry = _geometry(self._request(1))
        return self.geometry

    def request_configuration(self) -> RangerConfig:
        """How the ranger measures."""
        self.config = RangerConfig(**self._request(5))
        return self.config

    def configure(self, config: RangerConfig) -> RangerConfig:
        """Asks for another configuration; returns what the server made of it."""
        self.config = RangerConfig(**self._request(4, **config._asdict()))
        return self.config

    def set_power(self, on: bool) -> None:
        """Switches the ranger on or off."""
        self._request(2, value=bool(on))

    def set_intensity(self, on: bool) -> None:
        """Switches intensity data on or off."""
        self._request(3, value=bool(on))
