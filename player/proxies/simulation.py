"""The simulation itself: properties that a controller reports, and (for tools) robots' poses."""

from __future__ import annotations

from typing import Any

from player.client import PlayerClient
from player.codes import Interface
from player.proxies.base import Proxy
from player.xdr import Pose2d, Pose3d


def _plain(value: Any) -> Any:
    """A numpy number or array as plain Python, for JSON."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"a value of type {type(value).__name__} cannot be reported as JSON")


class SimulationProxy(Proxy):
    """Player's simulation. There is one per server: its index is 0 unless told otherwise."""

    interface = Interface.SIMULATION

    def __init__(self, client: PlayerClient, index: int = 0) -> None:
        super().__init__(client, index)

    def report(self, key: str, value: Any) -> None:
        """Sets property `key` of the client's own robot to a value that JSON can carry.

        Such properties stand in the run's result. A client that has not been told its robot's name
        means the one whose port it is at. Raises ValueError or TypeError where JSON
        cannot carry it (NaN), PlayerRefused where the server does not take it.
        """
        import json  # noqa: PLC0415 - only reports need it, and controllers start by the hundred

        text = json.dumps(value, allow_nan=False, default=_plain)
        self.set_property(self.client.name, key, text.encode())

    def set_property(self, name: str, key: str, value: bytes, index: int = 0) -> None:
        """Sets a property of the robot or model `name` to raw bytes."""
        self._request(6, name=name, property=key, index=index, value=value)

    def get_property(self, name: str, key: str, index: int = 0, size: int = 0) -> bytes:
        """A property's raw bytes. Stage wants to know the value's `size` beforehand."""
        reply = self._request(5, name=name, property=key, index=index, value=bytes(size))
        return bytes(reply["value"])

    def get_pose2d(self, name: str) -> Pose2d:
        """The true pose of the robot or model `name`; metres, radians."""
        pose: Pose2d = self._request(1, name=name, pose=(0, 0, 0))["pose"]
        return pose

    def set_pose2d(self, name: str, pose: tuple[float, float, float]) -> None:
        """Puts the robot or model `name` to a pose; metres, radians."""
        self._request(2, name=name, pose=pose)

    def get_pose3d(self, name: str) -> tuple[Pose3d, float]:
        """The true pose of the robot or model `name`, and the simulated time in seconds."""
        reply = self._request(3, name=name, pose=(0,) * 6, simtime=0.0)
        return reply["pose"], reply["simtime"] / 1e6  # microseconds on the wire

    def set_pose3d(self, name: str, pose: tuple[float, ...]) -> None:
        """Puts the robot or model `name` to a pose (x, y, z, roll, pitch, yaw)."""
        self._request(4, name=name, pose=pose, simtime=0.0)

    def pause(self) -> None:
        """Stops the simulation's clock, or lets it go on."""
        self._command(1)

    def reset(self) -> None:
        """Puts everything back where it started."""
        self._command(2)

    def save(self) -> None:
        """Asks the simulation to save its world."""
        self._command(3)
