"""The rows of a tape and all events as messages: what a chunk has of them, and in which order."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.log.cdr import encode, stamp
from sim.log.container import LogFile
from sim.log.floor import FloorMirror
from sim.log.forms import BYTES, COS, ROUNDED, SIN, SINGLES, WORDS, Form
from sim.log.frames import WORLD, base
from sim.log.layouts import Layout, layout
from sim.log.moment import Event, Painted, Touched
from sim.log.page import Page
from sim.log.readings import ROW, WRITERS, Writer, odometry_forms, writer_of
from sim.log.scene import paint_event
from sim.log.stretches import Stretch, write_clock
from sim.log.tape import COVERAGE, Sheet
from sim.log.tellings import commanded, write_commands, write_twists

METRES, TURNS, SPEEDS = 2.0**10, 2.0**11, 2.0**16
"""Steps to which /tf and velocities are rounded: a millimetre, of quaternions what turns by 1e-3
rad at the most, and 1.5e-5 m/s. Binary fractions end in zeros, which compress; the exact poses are
in /troupe/state."""
TRANSFORMS = 64
"""Robots in one message of /tf: where robots enter all the time, few of them are laid out anew."""
TWIST = "geometry_msgs/Twist"
STATE, COMMANDS, CONTACTS, PAINT = (
    f"troupe_msgs/{name}" for name in ("State", "CommandColumns", "Contacts", "Paint")
)


@dataclass(frozen=True)
class Written:
    """How the rows of a sheet are written: what moved, and what was sensed."""

    moved: list[Writer]
    sensed: list[Writer]
    twists: NDArray[np.int64]
    """(n,) the robots' channels for their velocities; 0: none yet."""


