"""What a run leaves: the numbers, as objects and as the JSON that the command line prints."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from html import escape
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from sim.strictjson import plain

Outcome = Literal["completed", "time_limit", "controller_failed", "interrupted"]
ControllerState = Literal["running", "finished", "failed", "hung", "lost", "none"]


DOUBLE = np.dtype("<f8")


class Digest:
    """SHA-256 over, per tick and in robot order, x, y and yaw as little-endian doubles."""

    def __init__(self) -> None:
        self.hash = hashlib.sha256()

    def add(self, poses: NDArray[np.float64]) -> None:
        """Take one tick's poses, shape (robots, 3): metres and radians."""
        self.hash.update(np.ascontiguousarray(poses, DOUBLE).data)

    def text(self) -> str:
        return "sha256:" + self.hash.hexdigest()


@dataclass
class RobotRecord:
    """One robot's part of the result. Poses are (x, y, yaw) in the world frame, yaw in radians."""

    name: str
    model: str
    entered: float
    start: tuple[float, float, float]
    pose: tuple[float, float, float]
    state: ControllerState
    distance: float = 0.0
    stalls: int = 0
    contacts: int = 0
    exit_code: int | None = None
    error: str | None = None
    devices: list[str] = field(default_factory=list)
    properties: dict[str, Any] = field(default_factory=dict)
    said: list[tuple[float, str]] = field(default_factory=list)

    def as_json(self) -> dict[str, Any]:
        return {
            "name": self.name,
            "model": self.model,
            "entered": self.entered,
            "start": list(self.start),
            "pose": list(self.pose),
            "distance": self.distance,
            "stalls": self.stalls,
            "contacts": self.contacts,
            "controller": {
                "state": self.state,
                "exit_code": self.exit_code,
                "error": self.error,
            },
            "devices": list(self.devices),
            "properties": dict(self.properties),
            "said": [[time, text] for time, text in self.said],
        }


@dataclass
class FloorRecord:
    """The paint layer at the end of a run; areas in square metres."""

    coverage: float
    painted_area: float
    passes: float


@dataclass
class DoorRecord:
    """What came in through a door, and at the end of which steps."""

    name: str
    emitted: int
    steps: list[int]


@dataclass(frozen=True)
class Touch:
    """What a hand did to a run, between tick number `tick` and the next.

    `what`: put (the robot to a pose x, y, yaw), put_thing (`robot` is the thing's number: movable
    ones come first),
    drive (a twist vx, vy, wz), take (the robot from its controller), give (it back), pause.
    Metres, radians, and either per second.
    """

    time: float
    tick: int
    robot: str | None
    what: str
    numbers: tuple[float, ...] = ()

    def as_json(self) -> dict[str, Any]:
        found = {"time": self.time, "tick": self.tick, "robot": self.robot, "what": self.what}
        return {**found, "numbers": list(self.numbers)}


@dataclass
class Result:
    """Everything that `troupe run --json` prints; times in seconds."""

    world: str
    seed: int
    outcome: Outcome
    sim_time: float
    wall_time: float
    ticks: int
    digest: str
    robots: list[RobotRecord]
    floor: FloorRecord
    doors: list[DoorRecord]
    times: NDArray[np.float64] | None = None
    """(ticks,) simulated seconds, where trajectories were asked for."""
    poses: NDArray[np.float64] | None = None
    """(ticks, n, 3) x, y, yaw after each tick; NaN before a robot has entered."""
    touched: list[Touch] = field(default_factory=list)
    """What somebody did by hand: with it the digest is another one."""

    @property
    def speed(self) -> float:
        """Simulated seconds per second of wall-clock time."""
        return self.sim_time / self.wall_time if self.wall_time > 0 else 0.0

    @property
    def exit_code(self) -> int:
        """The command's exit code: 0 completed, 1 ended short, 130 interrupted."""
        return {"completed": 0, "interrupted": 130}.get(self.outcome, 1)

    def robot(self, name: str) -> RobotRecord:
        """The record of the robot of that name (KeyError where there is none)."""
        for record in self.robots:
            if record.name == name:
                return record
        raise KeyError(name)

    def to_dataframe(self) -> Any:
        """The trajectories as a pandas frame (time, robot, x, y, yaw), a row per robot and tick.

        Without trajectories a row per robot, of what the result tells of it. Raises ImportError
        where pandas is not installed.
        """
        import pandas as pd  # noqa: PLC0415 - an extra

        if self.poses is None or self.times is None:
            return pd.json_normalize([record.as_json() for record in self.robots], sep="_")
        ticks, count, _ = self.poses.shape
        frame = pd.DataFrame(self.poses.reshape(-1, 3), columns=["x", "y", "yaw"])
        frame.insert(0, "robot", [record.name for record in self.robots] * ticks)
        frame.insert(0, "time", np.repeat(self.times, count))
        return frame.dropna(ignore_index=True)

    def _repr_html_(self) -> str:
        """A table of the robots, where a notebook shows the result."""
        head = f"{self.world}, seed {self.seed}: {self.outcome} after {self.sim_time:g} s"
        titles = ("robot", "controller", "way", "contacts", "stalls")
        rows = [
            (escape(one.name), one.state, f"{one.distance:.2f} m", one.contacts, one.stalls)
            for one in self.robots
        ]
        lines = [f"<tr>{''.join(f'<th>{title}</th>' for title in titles)}</tr>"]
        lines += [f"<tr>{''.join(f'<td>{cell}</td>' for cell in row)}</tr>" for row in rows]
        return f"<p>{escape(head)}</p><table>{''.join(lines)}</table>"

    def as_json(self) -> dict[str, Any]:
        """The JSON object as documented in docs/running.md: whatever was reported, it is valid."""
        found: dict[str, Any] = plain(self.fields())
        return found

    def fields(self) -> dict[str, Any]:
        """The same, with all numbers and texts as they are."""
        return {
            "world": self.world,
            "seed": self.seed,
            "outcome": self.outcome,
            "sim_time": self.sim_time,
            "wall_time": round(self.wall_time, 3),
            "speed": round(self.speed, 1),
            "ticks": self.ticks,
            "digest": self.digest,
            "robots": [record.as_json() for record in self.robots],
            "floor": {
                "coverage": self.floor.coverage,
                "painted_area": self.floor.painted_area,
                "passes": self.floor.passes,
            },
            "doors": [
                {"name": door.name, "emitted": door.emitted, "steps": door.steps}
                for door in self.doors
            ],
            "touched": [touch.as_json() for touch in self.touched],
        }
