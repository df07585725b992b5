"""The video of a run: what the engine knows, put into frames when one is due."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sensors.readings import Scans
from sim.stage.geometry import outline, placed
from sim.video.view import MOST_SCANS, Backdrop, Drawing, FrameView, Scan

if TYPE_CHECKING:
    from sim.engine import Engine
    from sim.stage.layout import Layout
    from sim.video.recorder import Recorder
    from sim.worldfile import LoadedWorld


def open_recorder(
    path: Path,
    loaded: LoadedWorld,
    *,
    fps: float | None = None,
    speed: float | None = None,
    size: tuple[int, int] | None = None,
) -> Recorder:
    """Open the video before the run starts; raises VideoError where that cannot be."""
    from sim.video.recorder import FPS, SPEED, Recorder  # noqa: PLC0415 - loads OpenCV

    backdrop = backdrop_of(loaded.layout, loaded.world.name or loaded.path.stem)
    return Recorder(
        path,
        backdrop,
        fps=FPS if fps is None else fps,
        speed=SPEED if speed is None else speed,
        size=size,
    )


def backdrop_of(layout: Layout, title: str) -> Backdrop:
    """What never moves."""
    return Backdrop(
        size=layout.size,
        solids=[(solid.vertices, solid.color) for solid in layout.solids],
        doors=[door.rectangle for door in layout.doors],
        title=title,
    )


class Film:
    """Hands the recorder a view of the engine whenever a frame is due."""

    def __init__(self, recorder: Recorder) -> None:
        self.recorder = recorder
        self.robots = 0
        self.movables: list[tuple[Any, int]] | None = None

    def each_tick(self, engine: Engine) -> None:
        """Draw a frame if one is due."""
        if self.recorder.wants(engine.time):
            self.recorder.frame(self.view(engine))

    def finish(self, engine: Engine | None) -> None:
        """The last frame shows how the run ended; then the file is completed."""
        if engine is not None and engine.ticks:
            self.recorder.frame(self.view(engine), last=True)
        self.recorder.close()

    def view(self, engine: Engine) -> FrameView:
        """The moment that the engine is at."""
        scenery = engine.scenery
        for robot in engine.robots[self.robots :]:
            body = robot.model.body
            shape = body.radius if body.shape == "circle" else outline(body)
            self.recorder.add_robot(robot.name, shape)
        self.robots = len(engine.robots)
        if self.movables is None:
            self.movables = [
                (m.body.radius if m.body.shape == "circle" else outline(m.body), m.color)
                for m in engine.loaded.layout.movables
            ]
        paints = scenery.floor.painted_area > 0.0
        return FrameView(
            time=engine.time,
            speed=engine.speed,
            poses=scenery.stage.poses,
            colors=np.array([robot.color for robot in engine.robots], np.int64),
            coverage=scenery.floor.coverage if paints else None,
            said=[r.record.said[-1][1] if r.record.said else "" for r in engine.robots],
            scans=self.scans(engine),
            floor=scenery.floor.owner if paints else None,
            resolution=scenery.floor.resolution,
            movables=self.movables,
            movable_poses=scenery.stage.movable_poses,
            drawings=self.drawings(engine),
        )

    def scans(self, engine: Engine) -> list[Scan]:
        """The fans of the lasers that somebody reads."""
        fans: list[Scan] = []
        for group in engine.scenery.suite.groups:
            readings = group.readings
            if not isinstance(readings, Scans):
                continue
            for row in group.rows[:MOST_SCANS]:
                fans.append(
                    Scan(
                        int(group.robots[row]),
                        group.origins[row],
                        readings.fov,
                        readings.ranges[row],
                    )
                )
        return fans

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
