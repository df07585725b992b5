"""What a device is, and what devices may use of the simulation.

Rules: reading is free at any time between two ticks. Every change goes through `Context.later`, so
that it is made robot by robot in the engine's order, and not in that of the messages' arrival.
What a device keeps for its own clients (how a scan is cut, what was just set) is no change. What
goes on by itself, such as a battery that runs down, does so in `Context.each_tick`.

A robot's devices are made when somebody first asks for one of them, which may be never. A device
whose data are a message of a batch may say so: `standing()` is a `rounds.Standing`, or None as long
as it encodes its own. That may change only in a request.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from player import DeviceAddr
from player.server import Connection
from sim.devices.things import Charger, Thing
from sim.robot import Robot
from sim.scenery import Scenery

Values = Mapping[str, Any]
Action = Callable[[], None]
Twist = tuple[float, float, float]
"""A velocity: m/s ahead and to the left, rad/s."""

FARTHEST = 1e6
"""Metres, radians, and either per second: what a client commands beyond that is cut to it."""


class Refused(Exception):
    """A request that the device does not grant: its client gets a NACK."""


@dataclass
class Context:
    """The parts of a run that devices read and change, and the changes that are to come.

    `interval` and `time` are simulated seconds. While a message is handled, `client` is who has
    sent it. `complaints` are what devices find wrong with it, until somebody tells people.
    """

    scenery: Scenery
    interval: float
    robots: list[Robot] = field(default_factory=list)
    by_name: dict[str, Robot] = field(default_factory=dict)
    things: dict[str, Thing] = field(default_factory=dict)  # obstacles, by name
    chargers: Sequence[Charger] = ()
    each_tick: list[Action] = field(default_factory=list)
    # what devices do by themselves once the bodies have moved, in the order of robots
    time: float = 0.0
    paused: bool = False  # by a client
    held: bool = False  # by somebody who watches: no controller is to blame for the wait
    client: Connection | None = None
    complaints: list[tuple[Robot, str]] = field(default_factory=list)
    pending: dict[int, dict[Hashable, tuple[Action | Twist, Connection | None]]] = field(
        default_factory=dict
    )
    puts: dict[int, dict[int, tuple[float, float, float]]] = field(default_factory=dict)
    # robots that are to be put at poses, by the robot whose client asked
    thing_puts: dict[int, dict[str, tuple[float, float, float]]] = field(default_factory=dict)
    # the same of obstacles, by their names
    twists: dict[int, Twist] = field(default_factory=dict)
    changes: int = 0  # how many there have been: what they bring about is looked for after one
    resets: int = 0  # how often `reset` was asked for and is to be carried out

    def admit(self, robot: Robot) -> None:
        """A robot has entered: the next in the list."""
        self.robots.append(robot)
        self.by_name[robot.name] = robot

    def later(self, robot: Robot, action: Action, key: Hashable = None) -> None:
        """Have `action` called at the next command phase, in the order of robots.

        With a `key` it takes the place of the robot's earlier action of that key, as the last
        command wins: what a client sends while the world waits does not pile up.
        """
        self.put_off(robot, action, action if key is None else key)

    def put_off(self, robot: Robot, action: Action | Twist, key: Hashable) -> None:
        """Note what is to be done, or how the robot is to be driven, at the next command phase."""
        actions = self.pending.get(robot.index)
        if actions is None:
            self.pending[robot.index] = {key: (action, self.client)}
            return
        actions.pop(key, None)
        actions[key] = action, self.client

    def complain(self, robot: Robot, what: str) -> None:
        """A message to a robot makes no sense: `what` goes on from "somebody sent"."""
        self.complaints.append((robot, what))

    def take_puts(self) -> dict[int, tuple[float, float, float]]:
        """Where robots shall be put, by index, robot by robot of those who asked; and forget it."""
        goals: dict[int, tuple[float, float, float]] = {}
        for asking in sorted(self.puts):
            goals.update(self.puts[asking])
        self.puts.clear()
        return goals

    def take_thing_puts(self) -> dict[str, tuple[float, float, float]]:
        """Where obstacles shall be put, by name, likewise; and forget it."""
        goals: dict[str, tuple[float, float, float]] = {}
        for asking in sorted(self.thing_puts):
            goals.update(self.thing_puts[asking])
        self.thing_puts.clear()
        return goals

    def carry_out(self) -> list[tuple[Connection, Exception]]:
        """Call what `later` was given, robot by robot, each in the order of arrival.

        What actions raised that clients have asked for, and who those are, is given back.
        """
        failed = []
        while self.pending:
            pending, self.pending = self.pending, {}
            self.changes += len(pending)
            for robot in sorted(pending):
                for action, client in pending[robot].values():
                    if isinstance(action, tuple):
                        self.twists[robot] = action
                        continue
                    try:
                        action()
                    except Exception as error:
                        if client is None:
                            raise
                        failed.append((client, error))
        if self.twists:
            robots = np.array(list(self.twists), np.int64)
            self.scenery.stage.command(robots, np.array(list(self.twists.values())))
            self.twists.clear()
        return failed

    def drive(self, robot: Robot, twist: Twist) -> None:
        """Within an action: a velocity, in place of whatever was commanded before it."""
        self.twists[robot.index] = twist

    def undrive(self, robot: Robot) -> None:
        """Within an action: another kind of command follows in place of a velocity."""
        self.twists.pop(robot.index, None)


class Device(Protocol):
    """One device of one robot."""

    addr: DeviceAddr
    robot: Robot

    def publish(self) -> Iterable[tuple[int, bytes]]:
        """This tick's data: subtypes and encoded payloads. Called for subscribed devices only."""
        ...

    def command(self, name: str, values: Values) -> None:
        """Obey a command; commands that a device does not know are passed over, as in Player."""
        ...

    def request(self, name: str, values: Values) -> Values | None:
        """Answer a request: the fields of its ACK, None for an empty one. Raises Refused."""
        ...


def sane(*numbers: float) -> bool:
    """Whether these can be granted as they are: finite, and not absurd."""
    return max(numbers) <= FARTHEST and min(numbers) >= -FARTHEST and finite(*numbers)


def finite(*numbers: float) -> bool:
    """Whether these are numbers at all."""
    return all(map(math.isfinite, numbers))


def limited(number: float) -> float:
    """A finite number, cut to what can be calculated with."""
    return min(FARTHEST, max(-FARTHEST, number))


def scaled(x: float, y: float) -> tuple[float, float]:
    """Two finite numbers that go together, cut likewise: their ratio stays."""
    most = max(abs(x), abs(y))
    return (x, y) if most <= FARTHEST else (x * (FARTHEST / most), y * (FARTHEST / most))


def heading(angle: float) -> float:
    """A finite angle in radians; an absurd one without its whole turns."""
    return angle if abs(angle) <= FARTHEST else math.remainder(angle, math.tau)


def flat_pose(x: float = 0.0, y: float = 0.0, yaw: float = 0.0) -> tuple[float, ...]:
    """A planar pose as Player's pose3d: x, y, z, roll, pitch, yaw."""
    return (x, y, 0.0, 0.0, 0.0, yaw)
