"""A robot's devices by name, and a plain function as its controller.

    def drive(robot):
        ahead = robot.laser.ranges[60:120].min()
        robot.base.set_speed(0.4, 0.0 if ahead > 1.5 else 0.8)

    player.run(drive)

The same function can drive a robot of a `troupe.Simulation` without a process of its own.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any, TypeVar

import numpy as np

from player import proxies
from player.client import PlayerClient
from player.codes import DeviceAddr
from player.proxies import (
    AioProxy,
    BlobfinderProxy,
    BumperProxy,
    DioProxy,
    FiducialProxy,
    Graphics2dProxy,
    GripperProxy,
    LaserProxy,
    Position2dProxy,
    PowerProxy,
    Proxy,
    RangerProxy,
    SimulationProxy,
    SpeechProxy,
)

P = TypeVar("P", bound=Proxy)

PROXIES: dict[int, type[Proxy]] = {
    int(kind.interface): kind
    for kind in vars(proxies).values()
    if isinstance(kind, type) and issubclass(kind, Proxy) and kind is not Proxy
}
"""The proxies by interface code."""


class Robot:
    """The devices of one client's robot, each subscribed when it is first used.

    `robot.laser` is its first laser; others are `robot.device("laser:1")`. Raises PlayerRefused
    where the robot has no such device.
    """

    def __init__(self, client: PlayerClient) -> None:
        self.client = client
        self.finished = False
        """Whether `finish` has been called."""
        self._proxies: dict[DeviceAddr, Proxy] = {}

    def __repr__(self) -> str:
        return f"<Robot {self.name or self.client.address}>"

    @property
    def name(self) -> str:
        """The robot's name in the simulation, "" if unknown."""
        return self.client.name

    @property
    def time(self) -> float:
        """Simulated time of the last reading, seconds."""
        return self.client.time

    @property
    def seed(self) -> int:
        """The seed of this robot in this run."""
        return self.client.seed

    def rng(self) -> np.random.Generator:
        """This robot's random generator, seeded by the run's seed: the same one at each call."""
        return self.client.rng()

    def finish(self) -> None:
        """The controller's work is done: it is not called again, and the robot stands."""
        self.finished = True

    def device(self, name: str) -> Any:
        """The proxy of a device by its address, such as `laser:1` or `ranger`.

        Raises ValueError for what is no device's name, PlayerRefused where there is none.
        """
        addr = DeviceAddr.parse(name)
        kind = PROXIES.get(addr.interf)
        if kind is None:
            raise ValueError(f"{addr}: there is no proxy for this interface")
        return self._proxy(kind, addr.index)

    def subscribe_all(self) -> None:
        """Subscribe every device of the robot that there is a proxy for."""
        for addr in self.client.devices():
            kind = PROXIES.get(addr.interf)
            if kind is not None:
                self._proxy(kind, addr.index)

    def _proxy(self, kind: type[P], index: int | None = None) -> P:
        at = self.client.index if index is None else index
        addr = DeviceAddr(int(kind.interface), at)
        found = self._proxies.get(addr)
        if found is None:
            found = self._proxies[addr] = kind(self.client, at)
        assert isinstance(found, kind)
        return found

    @cached_property
    def base(self) -> Position2dProxy:
        """The drive and its odometry: position2d."""
        return self._proxy(Position2dProxy)

    @cached_property
    def laser(self) -> LaserProxy:
        return self._proxy(LaserProxy)

    @cached_property
    def ranger(self) -> RangerProxy:
        return self._proxy(RangerProxy)

    @cached_property
    def blobfinder(self) -> BlobfinderProxy:
        return self._proxy(BlobfinderProxy)

    @cached_property
    def fiducial(self) -> FiducialProxy:
        return self._proxy(FiducialProxy)

    @cached_property
    def bumper(self) -> BumperProxy:
        return self._proxy(BumperProxy)

    @cached_property
    def aio(self) -> AioProxy:
        """Plain numbers of a sensor of one's own."""
        return self._proxy(AioProxy)

    @cached_property
    def dio(self) -> DioProxy:
        """Digital outputs: a sprayer, for instance."""
        return self._proxy(DioProxy)

    @cached_property
    def gripper(self) -> GripperProxy:
        return self._proxy(GripperProxy)

    @cached_property
    def power(self) -> PowerProxy:
        """The battery."""
        return self._proxy(PowerProxy)

    @cached_property
    def speech(self) -> SpeechProxy:
        return self._proxy(SpeechProxy)

    @cached_property
    def graphics2d(self) -> Graphics2dProxy:
        return self._proxy(Graphics2dProxy)

    @cached_property
    def simulation(self) -> SimulationProxy:
        return self._proxy(SimulationProxy, 0)


def run(function: Callable[[Robot], None], client: PlayerClient | None = None) -> None:
    """Run a function as this process's controller: it is called with the robot at each reading.

    All devices of the robot are subscribed before the first reading. It ends when the run is
    over, or after `robot.finish()`. `client`: the connection; unless given the robot is found as
    PlayerClient finds it.
    """
    with client or PlayerClient() as connection:
        robot = Robot(connection)
        robot.subscribe_all()
        while not robot.finished and connection.read():
            function(robot)


__all__ = ["Robot", "run"]