class TickMessages:
    """Adds ticks and events to pages; knows what was last written of what goes as changes."""

    def __init__(self, file: LogFile, *, with_twists: bool = False) -> None:
        self.file, self.channels = file, file.channels
        self.with_twists = with_twists
        self.floor: FloorMirror | None = None
        self.second = -1  # the last one that /clock has told
        self.painted_at = 0.0  # simulated seconds
        self._transforms: dict[tuple[str, ...], Layout] = {}

    def add(self, sheet: Sheet, part: Stretch, page: Page, sensed: Page) -> None:
        """Add rows: what moved and was commanded to a page, what was sensed to another one."""
        written = sheet.written
        if written is None:
            written = sheet.written = self.how(sheet)
        clock = self.channels.channel("/clock", "rosgraph_msgs/Clock")
        self.file.declare(page)
        self.second = write_clock(page, part, clock, self.second)
        for write in written.moved:
            write(page, part)
        if part.commands:
            self.add_commands(sheet, written, part, page)
        for write in written.sensed:
            write(sensed, part)

    def add_commands(self, sheet: Sheet, written: Written, part: Stretch, page: Page) -> None:
        """/troupe/commands, and each robot's velocity on /NAME/cmd_vel where that is wanted."""
        channel = self.channels.channel("/troupe/commands", COMMANDS)
        self.file.declare(page)
        write_commands(page, part, channel)
        if not self.with_twists:
            return
        for robot in commanded(part, sheet.robots).tolist():
            if not written.twists[robot]:
                topic = f"/{sheet.names[robot]}/cmd_vel"
                written.twists[robot] = self.channels.channel(topic, TWIST)
        self.file.declare(page)
        write_twists(page, part, written.twists)

    def how(self, sheet: Sheet) -> Written:
        """How the rows of a sheet are written."""
        moved = [writer_of(form) for form in (*self.transform_forms(sheet), self.state_form(sheet))]
        sensed: list[Writer] = []
        for read in sheet.read:
            sensed += WRITERS[read.group.kind](self.channels, sheet, read)
        if "odometry" in sheet.at:
            sensed += [writer_of(form) for form in odometry_forms(self.channels, sheet)]
        return Written(moved, sensed, np.zeros(sheet.robots, np.int64))

    def transform_forms(self, sheet: Sheet) -> list[Form]:
        """/tf: every robot's body in the world."""
        found = []
        channel = self.channels.channel("/tf", "tf2_msgs/TFMessage")
        fields = [
            ("translation.x", ROUNDED, 0, METRES),
            ("translation.y", ROUNDED, 8, METRES),
            ("rotation.z", SIN, 16, TURNS),
            ("rotation.w", COS, 16, TURNS),
        ]
        for first in range(0, sheet.robots, TRANSFORMS):
            names = sheet.names[first : first + TRANSFORMS]
            form = Form(self.transform_layout(names), [channel])
            form.stamp("transforms.header.stamp")
            poses = sheet.at["poses"] + ROW * first
            for path, action, at, steps in fields:
                place = f"transforms.transform.{path}"
                form.paste(action, place, poses + at, step=ROW, steps=steps)
            found.append(form)
        return found

    def transform_layout(self, names: tuple[str, ...]) -> Layout:
        if names not in self._transforms:
            if len(names) < TRANSFORMS:  # the last ones: more robots may come
                self._transforms = {
                    known: one
                    for known, one in self._transforms.items()
                    if len(known) == TRANSFORMS
                }
            entries = [
                {"header": {"frame_id": WORLD}, "child_frame_id": base(name)} for name in names
            ]
            self._transforms[names] = layout("tf2_msgs/TFMessage", {"transforms": entries})
        return self._transforms[names]

    def state_form(self, sheet: Sheet) -> Form:
        """/troupe/state: all that moves, exactly."""
        at, n, m = sheet.at, sheet.robots, sheet.movables
        form = Form(state_layout(n, m), [self.channels.channel("/troupe/state", STATE)])
        form.own().paste(BYTES, "coverage", COVERAGE)
        form.paste(BYTES, "colors", at["colors"], step=4)
        form.paste(WORDS, "contacts", at["contacts"])
        form.paste(BYTES, "stalls", at["stalls"], step=1)
        form.paste(SINGLES, "velocities", at["velocities"], steps=SPEEDS)
        form.paste(BYTES, "poses", at["poses"])
        if m:
            form.paste(BYTES, "movable_poses", at["movables"])
        return form

    def single(self, event: Event, page: Page) -> None:
        """Add the message of an event."""
        channel = self.channels.channel(event.topic, event.type)
        self.file.declare(page)
        values = {"stamp": stamp(event.time), **event.values}
        page.message(encode(event.type, values), channel, round(event.time * 1e9))

    def touched(self, one: Touched, page: Page) -> None:
        """/troupe/contacts: who began to touch something, and where."""
        values = {"tick": one.tick, "robots": one.robots, "points": one.points.reshape(-1)}
        self.single(Event(one.time, "/troupe/contacts", CONTACTS, values), page)

    def painted(self, one: Painted, page: Page) -> None:
        """/troupe/paint: cells that were painted."""
        changed = None if self.floor is None else self.floor.changes(one.windows)
        if changed is not None:
            self.painted_at = one.time
            values = {"tick": one.tick, **changed}
            self.single(Event(one.time, "/troupe/paint", PAINT, values), page)

    def whole_floor(self, page: Page) -> None:
        """/troupe/paint_grid: the floor, where it has changed since it was last told."""
        if self.floor is not None and self.floor.changed:
            self.floor.changed = False
            self.single(paint_event(self.floor, self.painted_at), page)


def state_layout(n: int, m: int) -> Layout:
    """The layout of /troupe/state for n robots and m obstacles that can be pushed."""
    lengths = {
        "colors": n, "contacts": n, "stalls": n, "velocities": 3 * n, "poses": 3 * n,
        "movable_poses": 3 * m,
    }  # fmt: skip
    return layout(STATE, {name: np.zeros(length) for name, length in lengths.items()})
