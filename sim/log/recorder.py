"""The log's one hook into a run: after every tick the engine's state is noted for the writer."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sim.log import commands
from sim.log.errors import LogError
from sim.log.events import News
from sim.log.moment import Floor, Painted, Touched
from sim.log.sensed import ALL, Sensed
from sim.log.tape import WATCH, Sheet, Source, Tape
from sim.log.world import attachments
from sim.log.writer import LogWriter, check_place
from sim.strictjson import dumps

if TYPE_CHECKING:
    from sim.build import LoadedWorld
    from sim.engine import Engine
    from sim.result import Result

CONTACTS, COLORS = 2, 1
"""Of the bits for what is watched."""
NO_PAINT = math.nan
OF_ROBOTS = ("odometry", "commands")
"""What a log can hold of all robots besides their sensors' readings."""


def open_log(
    path: Path, loaded: LoadedWorld, sensors: Sequence[str], about: Mapping[str, str]
) -> Recorder:
    """Open the log of a run before it starts.

    sensors: `all`, or the types of those whose readings are kept (`laser`, `blobfinder`, ...,
    `odometry`, `commands`). about: what runs, as texts. Raises LogError for what cannot be.
    """
    check_request(path, loaded, sensors)
    writer = LogWriter(
        path,
        f"troupe {about.get('version', '')}".strip(),
        about,
        with_twists=ALL in sensors or "commands" in sensors,
    )
    try:
        for name, kind, data in attachments(loaded):
            writer.attach(name, kind, data)
    except LogError:
        writer.drop()
        raise
    return Recorder(writer, loaded, frozenset(sensors))


def check_request(path: Path, loaded: LoadedWorld, sensors: Sequence[str]) -> None:
    """Raises LogError for a log that cannot be asked for."""
    from sensors.registry import SENSORS  # noqa: PLC0415

    own = {
        str(getattr(sensor, "type", ""))
        for m in loaded.world.models.values()
        for sensor in m.sensors
    }
    known = [*SENSORS, *OF_ROBOTS]
    for name in sensors:
        if name != ALL and name not in known and name not in own:
            allowed = ", ".join([ALL, *known])
            raise LogError(f"log sensors: there is no {name!r}; allowed: {allowed}")
    check_place(path)


