"""The bytes by which a scene and its moments reach a page: described here, once.

A message is little-endian. It begins with a head of 24 bytes

    u32 magic "TRP1"   u16 kind (1 scene, 2 moment)   u16 0   f64 time, s   u32 tick   u32 robots

and then has sections: u32 number, u32 bytes, and so many bytes, filled up with zeros to a multiple
of four. Poses and things are always there; any other section is left out as long as it is the same
as in the last message to the same viewer, or, at first, as nothing.

     1  about      JSON: title, size [m, m], low [m, m] (the lower left corner), models, things, ...
     2  solids     u32 count; u32 corners (count); u32 0xRRGGBB (count); f32 x, y of all corners;
                   in a moment too, where a hand has moved some
     3  poses      f32 x, y, yaw (robots)
     4  colors     u32 0xRRGGBB (robots)
     5  states     u8 bits (robots): 1 settled, 2 stalled, 4 touching, 8 waited for
     6  things     f32 x, y, yaw of every thing that can be pushed
     7  fans       each: u32 robot, sensor, k; f32 x, y, yaw, fov; f32 ranges (k)
     8  cones      each: u32 robot, sensor, k; f32 fov; f32 x, y, heading, range (k)
     9  sights     each: u32 robot, sensor, k, width, height; f32 x, y, yaw, fov;
                         u32 0xRRGGBB, left, right, top, bottom, range in mm (k)
    10  marks      each: u32 robot, sensor, k; f32 x, y, yaw; f32 id, x, y, yaw (k)
    11  switches   each: u32 robot, sensor, k; f32 x, y, yaw; f32 closed, begin, end (k)
    12  paint      u32 k; u32 first cell (k); u32 cells (k); u32 owner (k): runs of cells that have
                   changed, row by row from the lower left; owner 0 bare, r + 1 robot r
    13  robots     JSON: {"from": index, "robots": [[name, model], ...]} who has entered
    14  said       JSON: [[robot, time, words], ...]
    15  drawn      JSON: [{robot, kind, points, color, fill}, ...] all that is drawn now
    16  status     JSON: of the whole run
    17  cards      JSON: {robot: what is known of it, ...}
    18  ways       u32 marks, n; f32 x, y, yaw (marks * n): time has jumped, and this led there; NaN
                   where a robot had not entered

The page's side is troupe/live/page/frames.js.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.strictjson import plain
from sim.view.moment import (
    Cones,
    Fan,
    Line,
    Marks,
    Moment,
    Robot,
    Scene,
    Sight,
    Solid,
    Switches,
)

MAGIC = 0x31505254
SCENE, MOMENT = 1, 2
HEAD = struct.Struct("<IHHdII")
SECTION = struct.Struct("<II")

ABOUT, SOLIDS, POSES, COLORS, STATES, THINGS = 1, 2, 3, 4, 5, 6
FANS, CONES, SIGHTS, MARKS, SWITCHES = 7, 8, 9, 10, 11
PAINT, ROBOTS, SAID, DRAWN, STATUS, CARDS, WAYS = 12, 13, 14, 15, 16, 17, 18


def encode_scene(scene: Scene) -> bytes:
    """The first message of a run to a viewer."""
    sections = [(ABOUT, _json(scene.about)), (SOLIDS, _solids(scene.solids))]
    return _message(SCENE, 0.0, 0, 0, sections)


class Frame:
    """A moment with its sections as bytes, which are made once however many see it."""

    def __init__(self, moment: Moment) -> None:
        self.moment = moment
        self.always = [(POSES, np.asarray(moment.poses, "<f4").tobytes())]
        if len(moment.things):
            self.always.append((THINGS, np.asarray(moment.things, "<f4").tobytes()))
        self.changing = {
            COLORS: np.asarray(moment.colors, "<u4").tobytes(),
            STATES: moment.states.tobytes(),
            FANS: b"".join(map(_fan, moment.fans)),
            CONES: b"".join(map(_cones, moment.cones)),
            SIGHTS: b"".join(map(_sight, moment.sights)),
            MARKS: b"".join(map(_marks, moment.marks)),
            SWITCHES: b"".join(map(_switches, moment.switches)),
            DRAWN: _json(moment.drawn) if moment.drawn else b"[]",
            STATUS: _json(moment.status),
        }
        """Sent where they differ from those before."""

    @cached_property
    def solids(self) -> bytes:
        """What stands now."""
        backdrop = self.moment.backdrop
        return b"" if backdrop is None else _solids([*backdrop.marks, *backdrop.solids])


AT_FIRST = {DRAWN: b"[]"}
"""What a page takes for said before anything was; of all other sections: nothing."""


def encode_moment(frame: Frame, before: Frame | None = None, cards: Collection[int] = ()) -> bytes:
    """The message of a moment to a viewer that got `before` last; `cards`: of which robots."""
    moment, old = frame.moment, before and before.moment
    sections = list(frame.always)
    was = before.changing if before else AT_FIRST
    sections += [(n, data) for n, data in frame.changing.items() if data != was.get(n, b"")]
    count, known = len(moment.poses), len(old.poses) if old else 0
    if known < count:
        new = [list(robot) for robot in moment.robots[known:]]
        sections.append((ROBOTS, _json({"from": known, "robots": new})))
    if moment.backdrop is not None and moment.backdrop is not (old.backdrop if old else None):
        sections.append((SOLIDS, frame.solids))
    painted = old.paint if old else None
    if moment.paint is not None and moment.paint is not painted:
        sections.append((PAINT, paint_runs(painted, moment.paint)))
    if said := _said_since(old.said if old else (), moment.said):
        sections.append((SAID, _json(said)))
    if moment.ways is not None and moment.jumps != (old.jumps if old else 0):
        head = struct.pack("<II", *moment.ways.shape[:2])
        sections.append((WAYS, head + np.asarray(moment.ways, "<f4").tobytes()))
    wanted = {robot: moment.cards[robot] for robot in cards if robot in moment.cards}
    if wanted:
        sections.append((CARDS, _json(wanted)))
    return _message(MOMENT, moment.time, moment.tick, count, sections)


def _said_since(before: Sequence[Line], now: Sequence[Line]) -> list[Line]:
    """Lines that are new, and an empty one of whom has not said anything any more: in a log time
    may have gone back."""
    if before == now:
        return []
    known = {line[0]: line for line in before}
    fresh = [line for line in now if known.pop(line[0], None) != line]
    return [*fresh, *((robot, 0.0, "") for robot in known)]


def paint_runs(before: NDArray[np.int16] | None, now: NDArray[np.int16]) -> bytes:
    """The section `paint`: runs of equal owners where they have changed."""
    flat = now.ravel()
    was = np.zeros_like(flat) if before is None else before.ravel()
    changed = np.flatnonzero(flat != was)
    if not len(changed):
        return struct.pack("<I", 0)
    owners = flat[changed]
    begins = np.ones(len(changed), bool)
    begins[1:] = (np.diff(changed) != 1) | (np.diff(owners) != 0)
    first = np.flatnonzero(begins)
    lengths = np.diff(np.append(first, len(changed)))
    parts = (changed[first], lengths, owners[first])
    return struct.pack("<I", len(first)) + b"".join(part.astype("<u4").tobytes() for part in parts)


def _solids(solids: Sequence[Solid]) -> bytes:
    corners = np.array([len(vertices) for vertices, _ in solids], "<u4")
    colors = np.array([color for _, color in solids], "<u4")
    everything = [np.asarray(vertices, "<f4").tobytes() for vertices, _ in solids]
    head = struct.pack("<I", len(corners))
    return b"".join([head, corners.tobytes(), colors.tobytes(), *everything])


def _fan(fan: Fan) -> bytes:
    head = struct.pack("<3I4f", fan.robot, fan.sensor, len(fan.ranges), *fan.pose, fan.fov)
    return head + np.asarray(fan.ranges, "<f4").tobytes()


def _cones(cones: Cones) -> bytes:
    head = struct.pack("<3If", cones.robot, cones.sensor, len(cones.elements), cones.fov)
    return head + np.asarray(cones.elements, "<f4").tobytes()


def _sight(sight: Sight) -> bytes:
    counts = (sight.robot, sight.sensor, len(sight.blobs), sight.width, sight.height)
    head = struct.pack("<5I4f", *counts, *sight.pose, sight.fov)
    return head + np.asarray(sight.blobs, "<u4").tobytes()


def _marks(marks: Marks) -> bytes:
    head = struct.pack("<3I3f", marks.robot, marks.sensor, len(marks.seen), *marks.pose)
    return head + np.asarray(marks.seen, "<f4").tobytes()


def _switches(them: Switches) -> bytes:
    head = struct.pack("<3I3f", them.robot, them.sensor, len(them.parts), *them.pose)
    return head + np.asarray(them.parts, "<f4").tobytes()


_as_json = json.JSONEncoder(allow_nan=False, ensure_ascii=False).encode


def _json(value: Any) -> bytes:
    """JSON that every parser takes: what programs report may hold numbers that are none."""
    try:
        return _as_json(value).encode()
    except (ValueError, TypeError, UnicodeEncodeError):
        return json.dumps(plain(value), allow_nan=False).encode()


def _message(
    kind: int, time: float, tick: int, robots: int, sections: Sequence[tuple[int, bytes]]
) -> bytes:
    parts = [HEAD.pack(MAGIC, kind, 0, time, tick, robots)]
    for number, data in sections:
        parts += [SECTION.pack(number, len(data)), data, bytes(-len(data) % 4)]
    return b"".join(parts)


# -- the other way round, for tests and tools


@dataclass(frozen=True)
class Message:
    """A message taken apart: `sections` as they stand, by number."""

    kind: int
    time: float
    tick: int
    robots: int
    sections: dict[int, bytes]

    def json(self, number: int) -> Any:
        """A section that is JSON."""
        return json.loads(self.sections[number])

    @property
    def poses(self) -> NDArray[np.float32]:
        """(robots, 3)."""
        return np.frombuffer(self.sections[POSES], "<f4").reshape(-1, 3)

    @property
    def things(self) -> NDArray[np.float32]:
        """(m, 3)."""
        return np.frombuffer(self.sections.get(THINGS, b""), "<f4").reshape(-1, 3)

    @property
    def fans(self) -> list[Fan]:
        """The scans; none also where they are those of the message before."""
        return list(_read_fans(self.sections.get(FANS, b"")))

    def paint(self, onto: NDArray[np.int16]) -> None:
        """Bring a layer of paint (rows, columns) up to date."""
        data = np.frombuffer(self.sections.get(PAINT, bytes(4)), "<u4")
        firsts, lengths, owners = data[1:].reshape(3, data[0])
        flat = onto.reshape(-1)
        for first, length, owner in zip(firsts, lengths, owners, strict=True):
            flat[first : first + length] = owner


def decode(data: bytes) -> Message:
    """Take a message apart; raises ValueError for what is none."""
    if len(data) < HEAD.size:
        raise ValueError("a message has at least 24 bytes")
    magic, kind, _, time, tick, robots = HEAD.unpack_from(data)
    if magic != MAGIC:
        raise ValueError("this is no message of Troupe's")
    sections, at = {}, HEAD.size
    while at < len(data):
        number, size = SECTION.unpack_from(data, at)
        at += SECTION.size
        sections[number] = data[at : at + size]
        at += size + -size % 4
    return Message(kind, time, tick, robots, sections)


def decode_robots(message: Message) -> list[Robot]:
    """Who has entered."""
    return [Robot(*robot) for robot in message.json(ROBOTS)["robots"]]


def _read_fans(data: bytes) -> Iterator[Fan]:
    at, head = 0, struct.Struct("<3I4f")
    while at < len(data):
        robot, sensor, count, x, y, yaw, fov = head.unpack_from(data, at)
        at += head.size
        yield Fan(robot, sensor, (x, y, yaw), fov, np.frombuffer(data, "<f4", count, at))
        at += 4 * count
