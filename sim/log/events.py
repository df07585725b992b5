"""The events that a log has beside its ticks: what is new in a run since one last looked."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from operator import attrgetter
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.log.frames import ros_name
from sim.log.moment import Event
from sim.log.scene import body_event, map_event, wall_event

if TYPE_CHECKING:
    from sim.build import LoadedWorld
    from sim.engine import Engine
    from sim.result import RobotRecord
    from sim.robot import Robot
    from sim.stage.layout import Layout
    from sim.stage.moving import Hand

LEVELS = {"info": 20}
NO_GRIP = -2
"""In the place of a holder, where nothing was gripped or let go."""
COLOR = attrgetter("color")
SURVEY = 1.0
"""Simulated seconds at least between two surveys of what stands, while hands move it."""


class News:
    """Knows what a log has been told of a run's robots, and finds what is new.

    names: the robots', as ROS takes them. records: theirs in the result.
    """

    def __init__(self, loaded: LoadedWorld) -> None:
        self.loaded = loaded
        self.time = 0.0  # simulated seconds, when one last looked
        self.names: list[str] = []
        self.records: list[RobotRecord] = []
        self._lines: list[tuple[float, str]] = []  # for people, not yet in the log
        self._said: list[list[tuple[float, str]]] = []
        self._said_so_far = 0
        self._said_each: list[int] = []
        self._properties: list[dict[str, Any]] = []
        self._states: list[Any] = []
        self._colors: list[int] = []
        self._drawn: dict[int, list[Any]] = {}
        self._layout: Layout | None = None  # as walls and map have told it, and when
        self._surveyed = -SURVEY
        self._flags: Any = self
        self._known = (-1, -1)  # changes and ends that there had been when one last looked

    def line(self, text: str) -> None:
        """Keep a line that was meant for people, of whatever thread."""
        self._lines.append((self.time, text))

    def any(self, engine: Engine) -> bool:
        """Whether there may be something new, besides colours."""
        self.time = engine.time
        return bool(
            self._lines
            or len(engine.robots) != len(self.records)
            or engine.scenery.stage.hands
            or engine.scenery.stage.layout is not self._layout
            or engine.context.changes != self._known[0]
            or engine.drivers.ends != self._known[1]
            or engine.sensing.flags is not self._flags
        )

    def since(self, engine: Engine, *, last: bool = False) -> list[Event]:
        """Events of all that is new, besides colours; the `last` look is after the run."""
        self.time = engine.time
        events: list[Event] = []
        if len(engine.robots) != len(self.records):
            events += self.entered(engine)
        if self._lines:
            lines, self._lines = self._lines, []
            events += [self.line_event(*line) for line in lines]
        if engine.scenery.stage.layout is not self._layout:
            self.survey(engine.scenery.stage.layout, events, last)
        if last:
            events += self.recolored(engine)
            if hands := engine.scenery.stage.later_hands:
                events.append(hands_event(engine.ticks + 1, engine.time, hands))
            self.reported(engine, events, engine.ticks + 1)
            if engine.ticks:
                events.append(last_event(engine))
        else:
            self.changed(engine, events)
        return events

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
            self._said.append(record.said)
            self._said_each.append(0)
            self._properties.append({})
            self._states.append(record.state)
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
            events.append(body_event(self.time, bodies))
        return events

    def survey(self, layout: Layout, events: list[Event], last: bool) -> None:
        """Events of what stands: at the start, and where hands have moved it."""
        if last or self.time >= self._surveyed + SURVEY:
            time = 0.0 if self._layout is None else self.time
            self._layout, self._surveyed = layout, time
            events += [wall_event(layout, time), map_event(layout, time)]

    def changed(self, engine: Engine, events: list[Event]) -> None:
        """Events of what else is new besides the bodies' motion."""
        if hands := engine.scenery.stage.hands:
            events.append(hands_event(engine.ticks, engine.time, hands))
        if engine.sensing.flags is not self._flags:
            self._flags = engine.sensing.flags
            events.append(sensed_event(engine))
        known = engine.context.changes, engine.drivers.ends
        if known != self._known:
            self._known = known
            self.reported(engine, events, engine.ticks)

    def reported(self, engine: Engine, events: list[Event], tick: int) -> None:
        """Events of what clients bring about: what is said, reported and drawn; their ends."""
        time = self.time
        said = sum(map(len, self._said))
        if said != self._said_so_far:
            self._said_so_far = said
            events += self.sayings()
        properties = [record.properties for record in self.records]
        if properties != self._properties:
            events += self.reports(time)
        states = [record.state for record in self.records]
        if states != self._states:
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
        for robot, said in enumerate(self._said):
            for when, text in said[self._said_each[robot] :]:
                values = {
                    "time": when, "robot": robot, "name": self.records[robot].name, "text": text,
                }  # fmt: skip
                events.append(Event(when, "/troupe/said", "troupe_msgs/Said", values))
            self._said_each[robot] = len(said)
        return events

    def reports(self, time: float) -> list[Event]:
        events = []
        for robot, record in enumerate(self.records):
            before = self._properties[robot]
            if record.properties == before:
                continue
            for key, value in record.properties.items():
                if key not in before or before[key] != value:
                    values = {
                        "robot": robot, "name": record.name, "key": key, "value": json.dumps(value),
                    }  # fmt: skip
                    events.append(Event(time, "/troupe/properties", "troupe_msgs/Property", values))
            self._properties[robot] = dict(record.properties)
        return events

    def controllers(self, states: list[Any], tick: int) -> list[Event]:
        events = []
        for robot, (now, before) in enumerate(zip(states, self._states, strict=True)):
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
        self._states = states
        return events

    def recolored(self, engine: Engine) -> list[Event]:
        """The event of robots that have got another colour."""
        colors = list(map(COLOR, engine.robots))
        bodies = []
        for robot, (now, before) in enumerate(zip(colors, self._colors, strict=False)):
            if now != before:
                body = self.loaded.world.models[self.records[robot].model].body
                bodies.append((robot, self.names[robot], body, now))
        self._colors = colors
        return [body_event(self.time, bodies)] if bodies else []

    def drawings(self, robots: Sequence[Robot], tick: int) -> list[Event]:
        events = []
        for robot in robots:
            # a program that draws gets another list: this one is never changed
            shapes, before = robot.drawings, self._drawn.get(robot.index)
            if shapes is before or not (shapes or before):
                continue
            self._drawn[robot.index] = shapes
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


def stamped(time: float) -> dict[str, Any]:
    nanoseconds = round(time * 1e9)
    return {"stamp": {"sec": nanoseconds // 10**9, "nanosec": nanoseconds % 10**9}}


def hands_event(tick: int, time: float, hands: Sequence[Hand]) -> Event:
    """What was done by hand before bodies moved in a tick."""
    values = {
        "tick": tick,
        "numbers": [hand.number for hand in hands],
        "things": [hand.thing for hand in hands],
        "settled": [hand.pose is None and hand.holder is None for hand in hands],
        "holders": [NO_GRIP if hand.holder is None else hand.holder for hand in hands],
        "poses": [value for hand in hands for value in (hand.pose or (0.0, 0.0, 0.0))],
    }
    return Event(time, "/troupe/hands", "troupe_msgs/Hands", values)


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