class Recorder:
    """Notes each tick's state on the writer's tapes, and hands it what has happened besides."""

    def __init__(self, writer: LogWriter, loaded: LoadedWorld, sensors: frozenset[str]) -> None:
        self.writer = writer
        self.complain: Callable[[str], None] | None = None
        """Told once where the log ends early."""
        self.news = News(loaded)
        self.sensed = Sensed(sensors)
        self.distances = np.zeros(0)
        self.count = 0  # robots of which the tape has rows
        self.counted = np.zeros(0, np.int64)  # contacts, when some began last
        self.told = -1  # the stage's count of commands when they were last looked at
        self.reach: dict[tuple[int, int], float] = {}
        self.floor: Floor | None = None
        self.sprayed = False
        self.movables = len(loaded.layout.movables)
        self.movable_poses = np.zeros((self.movables, 3))
        self.tape: Tape | None = None
        self.commands = commands.fresh(0)  # the last ones that were noted
        self.low = loaded.layout.low
        self.keeps_readings = bool(sensors)
        self.wants_odometry = self.sensed.wants("odometry")

    def line(self, text: str) -> None:
        """Keep a line that was meant for people, of whatever thread."""
        self.news.line(text)

    def each_tick(self, engine: Engine) -> None:
        """Note the state at the end of a tick."""
        if self.writer.error is not None:
            self.tell()
            return
        scenery = engine.scenery
        stage, tape = scenery.stage, self.tape
        if self.news.any(engine):
            for event in self.news.since(engine):
                self.writer.put(event)
        if self.sprayed or engine.spraying.on:
            self.paint(engine)
        if self.movables:
            self.movable_poses[:] = stage.movable_poses
        if (
            tape is None
            or stage.count != self.count
            or (self.keeps_readings and self.sensed.moved(scenery.suite))
        ):
            tape = self.tape = self.writer.tape(self.sheet(engine))
        coverage = NO_PAINT
        if self.floor is not None and scenery.floor.painted_area > 0.0:
            coverage = scenery.floor.coverage
        told, self.told = stage.told != self.told, stage.told
        changes = tape.note(engine.ticks, self.news.time, coverage, told)
        if changes < 0:
            tape = self.tape = self.writer.tape(tape.sheet, tape)
            changes = tape.note(engine.ticks, self.news.time, coverage, told)
        if changes:
            self.changed(engine, changes)

    def changed(self, engine: Engine, changes: int) -> None:
        """Tell of sources that are watched and not as they were."""
        if changes & CONTACTS:
            self.touched(engine)
        if changes & COLORS:
            for event in self.news.recolored(engine):
                self.writer.put(event)

    def touched(self, engine: Engine) -> None:
        """Tell who began to touch something, and where."""
        stage = engine.scenery.stage
        counts = stage.contact_counts.copy()
        before = np.zeros_like(counts)
        before[: len(self.counted)] = self.counted
        self.counted = counts
        robots, points = stage.contact_points_of(np.flatnonzero(counts != before))
        if len(robots):
            self.writer.put(Touched(engine.ticks, engine.time, robots, points))

    def sheet(self, engine: Engine) -> Sheet:
        """What is to be noted of each tick from now on."""
        stage, scene = engine.scenery.stage, engine.scenery.scene
        self.count = stage.count
        self.commands = np.concatenate(
            [self.commands, commands.fresh(self.count - len(self.commands))]
        )
        counts, colors = stage.contact_counts, scene.colors
        seen = np.zeros_like(counts)
        seen[: len(self.counted)] = self.counted
        entities = np.array([robot.entity for robot in engine.robots], np.int64)
        sources = [
            Source("poses", stage.poses),
            Source("velocities", stage.velocities),
            Source("contacts", counts),
            Source("stalls", stage.stalls),
            Source("colors", colors, rows=entities),
            Source("movables", self.movable_poses),
            Source("new contacts", counts, WATCH, other=seen),
            Source("new colors", colors, WATCH, other=~colors),  # as if all were new
        ]
        if self.wants_odometry:
            sources.append(Source("odometry", engine.scenery.odometry.poses))
        readings, read = self.sensed.look(engine.scenery.suite, self.news.names)
        sources += readings
        return Sheet(self.news.names, sources, stage.records, self.commands, self.movables, read)

    def finish(self, engine: Engine | None, result: Result | None) -> None:
        """Write the rest and the result; the file is whole. Of a run that failed before its
        first tick nothing is kept: what stood in the file stands there."""
        if engine is None or (result is None and not engine.ticks):
            self.writer.drop()
            return
        if self.writer.error is None:
            for event in self.news.since(engine, last=True):
                self.writer.put(event)
        rest = {} if result is None else {"result.json": dumps(result.as_json()).encode()}
        self.writer.close(rest)
        self.tell()

    def tell(self) -> None:
        """Say once from when the log is missing."""
        if self.complain is not None and self.writer.error is not None:
            complain, self.complain = self.complain, None
            complain(self.writer.error)

    def paint(self, engine: Engine) -> None:
        """Hand over the floor where it may have been painted in this tick."""
        windows = self.windows(engine)
        size = sum(window.nbytes for _, _, window in windows)
        self.writer.put(Painted(engine.ticks, engine.time, windows), size)

    def windows(self, engine: Engine) -> list[tuple[int, int, NDArray[np.int16]]]:
        """Copies of the floor around all that may have been painted in this tick."""
        floor, stage = engine.scenery.floor, engine.scenery.stage
        owner, cell = floor.owner, floor.resolution
        if self.floor is None:
            self.floor = Floor(owner.shape[0], owner.shape[1], cell, self.low)
            self.writer.put(self.floor)
        self.sprayed = bool(engine.spraying.on)
        gone = stage.distances
        found = []
        for carrier, number, sprayer in engine.spraying.on:
            robot = carrier.index
            key = robot, number
            if key not in self.reach:
                mount = sprayer.mount
                half = 0.5 * math.hypot(*mount.size)
                self.reach[key] = math.hypot(*mount.offset) + half + 2 * cell
            before = self.distances[robot] if robot < len(self.distances) else 0.0
            # it was never farther from where it is now than it has gone in the tick
            far = self.reach[key] + float(gone[robot] - before)
            x, y = (stage.poses[robot, :2] - self.low).tolist()
            column, row = max(0, int((x - far) / cell)), max(0, int((y - far) / cell))
            last_column, last_row = int((x + far) / cell) + 1, int((y + far) / cell) + 1
            if last_column > 0 and last_row > 0:
                found.append((row, column, owner[row:last_row, column:last_column].copy()))
        self.distances = gone.copy()
        return found
