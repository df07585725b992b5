"""The video and the picture of a run: what the engine knows, put into snapshots when one is due."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sensors.readings import Blobs, Scans
from sim.silhouette import silhouette
from sim.stage.boundary import touchable
from sim.stage.geometry import placed
from sim.video.layers import Layer, layers_of
from sim.video.palette import GROUND, mix
from sim.video.snapshot import MOST_SCANS, Backdrop, Drawing, Scan, Shape, Sighting, Snapshot

if TYPE_CHECKING:
    from sim.build import LoadedWorld
    from sim.engine import Engine
    from sim.stage.standing import Look
    from sim.video.recorder import Recorder
    from sim.video.still import Still

PALE = 0.6
"""The share of the ground's colour in that of things which robots can drive over or under."""
ENDED = frozenset({"finished", "failed", "hung", "lost"})
"""States of a controller that drives nobody any more."""


def open_recorder(
    path: Path,
    loaded: LoadedWorld,
    *,
    fps: float | None = None,
    speed: float | None = None,
    size: tuple[int, int] | None = None,
    show: Iterable[str] | None = None,
) -> Recorder:
    """Open the video before the run starts; what is None is as the world has it.

    Raises VideoError where it cannot be.
    """
    from sim.video.recorder import Recorder  # noqa: PLC0415 - loads OpenCV

    told = loaded.world.video
    return Recorder(
        path,
        backdrop_of(loaded),
        fps=told.fps if fps is None else fps,
        speed=told.speed if speed is None else speed,
        size=told.size if size is None else size,
        show=shown(loaded, show),
    )


def open_still(
    path: Path,
    loaded: LoadedWorld,
    *,
    at: float | None = None,
    size: tuple[int, int] | None = None,
    show: Iterable[str] | None = None,
) -> Still:
    """Prepare the picture of one moment, or of the end; raises VideoError where it cannot be."""
    from sim.video.still import Still  # noqa: PLC0415 - loads OpenCV

    size = loaded.world.video.size if size is None else size
    return Still(path, backdrop_of(loaded), at=at, size=size, show=shown(loaded, show))


def shown(loaded: LoadedWorld, show: Iterable[str] | None) -> frozenset[Layer]:
    """The layers to be shown: as told, else as the world has it."""
    return layers_of(loaded.world.video.show if show is None else show)


def backdrop_of(loaded: LoadedWorld) -> Backdrop:
    """What never moves.

    Of the boundary that which can be met: where a map has walls of its own along the edge, the
    boundary behind them is not shown.
    """
    layout, world = loaded.layout, loaded.world
    solids = [(one.vertices, one.look.color) for one in layout.solids if stops_robots(one.look)]
    marks = [
        (one.vertices, mix(one.look.color, GROUND, PALE))
        for one in layout.solids
        if not stops_robots(one.look)
    ]
    wall = world.boundary
    if wall is not None and layout.raster is not None and wall.shape == "size":
        count = len(layout.arena)
        pieces = touchable(layout.raster, layout.size, wall.thickness)
        solids = [(piece, wall.color) for piece in pieces] + solids[count:]
    return Backdrop(
        size=layout.size,
        low=layout.low,
        solids=solids,
        marks=marks,
        doors=[door.rectangle for door in layout.doors],
        title=world.name or loaded.path.stem,
    )


def stops_robots(look: Look) -> bool:
    """Whether a thing takes up floor: what does not is shown pale, and under the robots."""
    return look.solid and look.z == 0.0


def shape_of(body: Any) -> Shape:
    """A body's outline in its own frame, or its radius."""
    return body.radius if body.shape == "circle" else silhouette(body)


