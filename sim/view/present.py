"""All of a run that can be shown at the end of a tick, while it goes on or from its log."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from sensors.readings import Blobs, Scans
from sim.stage.geometry import placed
from sim.video.view import MOST_SCANS, Drawing, FrameView, Scan, Shape, Sighting

if TYPE_CHECKING:
    from sensors.suite import Group
    from sim.worldfile.schema import Model

ENDED = frozenset({"finished", "failed", "hung", "lost"})
"""States of a controller that drives nobody any more."""
FARTHEST = 1e6
"""Metres: figures that reach beyond are not drawn."""


class Figure(Protocol):
    """A shape of graphics2d in its robot's frame: see `sim.robot.Drawing`."""

    @property
    def kind(self) -> str: ...
    @property
    def points(self) -> NDArray[np.float64]: ...
    @property
    def color(self) -> int: ...
    @property
    def fill_color(self) -> int | None: ...


@dataclass(frozen=True)
class Present:
    """One moment. Arrays are over robots in the order in which they entered; read them at once."""

    time: float
    """Simulated seconds."""
    tick: int
    names: Sequence[str]
    models: Sequence[Model]
    poses: NDArray[np.float64]
    """(n, 3) x, y, yaw: m, rad."""
    colors: NDArray[np.int64]
    """(n,) 0xRRGGBB."""
    settled: NDArray[np.bool_]
    """(n,) whether nobody drives the robot any more, as its controller has ended."""
    stalls: NDArray[np.bool_]
    """(n,) whether each is kept from what it wants to do."""
    said: Sequence[tuple[float, str] | None]
    """(n,) when (s) and what each said last."""
    figures: Sequence[Sequence[Figure]]
    """(n,) what each one's program has drawn."""
    groups: Sequence[Group]
    """All sensors, with what they sensed at this tick."""
    movables: Sequence[tuple[Shape, int]]
    """Shape and 0xRRGGBB of every thing that can be pushed."""
    movable_poses: NDArray[np.float64]
    """(m, 3) x, y, yaw of these."""
    floor: NDArray[np.int16] | None
    """(rows, columns) 1 + the robot that painted each cell last, 0: bare; None: nothing painted."""
    resolution: float
    """Metres of a cell of the floor."""
    coverage: float | None
    """The painted share of the floor; None where nothing is painted."""

    def frame(self) -> FrameView:
        """What a picture or a video shows of it."""
        return FrameView(
            time=self.time,
            poses=self.poses,
            colors=self.colors,
            coverage=self.coverage,
            said=[line[1] if line else "" for line in self.said],
            said_at=[line[0] if line else 0.0 for line in self.said],
            settled=self.settled,
            scans=self.scans(),
            sightings=self.sightings(),
            floor=self.floor,
            resolution=self.resolution,
            movables=self.movables,
            movable_poses=self.movable_poses,
            drawings=self.drawings(),
        )

    def scans(self) -> list[Scan]:
        """The fans of the lasers that somebody reads."""
        fans: list[Scan] = []
        for group in self.groups:
            readings = group.readings
            if isinstance(readings, Scans):
                for row in self._at_work(group):
                    robot, origin = int(group.robots[row]), group.origins[row]
                    fans.append(Scan(robot, origin, readings.fov, readings.ranges[row]))
        return fans

    def sightings(self) -> list[Sighting]:
        """What the blobfinders see that somebody reads."""
        seen: list[Sighting] = []
        for group in self.groups:
            readings, settings = group.readings, group.settings
            if not isinstance(readings, Blobs) or not hasattr(settings, "fov"):
                continue
            fov = math.radians(settings.fov)
            for row in self._at_work(group):
                blobs = readings.seen(int(row))
                # Columns are counted from the left; each is fov / width wide.
                ends = np.stack([blobs["right"].astype(float) + 1, blobs["left"]], axis=1)
                bearings = fov / 2 - ends * (fov / readings.width)
                robot = int(group.robots[row])
                seen.append(Sighting(robot, group.origins[row], bearings, blobs["color"]))
        return seen

    def _at_work(self, group: Group) -> NDArray[np.int64]:
        """The rows that were sensed in this tick, of robots that are driven, as many as show."""
        rows: NDArray[np.int64] = group.rows[~self.settled[group.robots[group.rows]]]
        return rows[:MOST_SCANS]

    def drawings(self) -> list[Drawing]:
        """What programs have drawn, in world coordinates."""
        drawn: list[Drawing] = []
        for robot, figures in enumerate(self.figures):
            for figure in figures:
                points = np.array(figure.points, float).reshape(-1, 2)
                if not np.isfinite(points).all() or np.abs(points).max(initial=0.0) > FARTHEST:
                    continue
                kind: Any = figure.kind
                fill = figure.fill_color
                at = placed(points, self.poses[robot])
                drawn.append(Drawing(kind, at, figure.color, fill is not None, fill))
        return drawn
