"""The log's one hook into a run: after every tick it copies the engine's state for the writer."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sensors.readings import Blobs, Elements, Intensities, Scans
from sim.log.errors import LogError
from sim.log.frames import ros_name
from sim.log.moment import Event, Fans, Floor, SensorGroup, TickState
from sim.log.scene import body_event, map_event, wall_event
from sim.log.world import attachments
from sim.log.writer import LogWriter
from sim.strictjson import dumps

if TYPE_CHECKING:
    from sensors.suite import Group
    from sim.engine import Engine
    from sim.result import Result, RobotRecord
    from sim.robot import Robot
    from sim.worldfile import LoadedWorld

ALL = "all"
NOUNS = {"scan": "scan", "intensities": "scan", "elements": "range", "blobs": "blobs"}
"""How the topics of readings end, by their kind."""
OF_ROBOTS = ("odometry", "commands")
"""What a log can hold of all robots besides their sensors' readings."""
LEVELS = {"info": 20}


def open_log(
    path: Path, loaded: LoadedWorld, sensors: Sequence[str], about: Mapping[str, str]
) -> Recorder:
    """Open the log of a run before it starts.

    sensors: `all`, or the types of those whose readings are kept (`laser`, `blobfinder`, ...,
    `odometry`, `commands`). about: what runs, as texts. Raises LogError for what cannot be.
    """
    check_request(path, loaded, sensors)
    writer = LogWriter(path, f"troupe {about.get('version', '')}".strip(), about)
    try:
        for name, kind, data in attachments(loaded):
            writer.attach(name, kind, data)
    except LogError:
        writer.close({})
        path.unlink(missing_ok=True)
        raise
    writer.batches.with_twists = ALL in sensors or "commands" in sensors
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
    if path.suffix.lower() != ".mcap":
        raise LogError(f"{path}: a log is an MCAP file: name it *.mcap")


