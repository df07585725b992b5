"""A laser range finder: one scan, counter-clockwise from the right."""

from __future__ import annotations

import struct
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from player import layouts
from player.codes import Interface
from player.errors import XdrError
from player.familiar import Stretch
from player.proxies.base import Geometry, Proxy, geometry, reading
from player.usual_rounds import Place
from player.xdr import Pose2d

Floats = npt.NDArray[np.float64]

_SCAN, _SCAN_POSE = 1, 2
_HEAD, _MARKS, _ID = layouts.data(Interface.LASER, _SCAN).stretches
_START, _EACH = _HEAD.numbers.size, _HEAD.element.itemsize
_TAILS = {_SCAN: _ID.numbers, _SCAN_POSE: layouts.data(Interface.LASER, _SCAN_POSE).tail}


class LaserConfig(NamedTuple):
    """How a laser scans: radians, metres, hertz."""

    min_angle: float
    max_angle: float
    resolution: float
    max_range: float
    range_resolution: float
    intensity: bool
    scanning_frequency: float


class LaserProxy(Proxy):
    """Player's laser. Arrays are new at each reading: what you kept does not change."""

    interface = Interface.LASER
    varying = ("ranges",)

    def _make_ranges(self) -> Floats | None:
        place, like = self._place, self._like
        if place is None or like is None:
            return None
        begin = place.begin + _START
        return np.frombuffer(self.rounds.data, _HEAD.element, like[2], begin).astype(np.float64)

    ranges: Floats = reading(_make_ranges)
    """Metres, shape (n,), from the right to the left."""
    intensity: npt.NDArray[np.uint8] = reading()
    """Shape (n,), or (0,) if the laser has none."""
    min_angle: float = reading()
    """Bearing of the first reading, radians; 0 is straight ahead of the laser."""
    max_angle: float = reading()
    resolution: float = reading()
    """Radians between readings, as the server says; 0 if it does not."""
    max_range: float = reading()
    """Metres; also the reading where nothing is hit."""
    id: int = reading()
    robot_pose: Pose2d | None = reading()
    """The robot's pose at the scan, if the server sends it."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        self._bearings: Floats = np.zeros(0)
        self._rays: Floats = np.zeros((0, 2))
        self._fan: tuple[float, float, int] | None = None
        self._like: tuple[bytes, bytes, int] | None = None
        """What the last scan was around its ranges, and how many those are."""
        super().__init__(*args, **kwargs)

    @property
    def count(self) -> int:
        """The number of readings."""
        return len(self.ranges)

    @property
    def hits(self) -> npt.NDArray[np.bool_]:
        """Which readings have hit something, shape (n,); the others are at the end of the range.

        A server that is ours never gives something hit the range's end as its reading, however near
        to it that is; one that is not has hit what it says is nearer than that.
        """
        return self.ranges < self.max_range

    @property
    def bearings(self) -> Floats:
        """The readings' bearings, radians, shape (n,)."""
        self._spread()
        return self._bearings

    @property
    def points(self) -> Floats:
        """Where the readings end, metres in the laser's frame (x ahead, y left), shape (n, 2)."""
        self._spread()
        return self._rays * self.ranges[:, None]

    def _spread(self) -> None:
        fan = (self.min_angle, self.max_angle, len(self.ranges))
        if fan != self._fan:
            self._fan = fan
            self._bearings = np.linspace(*fan)
            self._rays = np.stack((np.cos(self._bearings), np.sin(self._bearings)), axis=1)

    def alike(self, subtype: int, payload: bytes) -> Stretch | None:
        """Any scan with as many rays, and all else the same."""
        if subtype != _SCAN:
            return None
        try:
            n, *_ = self._places(payload, _ID.numbers)
        except XdrError:
            return None
        return _START, _START + n * _EACH

    def lie(self, place: Place, kept: bool) -> None:
        """See Proxy."""
        super().lie(place, kept)
        if not kept:
            self._like = None

    def _places(self, payload: bytes, tail: struct.Struct) -> tuple[int, int, int, int]:
        """How many ranges a scan has, where its intensities begin, how many, and what is behind."""
        try:
            *_, n, again = _HEAD.numbers.unpack_from(payload)
            end = _START + n * _EACH
            m, m_again = _MARKS.numbers.unpack_from(payload, end)
        except struct.error:
            raise XdrError(f"{self.addr}: {len(payload)} bytes are no scan") from None
        marks = end + _MARKS.numbers.size
        rest = marks + m + (-m % 4)
        if n != again or m != m_again or len(payload) != rest + tail.size:
            raise XdrError(f"{self.addr}: the scan's counts ({n}, {m}) do not fit its size")
        return n, marks, m, rest

    def decode(self, subtype: int, payload: bytes) -> None:
        """SCAN, SCANPOSE and SCANANGLE; see Proxy."""
        if self._like is not None and subtype == _SCAN:
            head, after, n = self._like
            if payload.startswith(head) and payload[_START + n * _EACH :] == after:
                self.ranges = np.frombuffer(payload, _HEAD.element, n, _START).astype(np.float64)
                return
        self._like = None
        tail = _TAILS.get(subtype)
        if tail is None:
            self._decode_angles(subtype, payload)
            return
        n, marks, m, rest = self._places(payload, tail)
        *angles, _, _ = _HEAD.numbers.unpack_from(payload)
        self.id, *pose = tail.unpack_from(payload, rest)
        self.min_angle, self.max_angle, self.resolution, self.max_range = angles
        self.ranges = np.frombuffer(payload, _HEAD.element, n, _START).astype(np.float64)
        self.intensity = np.frombuffer(payload, _MARKS.element, m, marks)
        self.robot_pose = Pose2d(*pose) if pose else None
        if subtype == _SCAN:
            self._like = (payload[:_START], payload[marks - _MARKS.numbers.size :], n)

    def _decode_angles(self, subtype: int, payload: bytes) -> None:
        values = self._table(subtype, payload)
        if values is None:
            return
        bearings = values["angles"].astype(np.float64)
        if len(bearings) != len(values["ranges"]):
            raise XdrError(f"{self.addr}: {len(bearings)} angles, {len(values['ranges'])} ranges")
        self.ranges = values["ranges"].astype(np.float64)
        self.max_range = values["max_range"]
        self.intensity = np.frombuffer(values["intensity"], np.uint8)
        self.id = values["id"]
        self.robot_pose = None
        self.resolution = self.min_angle = self.max_angle = 0.0
        if len(bearings):
            self.min_angle, self.max_angle = float(bearings[0]), float(bearings[-1])
        self._fan = (self.min_angle, self.max_angle, len(bearings))
        self._bearings = bearings
        self._rays = np.stack((np.cos(bearings), np.sin(bearings)), axis=1)

    def request_geometry(self) -> Geometry:
        """Where the laser is mounted, and its size."""
        return geometry(self._request(1))

    def request_configuration(self) -> LaserConfig:
        """How the laser scans; also known from the first scan on."""
        config = LaserConfig(**self._request(3))
        return config._replace(intensity=bool(config.intensity))

    def configure(self, config: LaserConfig) -> LaserConfig:
        """Asks for another way to scan; returns what the server made of it."""
        return LaserConfig(**self._request(2, **config._asdict()))

    def set_power(self, on: bool) -> None:
        """Switches the laser on or off."""
        self._request(4, state=bool(on))

    def request_id(self) -> int:
        """The laser's serial number."""
        return int(self._request(5)["serial_number"])
