"""What pages are told in words and numbers, besides what can be drawn: of a run, or of its log."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypedDict


class Status(TypedDict):
    """Of the whole run."""

    paused: bool
    pace: float | None
    """Simulated seconds per second; None: flat out."""
    seed: int
    waiting: Sequence[Sequence[Any]]
    """For whom the world waits, and for how long: names and wall-clock seconds."""
    running: int
    """Controllers that run."""
    coverage: float | None
    """Painted share of the floor, 0 to 1; None: nobody paints."""
    contacts: int
    ended: int
    """Controllers that have ended."""
    outcome: str | None
    """How the run has ended; None: it goes on, or this is a log."""


class Controller(TypedDict):
    """Of a robot's controller; texts are empty where a log does not know."""

    kind: str
    state: str
    exit_code: int | None
    error: str | None


class Waits(TypedDict):
    """How long the world waited for a controller."""

    now: float | None
    """Seconds so far; None: it does not wait."""
    ticks: Sequence[float]
    longest: float
    """Milliseconds, as `ticks`."""


class Card(TypedDict):
    """Of one robot, for whoever has selected it. None: a log does not keep that."""

    name: str
    model: str
    pose: list[float]
    twist: list[float]
    """x, y, yaw in the world, and vx, vy, wz of the robot: metres, radians, and per second."""
    odometry: list[float] | None
    error: list[float] | None
    """The pose that it believes to have, and by how much that is wrong in the world."""
    command: Sequence[Any]
    """Its kind in words, and its numbers."""
    stalled: bool
    distance: float | None
    stalls: int | None
    contacts: int
    controller: Controller
    waits: Waits | None
    drivable: bool
    takable: bool
    taken: bool
    """Whether a hand can drive it, can take it from its controller, and has done so."""
    devices: list[str] | None
    properties: Mapping[str, Any]
    said: list[list[Any]]
    """Seconds and words."""
    output: list[str]
    sensors: Sequence[Mapping[str, Any]]
    """See `readings.described`."""
