"""What of a moment shows, and where: decided once, for pixels and for SVG alike."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sim.video.bodies import Bodies, Placed, colors_of
from sim.video.callouts import Callout, named, place_callouts, speakers
from sim.video.layers import SHOWN, Layer
from sim.video.projection import check_size, default_size, project
from sim.video.scans import RING, RING_WIDTH
from sim.video.snapshot import MOST_SCANS, Backdrop, Scan, Shape, Sighting, Snapshot
from sim.video.text import Lettering, printable
from sim.video.trails import Trails, Ways

FILLED, LINED = 8, 20
"""Robots up to which their fans are filled, and up to which their edges show."""


@dataclass(frozen=True)
class Composition:
    """A snapshot with everything in its place: pixel coordinates count from pixels' edges."""

    snapshot: Snapshot
    fans: Literal["filled", "lines"]
    scans: list[Scan]
    trails: bool
    robots: list[Placed]
    colors: NDArray[np.int64]
    settled: NDArray[np.bool_]
    movables: list[Placed]
    movable_colors: NDArray[np.int64]
    sightings: list[Sighting]
    callouts: list[Callout]


class Composer:
    """Composes snapshots of one world. What comes out depends on them alone, in their order."""

    def __init__(
        self,
        backdrop: Backdrop,
        size: tuple[int, int] | None = None,
        *,
        show: frozenset[Layer] = SHOWN,
        speech_time: float = 30.0,
        axes: bool = False,
    ) -> None:
        """`size` in pixels, None: the world's aspect; what is said shows `speech_time` s."""
        self.backdrop = self._begun = backdrop
        self.size = default_size(backdrop.size) if size is None else check_size(size)
        self.axes = axes
        outlines = [vertices for vertices, _ in backdrop.solids]
        self.projection = project(backdrop.size, outlines, self.size, low=backdrop.low, axes=axes)
        self.lettering = Lettering(self.projection.unit)
        self.bodies = Bodies(self.projection)
        self.trails: Trails | Ways = Trails(self.projection)
        self._movables = Bodies(self.projection)
        self._names: list[str] = []
        self._show = show
        self._speech_time = speech_time
        self._marked_until = -np.inf

    def add_robot(self, name: str, shape: Shape) -> int:
        """Adds a robot by its outline (k, 2) m in its own frame, or its radius; its index."""
        self._names.append(printable(name, 24))
        return self.bodies.add(shape)

    def mark(self, time: float, poses: NDArray[np.float64]) -> None:
        """Adds the robots' places (n, 3) at a time to their trails, unless it is there already."""
        if time > self._marked_until and "trails" in self._show:
            self.trails.mark(poses)
            self._marked_until = time

    def compose(self, snapshot: Snapshot) -> Composition:
        """A snapshot with everything in its place; raises ValueError where its parts do not fit."""
        poses = np.asarray(snapshot.poses, dtype=float).reshape(-1, 3)
        count = len(poses)
        if count != len(self.bodies):
            raise ValueError(f"{len(self.bodies)} robots were added, but {count} poses given")
        settled = (
            np.zeros(count, bool)
            if len(snapshot.settled) == 0
            else np.asarray(snapshot.settled, bool)
        )
        if settled.shape != (count,):
            raise ValueError(
                f"{count} robots, but {len(settled)} of them told to be settled or not"
            )
        self.mark(snapshot.time, poses)
        self.backdrop = snapshot.backdrop or self._begun
        robots = self.bodies.place(poses)
        movables, movable_colors = self._place_movables(snapshot)
        return Composition(
            snapshot=snapshot,
            fans="filled" if count <= FILLED else "lines",
            scans=self._scans(snapshot, settled),
            trails="trails" in self._show,
            robots=robots,
            colors=colors_of(snapshot.colors, count),
            settled=settled,
            movables=movables,
            movable_colors=movable_colors,
            sightings=list(snapshot.sightings)[:MOST_SCANS] if "blobs" in self._show else [],
            callouts=self._callouts(snapshot, robots),
        )

    def _scans(self, snapshot: Snapshot, settled: NDArray[np.bool_]) -> list[Scan]:
        """The fans that show: of robots that are at work, in a company that is not too large."""
        if "fans" not in self._show or len(settled) > LINED:
            return []
        scans = [Scan(*scan) for scan in snapshot.scans[:MOST_SCANS]]
        return [scan for scan in scans if len(scan.ranges) and not settled[scan.robot]]

    def _place_movables(self, snapshot: Snapshot) -> tuple[list[Placed], NDArray[np.int64]]:
        for shape, _ in snapshot.movables[len(self._movables) :]:
            self._movables.add(shape, heading=False)
        if not snapshot.movables:
            return [], np.empty(0, np.int64)
        colors = colors_of([color for _, color in snapshot.movables], len(snapshot.movable_poses))
        return self._movables.place(np.asarray(snapshot.movable_poses, dtype=float)), colors

    def _callouts(self, snapshot: Snapshot, robots: list[Placed]) -> list[Callout]:
        names = named(self._names, self.bodies.radii) if "names" in self._show else []
        said = speakers(snapshot, self._speech_time) if "speech" in self._show else []
        if not names and not said:
            return []
        field = (self.projection.width, self.projection.field_height)
        boxes = self.bodies.boxes(robots)
        if "blobs" in self._show:
            room = (RING + RING_WIDTH) * self.projection.unit
            boxes += np.array([-room, -room, room, room])
        return place_callouts(names, said, boxes, self.bodies.radii, field, self.lettering)