class Film:
    """Hands a snapshot to the video whenever a frame is due, and to the picture once."""

    def __init__(self, recorder: Recorder | None = None, still: Still | None = None) -> None:
        self.recorder = recorder
        self.still = still
        self.robots = 0
        self.movables: list[tuple[Shape, int]] | None = None

    @property
    def error(self) -> str | None:
        """Why the video or the picture is not what it should be, None while all is well."""
        errors = [each.error for each in (self.recorder, self.still) if each and each.error]
        return "\n".join(errors) or None

    def each_tick(self, engine: Engine) -> None:
        """Draw what is due."""
        video = self.recorder is not None and self.recorder.wants(engine.time)
        still = self.still is not None and self.still.wants(engine.time)
        if not (video or still):
            return
        snapshot = self.snapshot(engine)
        if video and self.recorder is not None:
            self.recorder.frame(snapshot, going_on=lambda: not engine.crew.interrupted)
        if still and self.still is not None:
            self.still.take(snapshot)

    def finish(self, engine: Engine | None) -> None:
        """The last frame shows how the run ended; then the files are completed."""
        snapshot = self.snapshot(engine) if engine is not None and engine.ticks else None
        if self.still is not None and snapshot is not None:
            self.still.take(snapshot, last=True)
        if self.recorder is not None:
            if snapshot is not None:
                self.recorder.frame(snapshot, last=True)
            self.recorder.close()

    def snapshot(self, engine: Engine) -> Snapshot:
        """The moment that the engine is at."""
        scenery = engine.scenery
        records = [robot.record for robot in engine.robots]
        for robot in engine.robots[self.robots :]:
            for each in (self.recorder, self.still):
                if each is not None:
                    each.add_robot(robot.name, shape_of(robot.model.body))
        self.robots = len(engine.robots)
        if self.movables is None:
            self.movables = [(shape_of(m.body), m.color) for m in engine.loaded.layout.movables]
        paints = scenery.floor.painted_area > 0.0
        settled = np.array([record.state in ENDED for record in records], bool)
        return Snapshot(
            time=engine.time,
            poses=scenery.stage.poses,
            colors=np.array([robot.color for robot in engine.robots], np.int64),
            coverage=scenery.floor.coverage if paints else None,
            said=[record.said[-1][1] if record.said else "" for record in records],
            said_at=[record.said[-1][0] if record.said else 0.0 for record in records],
            settled=settled,
            scans=self.scans(engine, settled),
            sightings=self.sightings(engine, settled),
            floor=scenery.floor.owner if paints else None,
            resolution=scenery.floor.resolution,
            movables=self.movables,
            movable_poses=scenery.stage.movable_poses,
            drawings=self.drawings(engine),
        )

    def scans(self, engine: Engine, settled: NDArray[np.bool_]) -> list[Scan]:
        """The fans of the lasers that somebody reads."""
        fans: list[Scan] = []
        for group in engine.scenery.suite.groups:
            readings = group.readings
            if not isinstance(readings, Scans):
                continue
            rows = group.rows[~settled[group.robots[group.rows]]]
            for row in rows[:MOST_SCANS]:
                fans.append(
                    Scan(
                        int(group.robots[row]),
                        group.origins[row],
                        readings.fov,
                        readings.ranges[row],
                    )
                )
        return fans

    def sightings(self, engine: Engine, settled: NDArray[np.bool_]) -> list[Sighting]:
        """What the blobfinders see that somebody reads."""
        seen: list[Sighting] = []
        for group in engine.scenery.suite.groups:
            readings, settings = group.readings, group.settings
            if not isinstance(readings, Blobs) or not hasattr(settings, "fov"):
                continue
            fov = math.radians(settings.fov)
            rows = group.rows[~settled[group.robots[group.rows]]]
            for row in rows[:MOST_SCANS]:
                blobs = readings.seen(int(row))
                # Columns are counted from the left; each is fov / width wide.
                ends = np.stack([blobs["right"].astype(float) + 1, blobs["left"]], axis=1)
                bearings = fov / 2 - ends * (fov / readings.width)
                robot = int(group.robots[row])
                seen.append(Sighting(robot, group.origins[row], bearings, blobs["color"]))
        return seen

    def drawings(self, engine: Engine) -> list[Drawing]:
        """What programs have drawn, in world coordinates."""
        drawn: list[Drawing] = []
        for robot in engine.robots:
            pose = engine.scenery.stage.poses[robot.index]
            for shape in robot.drawings:
                points = np.array(shape.points, float).reshape(-1, 2)
                if not np.isfinite(points).all() or np.abs(points).max(initial=0.0) > 1e6:
                    continue
                drawn.append(
                    Drawing(
                        shape.kind,  # type: ignore[arg-type]
                        placed(points, pose),
                        shape.color,
                        shape.fill_color is not None,
                        shape.fill_color,
                    )
                )
        return drawn
