"""A robot that moves in the plane: odometry, stall, and commands to its drive."""

from __future__ import annotations

import struct
from math import isfinite
from typing import Any

from player import layouts
from player.codes import Interface, MessageType
from player.errors import XdrError
from player.familiar import Stretch
from player.header import HEADER
from player.proxies.base import Geometry, Proxy, geometry, reading
from player.xdr import Pose2d

_STATE = layouts.data(Interface.POSITION2D).head
_VELOCITY = layouts.command(Interface.POSITION2D).head
_CMD = int(MessageType.CMD)


class Position2dProxy(Proxy):
    """Player's position2d. Poses are odometry, in the robot's own start frame unless it has GPS."""

    interface = Interface.POSITION2D
    varying = ("x", "y", "yaw", "vx", "vy", "vyaw", "stall")

    x: float = reading()
    """Odometry, metres."""
    y: float = reading()
    yaw: float = reading()
    """Odometry, radians, counter-clockwise."""
    vx: float = reading()
    """Speed forward, m/s."""
    vy: float = reading()
    """Speed to the left, m/s."""
    vyaw: float = reading()
    """Turning rate, rad/s, counter-clockwise."""
    stall: bool = reading()
    """True while something blocks the drive."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._velocity = HEADER.pack(0, 0, *self.addr, _CMD, 1, 0.0, 0, _VELOCITY.size)

    @property
    def pose(self) -> Pose2d:
        """x, y, yaw together."""
        return Pose2d(self.x, self.y, self.yaw)

    def alike(self, subtype: int, payload: bytes) -> Stretch | None:
        """Any state of the right size."""
        return (0, _STATE.size) if subtype == 1 and len(payload) == _STATE.size else None

    def decode(self, subtype: int, payload: bytes) -> None:
        """STATE; see Proxy."""
        if subtype != 1:
            return
        try:
            self.x, self.y, self.yaw, self.vx, self.vy, self.vyaw, stall = _STATE.unpack(payload)
        except struct.error:
            raise XdrError(
                f"{self.addr}: {len(payload)} bytes of state ({_STATE.size} expected)"
            ) from None
        self.stall = bool(stall)

    def set_speed(self, vx: float, vyaw: float = 0.0, *, vy: float = 0.0) -> None:
        """Commands a velocity: m/s forward, rad/s counter-clockwise, m/s to the left.

        Raises XdrError, a ValueError, for what is no finite number.
        """
        try:
            message = self._velocity + _VELOCITY.pack(vx, vy, vyaw, 1)
        except (struct.error, OverflowError) as error:
            raise XdrError(f"set_speed takes m/s and rad/s: {error}") from None
        if not (isfinite(vx) and isfinite(vyaw) and isfinite(vy)):
            raise XdrError(
                f"set_speed takes finite m/s and rad/s (vx={vx!r}, vyaw={vyaw!r}, vy={vy!r} given)"
            )
        self.client.queue(message)

    def go_to(self, x: float, y: float, yaw: float = 0.0) -> None:
        """Commands a pose to drive to, in the frame of the odometry; metres, radians."""
        self._command(2, pos=(x, y, yaw), vel=(0.0, 0.0, 0.0), state=1)

    def set_car(self, speed: float, steering: float) -> None:
        """Commands a car: m/s, and the angle of the front wheels in radians."""
        self._command(3, velocity=speed, angle=steering)

    def set_velocity_heading(self, speed: float, heading: float) -> None:
        """Commands m/s along a heading, radians in the frame of the odometry."""
        self._command(4, velocity=speed, heading=heading)

    def request_geometry(self) -> Geometry:
        """The body's pose (of its middle, on the robot) and size."""
        return geometry(self._request(1))

    def set_motor_power(self, on: bool) -> None:
        """Switches the motors on or off."""
        self._request(2, state=bool(on))

    def set_velocity_mode(self, mode: int) -> None:
        """Chooses the driver's velocity controller, by its own numbers."""
        self._request(3, value=mode)

    def set_position_mode(self, mode: int) -> None:
        """0: velocity control, 1: position control."""
        self._request(4, state=mode)

    def set_odometry(self, x: float, y: float, yaw: float) -> None:
        """Says where the odometry is to be now; metres, radians."""
        self._request(5, pose=(x, y, yaw))

    def reset_odometry(self) -> None:
        """Sets the odometry to (0, 0, 0)."""
        self._request(6)
