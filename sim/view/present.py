"""All of a run that can be shown at the end of a tick, while it goes on or from its log."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sensors.readings import Blobs, Scans
from sim.video.snapshot import MOST_SCANS, Backdrop, Drawing, Scan, Shape, Sighting, Snapshot

if TYPE_CHECKING:
    from sensors.suite import Group

ENDED = frozenset({"finished", "failed", "hung", "lost"})
"""States of a controller that drives nobody any more."""


@dataclass(frozen=True)
class Present:
    """One moment. Arrays are over robots in the order in which they entered; read them at once."""

    time: float
    """Simulated seconds."""
    tick: int
    names: Sequence[str]
    models: Sequence[Any]
    """(n,) as the world file has them."""
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
    drawings: Sequence[Drawing]
    """What programs have drawn."""
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
    backdrop: Backdrop | None
    """What stands, where hands have moved something; None: as at the start."""

    def snapshot(self) -> Snapshot:
        """What a picture or a video shows of it."""
        return Snapshot(
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
            drawings=self.drawings,
            backdrop=self.backdrop,
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