class Recorder:
    """Hands the writer a copy of each tick's state, and events where something has changed."""

    def __init__(self, writer: LogWriter, loaded: LoadedWorld, sensors: frozenset[str]) -> None:
        self.writer = writer
        self.loaded = loaded
        self.sensors = sensors
        self.complain: Callable[[str], None] | None = None
        """Told once where the log ends early."""
        self.time = 0.0
        self.lines: list[tuple[float, str]] = []  # for people, not yet in the log
        self.names: list[str] = []  # as ROS takes them
        self.records: list[RobotRecord] = []
        self.said: list[list[tuple[float, str]]] = []
        self.said_so_far = 0
        self.said_each: list[int] = []
        self.properties: list[dict[str, Any]] = []
        self.states: list[Any] = []
        self.colors: list[int] = []
        self.color_bytes = b""
        self.distances = np.zeros(0)
        self.contacts = b""
        self.told = -1  # the stage's count of commands when they were last looked at
        self.drawn: dict[int, list[Any]] = {}
        self.flags: Any = self
        self.known = (-1, -1)  # changes and ends that there had been when news were looked for
        self.groups: dict[int, SensorGroup | None] = {}
        self.reach: dict[tuple[int, int], float] = {}
        self.floor: Floor | None = None
        self.sprayed = False
        self.movables = len(loaded.layout.movables)
        self.wants_odometry = self.wants("odometry")
        for event in (wall_event(loaded.layout), map_event(loaded.layout)):
            writer.put(event, 0)

    def line(self, text: str) -> None:
        """Keep a line that was meant for people, of whatever thread."""
        self.lines.append((self.time, text))

    def each_tick(self, engine: Engine) -> None:
        """Take the state at the end of a tick."""
        if self.writer.error is not None:
            self.tell()
            return
        stage, scenery = engine.scenery.stage, engine.scenery
        self.time = time = engine.time
        events: list[Event] = []
        if len(engine.robots) != len(self.records):
            events += self.entered(engine)
        self.changed(engine, events)
        coverage = math.nan
        painted: Sequence[tuple[int, int, NDArray[np.int16]]] = ()
        if self.sprayed or engine.spraying.on:
            painted = self.windows(engine)
        if self.floor is not None and scenery.floor.painted_area > 0.0:
            coverage = scenery.floor.coverage
        contacts = stage.contact_counts.tobytes()
        touched = None
        if contacts != self.contacts:
            touched, self.contacts = stage.contact_points, contacts
        movers = b""
        if stage.told != self.told:
            movers, self.told = stage.records.tobytes(), stage.told
        state = TickState(
            engine.ticks,
            time,
            coverage,
            len(self.records),
            self.color_bytes,
            stage.poses.tobytes(),
            stage.velocities.tobytes(),
            stage.stalls.tobytes(),
            contacts,
            movers,
            stage.movable_poses.tobytes() if self.movables else b"",
            scenery.odometry.poses.copy() if self.wants_odometry else None,
            self.fans(engine) if self.sensors else (),
            events,
            painted,
            touched,
        )
        self.writer.put(state, size_of(state))

    def finish(self, engine: Engine | None, result: Result | None) -> None:
        """Write the rest and the result; the file is whole."""
        if engine is not None and self.writer.error is None:
            events: list[Event] = self.entered(engine)
            self.take_lines(events)
            self.recolored([robot.color for robot in engine.robots], events)
            self.reported(engine, events, engine.ticks + 1)
            if engine.ticks:
                events.append(last_event(engine))
            for event in events:
                self.writer.put(event, 0)
        rest = {} if result is None else {"result.json": dumps(result.as_json()).encode()}
        self.writer.close(rest)
        self.tell()

    def tell(self) -> None:
        """Say once from when the log is missing."""
        if self.complain is not None and self.writer.error is not None:
            complain, self.complain = self.complain, None
            complain(self.writer.error)

    def wants(self, what: str) -> bool:
        return what in self.sensors or ALL in self.sensors

    # --- what has changed

    def entered(self, engine: Engine) -> list[Event]:
        """Events of robots that are new."""
        events: list[Event] = []
        new = engine.robots[len(self.records) :]
        bodies = []
        for robot in new:
            record = robot.record
            name = ros_name(record.name, self.names)
            index = len(self.names)
            self.names.append(name)
            self.said.append(record.said)
            self.said_each.append(0)
            self.properties.append({})
            self.states.append(record.state)
            # a time is a multiple of the interval: those who are there at the start came at 0
            tick = round(record.entered / engine.interval)
            values = {
                "tick": tick,
                "robot": index,
                "name": record.name,
                "model": record.model,
                "controller": record.state,
                "pose": record.start,
            }
            events.append(Event(record.entered, "/troupe/entries", "troupe_msgs/Entry", values))
            bodies.append((index, name, robot.model.body, robot.color))
        if new:
            self.records = [robot.record for robot in engine.robots]
            self.writer.put(list(self.names), 0)
            events.append(body_event(self.time, bodies))
        return events

    def changed(self, engine: Engine, events: list[Event]) -> None:
        """Events of what is new besides the bodies' motion."""
        self.take_lines(events)
        colors = [robot.color for robot in engine.robots]
        if colors != self.colors:
            self.recolored(colors, events)
        if engine.scenery.stage.hands:
            events.append(hands_event(engine))
        if engine.sensing.flags is not self.flags:
            self.flags = engine.sensing.flags
            events.append(sensed_event(engine))
        known = engine.context.changes, engine.drivers.ends
        if known != self.known:
            self.known = known
            self.reported(engine, events, engine.ticks)

    def take_lines(self, events: list[Event]) -> None:
        """Events of lines for people."""
        if self.lines:
            lines, self.lines = self.lines, []
            events += [self.line_event(*line) for line in lines]

    def reported(self, engine: Engine, events: list[Event], tick: int) -> None:
        """Events of what clients bring about: what is said, reported and drawn; their ends."""
        time = self.time
        said = sum(map(len, self.said))
        if said != self.said_so_far:
            self.said_so_far = said
            events += self.sayings()
        properties = [record.properties for record in self.records]
        if properties != self.properties:
            events += self.reports(time)
        states = [record.state for record in self.records]
        if states != self.states:
            events += self.controllers(states, tick)
        events += self.drawings(engine.robots, tick)

    def line_event(self, time: float, text: str) -> Event:
        name = "troupe"
        if text.startswith("["):
            name = text[1:].partition("]")[0]
        values = {"level": LEVELS["info"], "name": name, "msg": text}
        return Event(time, "/rosout", "rcl_interfaces/Log", {**stamped(time), **values})

    def sayings(self) -> list[Event]:
        events = []
        for robot, said in enumerate(self.said):
            for when, text in said[self.said_each[robot] :]:
                values = {
                    "time": when, "robot": robot, "name": self.records[robot].name, "text": text,
                }  # fmt: skip
                events.append(Event(when, "/troupe/said", "troupe_msgs/Said", values))
            self.said_each[robot] = len(said)
        return events

    def reports(self, time: float) -> list[Event]:
        events = []
        for robot, record in enumerate(self.records):
            before = self.properties[robot]
            if record.properties == before:
                continue
            for key, value in record.properties.items():
                if key not in before or before[key] != value:
                    values = {
                        "robot": robot, "name": record.name, "key": key, "value": json.dumps(value),
                    }  # fmt: skip
                    events.append(Event(time, "/troupe/properties", "troupe_msgs/Property", values))
            self.properties[robot] = dict(record.properties)
        return events

    def controllers(self, states: list[Any], tick: int) -> list[Event]:
        events = []
        for robot, (now, before) in enumerate(zip(states, self.states, strict=True)):
            if now == before:
                continue
            record = self.records[robot]
            values = {
                "tick": tick,
                "robot": robot,
                "name": record.name,
                "state": now,
                "has_exit_code": record.exit_code is not None,
                "exit_code": record.exit_code,
                "error": record.error,
            }
            events.append(Event(self.time, "/troupe/controllers", "troupe_msgs/Controller", values))
        self.states = states
        return events

    def recolored(self, colors: list[int], events: list[Event]) -> None:
        bodies = []
        for robot, (now, before) in enumerate(zip(colors, self.colors, strict=False)):
            if now != before:
                body = self.loaded.world.models[self.records[robot].model].body
                bodies.append((robot, self.names[robot], body, now))
        if bodies:
            events.append(body_event(self.time, bodies))
        self.colors = colors
        self.color_bytes = np.array(colors, np.uint32).tobytes()

    def drawings(self, robots: Sequence[Robot], tick: int) -> list[Event]:
        events = []
        for robot in robots:
            shapes, before = robot.drawings, self.drawn.get(robot.index, [])
            if len(before) == len(shapes) and all(map(is_same, before, shapes)):
                continue
            self.drawn[robot.index] = list(shapes)
            values = {
                "tick": tick,
                "robot": robot.index,
                "shapes": [
                    {
                        "kind": shape.kind,
                        "color": shape.color,
                        "filled": shape.fill_color is not None,
                        "fill_color": shape.fill_color,
                        "points": np.asarray(shape.points, float).reshape(-1),
                    }
                    for shape in shapes
                ],
            }
            events.append(Event(self.time, "/troupe/drawings", "troupe_msgs/Drawings", values))
        return events

    # --- paint and readings

    def windows(self, engine: Engine) -> list[tuple[int, int, NDArray[np.int16]]]:
        """Copies of the floor around all that may have been painted in this tick."""
        floor, stage = engine.scenery.floor, engine.scenery.stage
        owner, cell = floor.owner, floor.resolution
        if self.floor is None:
            self.floor = Floor(owner.shape[0], owner.shape[1], cell)
            self.writer.put(self.floor, 0)
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
            x, y, _ = stage.poses[robot].tolist()
            column, row = max(0, int((x - far) / cell)), max(0, int((y - far) / cell))
            last_column, last_row = int((x + far) / cell) + 1, int((y + far) / cell) + 1
            if last_column > 0 and last_row > 0:
                found.append((row, column, owner[row:last_row, column:last_column].copy()))
        self.distances = gone.copy()
        return found

    def fans(self, engine: Engine) -> list[Fans]:
        """What was sensed in this tick, of the sensors that are to be logged."""
        found = []
        for group in engine.scenery.suite.groups:
            source = self.source(group)
            if source is None or not group.rows.size:
                continue
            for row in range(len(source.members), len(group.robots)):
                source.members.append(self.member(engine, group, row))
            rows, readings = group.rows, group.readings
            if isinstance(readings, Blobs):
                counts = readings.counts[rows]
                blobs = readings.blobs[rows, : int(counts.max())]
                found.append(Fans(source, rows, NO_RANGES, None, blobs, counts))
            elif isinstance(readings, Scans | Elements | Intensities):
                ranges = taken(readings.ranges, rows)
                back = None
                if isinstance(readings, Intensities):
                    back = taken(readings.intensities, rows)
                found.append(Fans(source, rows, ranges, back))
        return found

    def source(self, group: Group) -> SensorGroup | None:
        """What the log knows of a group; None if it is not to be logged."""
        if id(group) not in self.groups:
            readings, found = group.readings, None
            if self.wants(group.type.name) and group.kind in NOUNS:
                found = SensorGroup(
                    group.kind,
                    NOUNS[group.kind],
                    fov=getattr(readings, "fov", 0.0),
                    max_range=getattr(readings, "max_range", 0.0),
                    min_range=getattr(group.settings, "min_range", 0.0),
                    samples=readings.ranges.shape[1] if hasattr(readings, "ranges") else 0,
                    size=(getattr(readings, "width", 0), getattr(readings, "height", 0)),
                )
            self.groups[id(group)] = found
        return self.groups[id(group)]

    def member(self, engine: Engine, group: Group, row: int) -> tuple[str, str]:
        """Topic and frame of a sensor; the second and further ones of a robot have a number."""
        robot, slot = int(group.robots[row]), int(group.slots[row])
        suite = engine.scenery.suite
        first = suite.first_slot[robot]
        noun = NOUNS[group.kind]
        kinds = [suite.place(robot, index)[0].kind for index in range(slot - first)]
        before = sum(NOUNS.get(kind) == noun for kind in kinds)
        name = self.names[robot]
        number = f"_{before}" if before else ""
        return f"/{name}/{noun}{number}", f"{name}/{noun}{number}"


