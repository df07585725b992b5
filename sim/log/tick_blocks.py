"""The states of many ticks as blocks of messages, each kind built in a few numpy calls."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.log import commands
from sim.log.blocks import Block, single
from sim.log.cdr import encode, stamp
from sim.log.container import Channels
from sim.log.floor import FloorMirror
from sim.log.frames import WORLD, base
from sim.log.layouts import Layout, Values, layout
from sim.log.moment import Event, TickState
from sim.log.readings import Memo, Stamps, odometry_blocks, reading_blocks, stamps_of
from sim.stage.records import MOVER

METRES, TURNS, SPEEDS = 2.0**10, 2.0**11, 2.0**20
"""Steps to which /tf and velocities are rounded: a millimetre, of quaternions what turns by 1e-3
rad at the most, and 1e-6 m/s. Binary fractions end in zeros, which compress; the exact poses are
in /troupe/state."""
TRANSFORMS = 64
"""Robots in one message of /tf: where robots enter all the time, few of them are laid out anew."""
MOST_LAYOUTS = 64
NEVER = (1 << 64) - 1
TWIST = "geometry_msgs/Twist"
STATE, COMMANDS, CONTACTS, PAINT = (
    f"troupe_msgs/{name}" for name in ("State", "Commands", "Contacts", "Paint")
)


class TickBlocks:
    """Turns ticks and events into blocks; knows what was last written of what goes as changes."""

    def __init__(self, channels: Channels) -> None:
        self.channels = channels
        self.names: list[str] = []  # of robots, as ROS takes them
        self.floor: FloorMirror | None = None
        self.commands = np.zeros((0, commands.WIDTH))
        self.clock = layout("rosgraph_msgs/Clock", {})
        self.transforms: dict[tuple[str, ...], Layout] = {}
        self.states: dict[tuple[int, int], Layout] = {}
        self.tellings: dict[int, Layout] = {}
        self.touchings: dict[int, Layout] = {}
        self.twist = layout(TWIST, {})
        self.with_twists = False
        self.counted = np.zeros(0, np.int64)
        self.odometry: Memo = {}
        self.second = NEVER  # the last one that /clock has told

    def blocks(self, ticks: Sequence[TickState]) -> list[Block]:
        """Blocks of what moved and changed in ticks with the same robots, in their order."""
        if not ticks:
            return []
        when = stamps_of(ticks)
        n = ticks[0].robots
        poses = joined([state.poses for state in ticks], float).reshape(len(ticks), n, 3)
        found = self.clock_blocks(when)
        found += self.transform_blocks(poses, when)
        found.append(self.state_block(ticks, poses, when))
        found += self.change_blocks(ticks)
        return found

    def sensed_blocks(self, ticks: Sequence[TickState]) -> list[Block]:
        """Blocks of what was sensed in such ticks, as far as it is kept."""
        if not ticks:
            return []
        found = reading_blocks(self.channels, ticks)
        if ticks[0].odometry is not None:
            when = stamps_of(ticks)
            found += odometry_blocks(self.channels, self.odometry, self.names, ticks, when)
        return found

    def clock_blocks(self, when: Stamps) -> list[Block]:
        """/clock: the first tick of every second."""
        told = np.flatnonzero(np.diff(when.seconds, prepend=np.uint64(self.second)) != 0)
        self.second = int(when.seconds[-1])
        if not len(told):
            return []
        part = when.at(told)
        values = {"clock.sec": part.seconds[:, None], "clock.nanosec": part.rest[:, None]}
        return [self.block("/clock", "rosgraph_msgs/Clock", self.clock, part, values)]

    def block(
        self, topic: str, kind: str, one: Layout, when: Stamps, values: Mapping[str, Values]
    ) -> Block:
        """A message for each stamp."""
        channel = np.array(self.channels.channel(topic, kind), np.uint16)
        return Block(one, (len(when.ns),), channel, when.ns, values)

    def transform_blocks(self, poses: NDArray[np.float64], when: Stamps) -> list[Block]:
        """/tf: every robot's body in the world."""
        found = []
        half = 0.5 * poses[..., 2]
        fields = {
            "translation.x": np.rint(poses[..., 0] * METRES) / METRES,
            "translation.y": np.rint(poses[..., 1] * METRES) / METRES,
            "rotation.z": np.rint(np.sin(half) * TURNS) / TURNS,
            "rotation.w": np.rint(np.cos(half) * TURNS) / TURNS,
        }
        for first in range(0, poses.shape[1], TRANSFORMS):
            part = slice(first, first + TRANSFORMS)
            values = {
                "transforms.header.stamp.sec": when.seconds[:, None],
                "transforms.header.stamp.nanosec": when.rest[:, None],
                **{f"transforms.transform.{name}": all_[:, part] for name, all_ in fields.items()},
            }
            one = self.transform_layout(tuple(self.names[part]))
            found.append(self.block("/tf", "tf2_msgs/TFMessage", one, when, values))
        return found

    def transform_layout(self, names: tuple[str, ...]) -> Layout:
        if names not in self.transforms:
            if len(names) < TRANSFORMS:  # the last ones: more robots may come
                self.transforms = {
                    known: one for known, one in self.transforms.items() if len(known) == TRANSFORMS
                }
            entries = [
                {"header": {"frame_id": WORLD}, "child_frame_id": base(name)} for name in names
            ]
            self.transforms[names] = layout("tf2_msgs/TFMessage", {"transforms": entries})
        return self.transforms[names]

    def state_block(
        self, ticks: Sequence[TickState], poses: NDArray[np.float64], when: Stamps
    ) -> Block:
        """/troupe/state: all that moves, exactly."""
        count, n, m = len(ticks), poses.shape[1], len(ticks[0].movables) // 24
        values = {
            **stamped(when),
            "coverage": np.array([[state.coverage] for state in ticks]),
        }
        if n:
            speeds = joined([state.velocities for state in ticks], float).reshape(count, 3 * n)
            values |= {
                "colors": joined([state.colors for state in ticks], np.uint32).reshape(count, n),
                "contacts": joined([state.contacts for state in ticks], np.int64).reshape(count, n),
                "stalls": joined([state.stalls for state in ticks], bool).reshape(count, n),
                "velocities": np.rint(speeds * SPEEDS) / SPEEDS,
                "poses": poses.reshape(count, 3 * n),
            }
        if m:
            movables = joined([state.movables for state in ticks], float)
            values["movable_poses"] = movables.reshape(count, 3 * m)
        return self.block("/troupe/state", STATE, self.state_layout(n, m), when, values)

    def state_layout(self, n: int, m: int) -> Layout:
        if (n, m) not in self.states:
            self.states = {(n, m): state_layout(n, m)}
        return self.states[n, m]

    def change_blocks(self, ticks: Sequence[TickState]) -> list[Block]:
        """What goes out where it has changed: commands, contacts, paint."""
        n = ticks[0].robots
        found: list[Block] = []
        new = n - len(self.commands)
        if new > 0:
            fresh = np.zeros((new, commands.WIDTH))
            fresh[:, commands.MOTORS] = 1.0
            self.commands = np.concatenate([self.commands, fresh])
            self.counted = np.concatenate([self.counted, np.zeros(new, np.int64)])
        found += self.command_blocks(ticks, n)
        found += self.contact_blocks(ticks)
        if self.floor is not None:
            for state in ticks:
                changed = self.floor.changes(state.painted) if state.painted else None
                if changed is not None:
                    values = {"tick": state.tick, **changed}
                    found.append(self.single(Event(state.time, "/troupe/paint", PAINT, values)))
        return found

    def contact_blocks(self, ticks: Sequence[TickState]) -> list[Block]:
        """/troupe/contacts: who began to touch something, and where."""
        alike: dict[int, list[tuple[TickState, NDArray[np.int64], NDArray[np.float64]]]] = {}
        for state in ticks:
            if state.touched is None:
                continue
            counted = np.frombuffer(state.contacts, np.int64)
            began = np.flatnonzero(counted != self.counted)
            self.counted = counted
            robots, points = state.touched
            shown = np.isin(robots, began)
            if shown.any():
                alike.setdefault(int(shown.sum()), []).append((state, robots[shown], points[shown]))
        found = []
        for k, told in alike.items():
            if k not in self.touchings:
                zeros = {"robots": np.zeros(k), "points": np.zeros(2 * k)}
                kept(self.touchings)[k] = layout(CONTACTS, zeros)
            when = stamps_of([state for state, _, _ in told])
            values = {
                **stamped(when),
                "robots": np.stack([robots for _, robots, _ in told]),
                "points": np.stack([points.reshape(-1) for _, _, points in told]),
            }
            found.append(self.block("/troupe/contacts", CONTACTS, self.touchings[k], when, values))
        return found

    def command_blocks(self, ticks: Sequence[TickState], n: int) -> list[Block]:
        """/troupe/commands, and each robot's velocity on /NAME/cmd_vel where that is wanted."""
        told = [state for state in ticks if state.movers]  # of the others none was told anything
        if not told:
            return []
        tables = commands.table(joined([state.movers for state in told], MOVER))
        tables = tables.reshape(len(told), n, commands.WIDTH)
        before = np.concatenate([self.commands[None], tables[:-1]])
        self.commands = tables[-1]
        alike: dict[int, list[tuple[TickState, NDArray[np.intp], NDArray[np.float64]]]] = {}
        for index in np.flatnonzero((tables != before).any(axis=(1, 2))).tolist():
            robots, given = commands.changes(before[index], tables[index])
            if len(robots):
                alike.setdefault(len(robots), []).append((told[index], robots, given))
        return [one for k, given in alike.items() for one in self.told_blocks(k, given)]

    def told_blocks(
        self, k: int, told: Sequence[tuple[TickState, NDArray[np.intp], NDArray[np.float64]]]
    ) -> list[Block]:
        """Commands to k robots each."""
        if k not in self.tellings:
            lengths = {"robots": k, "modes": k, "motors": k, "values": k * len(commands.NUMBERS)}
            zeros = {name: np.zeros(length) for name, length in lengths.items()}
            kept(self.tellings)[k] = layout(COMMANDS, zeros)
        when = stamps_of([state for state, _, _ in told])
        robots = np.stack([which for _, which, _ in told])
        given = np.stack([values for _, _, values in told])
        values = {
            **stamped(when),
            "robots": robots,
            "modes": given[:, :, commands.MODE],
            "motors": given[:, :, commands.MOTORS],
            "values": given[:, :, : len(commands.NUMBERS)].reshape(len(told), -1),
        }
        found = [self.block("/troupe/commands", COMMANDS, self.tellings[k], when, values)]
        if self.with_twists:
            numbers = [
                self.channels.channel(f"/{self.names[robot]}/cmd_vel", TWIST)
                for robot in robots.reshape(-1).tolist()
            ]
            channels = np.array(numbers, np.uint16).reshape(robots.shape)
            speeds = {"linear.x": 0, "linear.y": 1, "angular.z": 2}
            values = {path: given[:, :, which, None] for path, which in speeds.items()}
            found.append(Block(self.twist, robots.shape, channels, when.ns[:, None], values))
        return found

    def single(self, event: Event) -> Block:
        """The message of an event."""
        channel = self.channels.channel(event.topic, event.type)
        values = {"stamp": stamp(event.time), **event.values}
        return single(encode(event.type, values), channel, round(event.time * 1e9))


def state_layout(n: int, m: int) -> Layout:
    """The layout of /troupe/state for n robots and m obstacles that can be pushed."""
    lengths = {
        "colors": n, "contacts": n, "stalls": n, "velocities": 3 * n, "poses": 3 * n,
        "movable_poses": 3 * m,
    }  # fmt: skip
    return layout(STATE, {name: np.zeros(length) for name, length in lengths.items()})


def stamped(when: Stamps) -> dict[str, NDArray[Any]]:
    """The fields of our own types that tell when something was."""
    return {
        "stamp.sec": when.seconds[:, None],
        "stamp.nanosec": when.rest[:, None],
        "tick": when.ticks[:, None],
    }


def kept(layouts: dict[int, Layout]) -> dict[int, Layout]:
    """Layouts that are kept, as long as they are not too many."""
    if len(layouts) > MOST_LAYOUTS:
        layouts.clear()
    return layouts


def joined(arrays: Sequence[bytes], dtype: Any) -> NDArray[Any]:
    """The arrays of a type, given as their bytes, one after the other."""
    return np.frombuffer(b"".join(arrays), dtype)
