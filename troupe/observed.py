"""A run as it can be asked: how far it is, where its robots are, what they read, its picture."""

from __future__ import annotations

from dataclasses import dataclass, field
from time import perf_counter
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.engine import Engine, Settings, label
from troupe.readings import Place, Readings, find_sensor, readings_of

if TYPE_CHECKING:
    from sim.build import LoadedWorld
    from sim.result import ControllerState, Outcome, Result
    from sim.video.snapshot import Snapshot
    from troupe.filmed import Size

Floats = NDArray[np.float64]


class Entered(NamedTuple):
    """A robot's entry: its time (s), who entered, and its pose x, y (m), yaw (rad)."""

    time: float
    name: str
    model: str
    pose: tuple[float, float, float]


@dataclass
class Sensors:
    """The sensors that have been asked for by name, while the robots are these."""

    robots: int = 0
    places: dict[str, Place] = field(default_factory=dict)


class Observed:
    """What there is to see of the run of an engine; arrays that are given out are copies."""

    _loaded: LoadedWorld
    _settings: Settings
    _engine: Engine
    _sensors: Sensors
    _wall_time: float | None  # of a run that has been closed

    # -- what there is ------------------------------------------------------------------------

    @property
    def world(self) -> str:
        """The world's file, as results name it."""
        return label(self._loaded.path)

    @property
    def loaded(self) -> LoadedWorld:
        """The world, read and checked."""
        return self._loaded

    @property
    def time(self) -> float:
        """Simulated seconds."""
        return self._engine.time

    @property
    def ticks(self) -> int:
        """Intervals of the clock that have gone by."""
        return self._engine.ticks

    @property
    def interval(self) -> float:
        """Seconds of one step."""
        return self._engine.interval

    @property
    def seed(self) -> int:
        """The run's seed."""
        return self._settings.seed

    @property
    def outcome(self) -> Outcome | None:
        """How the run has ended, as in `Result.outcome`; None while it goes on."""
        return self._engine.ended or self._engine.outcome()

    @property
    def over(self) -> bool:
        """Whether there are no further steps."""
        return self.outcome is not None

    @property
    def names(self) -> list[str]:
        """The robots' names, in the order of their indices."""
        return [robot.name for robot in self._engine.robots]

    @property
    def entries(self) -> list[Entered]:
        """Of every robot: when it entered, its name, model and pose."""
        records = [robot.record for robot in self._engine.robots]
        return [Entered(one.entered, one.name, one.model, one.start) for one in records]

    @property
    def states(self) -> list[ControllerState]:
        """(n,) the state of each robot's controller, as in results."""
        return [robot.record.state for robot in self._engine.robots]

    @property
    def poses(self) -> Floats:
        """(n, 3) x, y in metres and yaw in radians, in the world: the truth."""
        return self._engine.scenery.stage.poses.copy()

    @property
    def velocities(self) -> Floats:
        """(n, 3) vx, vy in m/s and wz in rad/s, in each robot's frame, as the bodies move."""
        return self._engine.scenery.stage.velocities.copy()

    @property
    def movable_poses(self) -> Floats:
        """(m, 3) x, y, yaw of the obstacles that can be pushed."""
        return self._engine.scenery.stage.movable_poses.copy()

    @property
    def odometry(self) -> Floats:
        """(n, 3) x, y, yaw as each robot's position2d reports it."""
        return self._engine.scenery.odometry.poses.copy()

    @property
    def stalls(self) -> NDArray[np.bool_]:
        """(n,) whether each was kept from what it wanted to do in the last tick."""
        return self._engine.scenery.stage.stalls.copy()

    @property
    def contacts(self) -> NDArray[np.int64]:
        """(n,) how often each has begun to touch another body or a wall."""
        return self._engine.scenery.stage.contact_counts.copy()

    def floor(self) -> NDArray[np.int16] | None:
        """(rows, columns) who painted each cell last: 1 + robot, 0 for nobody; row 0 is at y = 0.

        None where nobody has painted.
        """
        floor = self._engine.scenery.floor
        return floor.owner.copy() if floor.painted_area > 0.0 else None

    def readings(self, sensor: str) -> Readings:
        """What a sensor (`laser`, `laser:1`) of every robot that has it reads now.

        Raises ValueError where no robot has it, or where the robots' sensors differ so much that
        their readings are no one array.
        """
        engine, known = self._engine, self._sensors
        suite = engine.scenery.suite
        if known.robots != len(suite.first_slot):  # robots have come in through a door
            known.robots = len(suite.first_slot)
            known.places.clear()
        place = known.places.get(sensor)
        if place is None:
            place = known.places[sensor] = find_sensor(suite, sensor)
            engine.sensing.want(place.slots)
        found = readings_of(place, sensor, self.time)
        suite.given.add(found)
        return found

    # -- what comes out of it -----------------------------------------------------------------

    def view(self) -> Snapshot:
        """What this moment shows, as plain arrays that are read at once."""
        from sim.filming import Film  # noqa: PLC0415

        return Film().look(self._engine).snapshot()

    def picture(self, size: Size | None = None) -> NDArray[np.uint8]:
        """This moment as an image (height, width, 3), red, green, blue.

        `size`: width and height in pixels, as (640, 840) or `"640x840"`.

        Raises sim.video.errors.VideoError for a size that cannot be.
        """
        from sim.showing import backdrop_of, shape_of  # noqa: PLC0415
        from sim.video.picture import Picture  # noqa: PLC0415 - loads OpenCV
        from sim.video.projection import parse_size  # noqa: PLC0415

        pixels = None if size is None else parse_size(size)
        picture = Picture(backdrop_of(self._loaded, self._engine.scenery.stage.layout), pixels)
        for robot in self._engine.robots:
            picture.add_robot(robot.name, shape_of(robot.model.body))
        return np.ascontiguousarray(picture.draw(self.view())[:, :, ::-1])

    def _repr_png_(self) -> bytes:
        """The present moment, where a notebook shows the simulation."""
        import cv2  # noqa: PLC0415

        return bytes(cv2.imencode(".png", self.picture()[:, :, ::-1])[1])

    def result(self) -> Result:
        """The run in numbers, as far as it has come; before its end it is `interrupted`."""
        wall_time = self._wall_time
        if wall_time is None:
            wall_time = perf_counter() - self._engine.began
        return self._engine.result(self.outcome or "interrupted", wall_time)