NO_RANGES = np.zeros((0, 0), np.float32)


def taken(values: NDArray[np.float64], rows: NDArray[np.int64]) -> NDArray[np.float32]:
    """Rows of readings as float32; copies."""
    part = values if len(rows) == len(values) else values[rows]
    return part.astype(np.float32)


def is_same(one: object, other: object) -> bool:
    return one is other


def stamped(time: float) -> dict[str, Any]:
    nanoseconds = round(time * 1e9)
    return {"stamp": {"sec": nanoseconds // 10**9, "nanosec": nanoseconds % 10**9}}


def hands_event(engine: Engine) -> Event:
    """What was done to robots by hand before they moved in this tick."""
    hands = engine.scenery.stage.hands
    values = {
        "tick": engine.ticks,
        "robots": [robot for robot, _ in hands],
        "settled": [pose is None for _, pose in hands],
        "poses": [number for _, pose in hands for number in (pose or (0.0, 0.0, 0.0))],
    }
    return Event(engine.time, "/troupe/hands", "troupe_msgs/Hands", values)


def last_event(engine: Engine) -> Event:
    """How all stood when the run was over: clients may have moved and coloured robots since."""
    stage, floor = engine.scenery.stage, engine.scenery.floor
    values = {
        "tick": engine.ticks,
        "coverage": floor.coverage if floor.painted_area > 0.0 else math.nan,
        "colors": [robot.color for robot in engine.robots],
        "contacts": stage.contact_counts,
        "stalls": stage.stalls,
        "velocities": stage.velocities.reshape(-1),
        "poses": stage.poses.reshape(-1),
        "movable_poses": stage.movable_poses.reshape(-1),
    }
    return Event(engine.time, "/troupe/last", "troupe_msgs/State", values)


def sensed_event(engine: Engine) -> Event:
    """Which sensors are read now."""
    suite = engine.scenery.suite
    slots = np.flatnonzero(engine.sensing.flags)
    firsts = np.array(suite.first_slot, np.int64)
    robots = np.searchsorted(firsts, slots, side="right") - 1
    sensors = slots - firsts[robots] if len(slots) else slots
    values = {"tick": engine.ticks, "robots": robots, "sensors": sensors}
    return Event(engine.time, "/troupe/sensed", "troupe_msgs/Sensed", values)


def size_of(state: TickState) -> int:
    """Bytes that a state takes, roughly: those that it makes in a chunk, or what waits with it."""
    size = 300 + len(state.movers) + 8 * len(state.velocities)
    if state.fans:
        for fans in state.fans:
            size += fans.ranges.nbytes + (0 if fans.blobs is None else fans.blobs.nbytes)
    if state.odometry is not None:
        size += 800 * len(state.odometry)
    if state.painted:
        size += sum(window.nbytes for _, _, window in state.painted)
    return size
