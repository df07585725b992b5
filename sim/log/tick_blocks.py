"""The states of many ticks as blocks of messages, each kind built in a few numpy calls."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.log import commands
from sim.log.blocks import Block, block, single
from sim.log.cdr import Template, encode, stamp, template
from sim.log.container import Channels
from sim.log.floor import FloorMirror
from sim.log.frames import WORLD, base
from sim.log.moment import Event, TickState
from sim.log.readings import Memo, odometry_blocks, reading_blocks
from sim.stage.records import MOVER

METRES, TURNS = 2.0**13, 2.0**14
"""Steps to which /tf is rounded: an eighth of a millimetre, and of quaternions what turns by
1e-4 rad at the most. Binary fractions end in zeros, which compress; the exact poses are in
/troupe/state."""
SPEEDS = 2.0**20
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
        self.clock = template("rosgraph_msgs/Clock", {})
        self.transforms: dict[tuple[str, ...], Template] = {}
        self.states: dict[tuple[int, int], Template] = {}
        self.tellings: dict[int, Template] = {}
        self.twist = template(TWIST, {})
        self.with_twists = False
        self.counted = np.zeros(0, np.int64)
        self.odometry: Memo = {}
        self.sequence = 0
        self.second = NEVER  # the last one that /clock has told

    def blocks(self, ticks: Sequence[TickState]) -> list[Block]:
        """Blocks of ticks with the same robots, in their order."""
        if not ticks:
            return []
        n = ticks[0].robots
        numbers = np.array([state.tick for state in ticks], np.uint32)
        times = np.array([state.time for state in ticks])
        nanoseconds = np.rint(times * 1e9).astype(np.uint64)
        seconds, rest = nanoseconds // 10**9, nanoseconds % 10**9
        poses = joined([state.poses for state in ticks], float).reshape(len(ticks), n, 3)
        when = numbers, nanoseconds, seconds, rest
        found = self.clock_blocks(*when)
        found += self.transform_blocks(poses, *when)
        found.append(self.state_block(ticks, poses, *when))
        found += self.change_blocks(ticks)
        if ticks[0].odometry is not None:
            found += odometry_blocks(self.channels, self.odometry, self.names, ticks, when)
        found += reading_blocks(self.channels, ticks)
        return found

    def clock_blocks(
        self,
        numbers: NDArray[np.uint32],
        nanoseconds: NDArray[np.uint64],
        seconds: NDArray[np.uint64],
        rest: NDArray[np.uint64],
    ) -> list[Block]:
        """/clock: the first tick of every second."""
        told = np.flatnonzero(np.diff(seconds, prepend=np.uint64(self.second)) != 0)
        self.second = int(seconds[-1])
        if not len(told):
            return []
        bodies = self.clock.filled(
            len(told), {"clock.sec": seconds[told], "clock.nanosec": rest[told]}
        )
        channel = self.channels.channel("/clock", "rosgraph_msgs/Clock")
        return [block(bodies, channel, numbers[told], nanoseconds[told])]

    def transform_blocks(
        self,
        poses: NDArray[np.float64],
        numbers: NDArray[np.uint32],
        nanoseconds: NDArray[np.uint64],
        seconds: NDArray[np.uint64],
        rest: NDArray[np.uint64],
    ) -> list[Block]:
        """/tf: every robot's body in the world."""
        channel = self.channels.channel("/tf", "tf2_msgs/TFMessage")
        found = []
        for first in range(0, poses.shape[1], TRANSFORMS):
            part = poses[:, first : first + TRANSFORMS]
            names = tuple(self.names[first : first + part.shape[1]])
            bodies = self.transform_template(names).filled(
                len(poses),
                {
                    "transforms.header.stamp.sec": seconds,
                    "transforms.header.stamp.nanosec": rest,
                    "transforms.transform.translation.x": np.rint(part[..., 0] * METRES) / METRES,
                    "transforms.transform.translation.y": np.rint(part[..., 1] * METRES) / METRES,
                    "transforms.transform.rotation.z": rounded_turn(np.sin(0.5 * part[..., 2])),
                    "transforms.transform.rotation.w": rounded_turn(np.cos(0.5 * part[..., 2])),
                },
            )
            found.append(block(bodies, channel, numbers, nanoseconds))
        return found

    def transform_template(self, names: tuple[str, ...]) -> Template:
        if names not in self.transforms:
            if len(names) < TRANSFORMS:  # the last ones: more robots may come
                self.transforms = {
                    known: one for known, one in self.transforms.items() if len(known) == TRANSFORMS
                }
            entries = [
                {"header": {"frame_id": WORLD}, "child_frame_id": base(name)} for name in names
            ]
            self.transforms[names] = template("tf2_msgs/TFMessage", {"transforms": entries})
        return self.transforms[names]

    def state_block(
        self,
        ticks: Sequence[TickState],
        poses: NDArray[np.float64],
        numbers: NDArray[np.uint32],
        nanoseconds: NDArray[np.uint64],
        seconds: NDArray[np.uint64],
        rest: NDArray[np.uint64],
    ) -> Block:
        """/troupe/state: all that moves, exactly."""
        count, n, m = len(ticks), poses.shape[1], len(ticks[0].movables) // 24
        values = {
            "stamp.sec": seconds,
            "stamp.nanosec": rest,
            "tick": numbers,
            "coverage": np.array([state.coverage for state in ticks]),
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
        bodies = self.state_template(n, m).filled(count, values)
        return block(bodies, self.channels.channel("/troupe/state", STATE), numbers, nanoseconds)

    def state_template(self, n: int, m: int) -> Template:
        if (n, m) not in self.states:
            self.states = {(n, m): state_template(n, m)}
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
        for state in ticks:
            if state.touched is not None:
                counted = np.frombuffer(state.contacts, np.int64)
                began = np.flatnonzero(counted != self.counted)
                self.counted = counted
                robots, points = state.touched
                shown = np.isin(robots, began)
                if shown.any():
                    values = {"robots": robots[shown], "points": points[shown].reshape(-1)}
                    found.append(
                        self.single(tick_event(state, "/troupe/contacts", CONTACTS, values))
                    )
            if state.painted and self.floor is not None:
                changed = self.floor.changes(state.painted)
                if changed is not None:
                    found.append(self.single(tick_event(state, "/troupe/paint", PAINT, changed)))
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
            if len(self.tellings) > MOST_LAYOUTS:
                self.tellings.clear()
            self.tellings[k] = template(COMMANDS, zeros)
        numbers = np.array([state.tick for state, _, _ in told], np.uint32)
        times = np.rint([state.time * 1e9 for state, _, _ in told]).astype(np.uint64)
        robots = np.stack([which for _, which, _ in told])
        given = np.stack([values for _, _, values in told])
        values = {
            "stamp.sec": times // 10**9,
            "stamp.nanosec": times % 10**9,
            "tick": numbers,
            "robots": robots,
            "modes": given[:, :, commands.MODE],
            "motors": given[:, :, commands.MOTORS],
            "values": given[:, :, : len(commands.NUMBERS)].reshape(len(told), -1),
        }
        channel = self.channels.channel("/troupe/commands", COMMANDS)
        found = [block(self.tellings[k].filled(len(told), values), channel, numbers, times)]
        if self.with_twists:
            topics = [
                self.channels.channel(f"/{self.names[robot]}/cmd_vel", TWIST)
                for robot in robots.reshape(-1).tolist()
            ]
            flat = given.reshape(-1, commands.WIDTH)
            bodies = self.twist.filled(
                len(flat), {"linear.x": flat[:, 0], "linear.y": flat[:, 1], "angular.z": flat[:, 2]}
            )
            found.append(block(bodies, topics, np.repeat(numbers, k), np.repeat(times, k)))
        return found

    def single(self, event: Event) -> Block:
        """The message of an event."""
        self.sequence += 1
        channel = self.channels.channel(event.topic, event.type)
        values = {"stamp": stamp(event.time), **event.values}
        return single(encode(event.type, values), channel, self.sequence, round(event.time * 1e9))


def state_template(n: int, m: int) -> Template:
    """The layout of /troupe/state for n robots and m obstacles that can be pushed."""
    lengths = {
        "colors": n, "contacts": n, "stalls": n, "velocities": 3 * n, "poses": 3 * n,
        "movable_poses": 3 * m,
    }  # fmt: skip
    return template(STATE, {name: np.zeros(length) for name, length in lengths.items()})


def tick_event(state: TickState, topic: str, kind: str, values: Mapping[str, Any]) -> Event:
    return Event(state.time, topic, kind, {"tick": state.tick, **values})


def rounded_turn(part: NDArray[np.float64]) -> NDArray[np.float64]:
    """A part of a quaternion, rounded."""
    rounded: NDArray[np.float64] = np.rint(part * TURNS) / TURNS
    return rounded


def joined(arrays: Sequence[bytes], dtype: Any) -> NDArray[Any]:
    """The arrays of a type, given as their bytes, one after the other."""
    return np.frombuffer(b"".join(arrays), dtype)
