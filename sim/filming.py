"""The video and the picture of a run: what there is to show, drawn whenever a frame is due."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sim.showing import Backdrops, backdrop_of, drawings_of, movables_of, shape_of
from sim.video.layers import Layer, layers_of
from sim.video.snapshot import Backdrop, Shape
from sim.view.present import ENDED, Present

if TYPE_CHECKING:
    from sim.build import LoadedWorld
    from sim.engine import Engine
    from sim.video.recorder import Recorder
    from sim.video.still import Still


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


def present_of(
    engine: Engine, movables: list[tuple[Shape, int]], backdrop: Backdrop | None
) -> Present:
    """What there is to show of a run, now."""
    scenery, robots = engine.scenery, engine.robots
    paints = scenery.floor.painted_area > 0.0
    return Present(
        time=engine.time,
        tick=engine.ticks,
        names=[robot.name for robot in robots],
        models=[robot.model for robot in robots],
        poses=scenery.stage.poses,
        colors=np.array([robot.color for robot in robots], np.int64),
        settled=np.array([robot.record.state in ENDED for robot in robots], bool),
        stalls=scenery.stage.stalls,
        said=[robot.record.said[-1] if robot.record.said else None for robot in robots],
        drawings=drawings_of([robot.drawings for robot in robots], scenery.stage.poses),
        groups=scenery.suite.groups,
        movables=movables,
        movable_poses=scenery.stage.movable_poses,
        floor=scenery.floor.owner if paints else None,
        resolution=scenery.floor.resolution,
        coverage=scenery.floor.coverage if paints else None,
        backdrop=backdrop,
    )


class Film:
    """Hands what there is to show to the video whenever a frame is due, and to the picture once."""

    def __init__(self, recorder: Recorder | None = None, still: Still | None = None) -> None:
        self.recorder = recorder
        self.still = still
        self.robots = 0
        self.movables: list[tuple[Shape, int]] | None = None
        self.backdrops: Backdrops | None = None

    @property
    def error(self) -> str | None:
        """Why the video or the picture is not what it should be, None while all is well."""
        errors = [each.error for each in (self.recorder, self.still) if each and each.error]
        return "\n".join(errors) or None

    @property
    def done(self) -> bool:
        """Whether nothing is to be drawn any more, whatever comes."""
        video = self.recorder is not None and self.recorder.error is None
        return not video and (self.still is None or self.still.taken)

    def each_tick(self, engine: Engine) -> None:
        """Draw what is due of a run."""
        self.shoot(engine.time, partial(self.look, engine), lambda: not engine.crew.interrupted)

    def look(self, engine: Engine) -> Present:
        """What there is to show of a run."""
        if self.movables is None or self.backdrops is None:
            self.movables = movables_of(engine.loaded)
            self.backdrops = Backdrops(engine.loaded)
        backdrop = self.backdrops.of(engine.scenery.stage.layout)
        return present_of(engine, self.movables, backdrop)

    def shoot(
        self,
        time: float,
        look: Callable[[], Present],
        going_on: Callable[[], bool] = lambda: True,
    ) -> None:
        """Draw what is due at a simulated time; `look` is asked only then.

        `going_on`: see `sim.video.recorder.Recorder.frame`.
        """
        video = self.recorder is not None and self.recorder.wants(time)
        still = self.still is not None and self.still.wants(time)
        if not (video or still):
            return
        present = look()
        self.admit(present)
        snapshot = present.snapshot()
        if video and self.recorder is not None:
            self.recorder.frame(snapshot, going_on=going_on)
        if still and self.still is not None:
            self.still.take(snapshot)

    def admit(self, present: Present) -> None:
        """Make robots known that have entered."""
        for name, model in zip(
            present.names[self.robots :], present.models[self.robots :], strict=True
        ):
            for each in (self.recorder, self.still):
                if each is not None:
                    each.add_robot(name, shape_of(model.body))
        self.robots = len(present.names)

    def finish(self, engine: Engine | None) -> None:
        """The last frame shows how the run ended; then the files are completed."""
        self.end(self.look(engine) if engine is not None and engine.ticks else None)

    def end(self, present: Present | None) -> None:
        """Show how it ended, if it has begun, and complete the files."""
        snapshot = None
        if present is not None:
            self.admit(present)
            snapshot = present.snapshot()
        if self.still is not None and snapshot is not None:
            self.still.take(snapshot, last=True)
        if self.recorder is not None:
            if snapshot is not None:
                self.recorder.frame(snapshot, last=True)
            self.recorder.close()
