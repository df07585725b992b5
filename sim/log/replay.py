"""Runs a logged world again: the bodies, moved by the commands as they were carried out."""

from __future__ import annotations

import hashlib
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.log import commands, contents
from sim.log.errors import LogError
from sim.log.reader import LogReader
from sim.log.world import loaded_again
from sim.stage.geometry import wrapped
from sim.stage.layout import Layout
from sim.stage.physics import pose_of
from sim.stage.stage import Stage
from sim.worldfile.schema import World


@dataclass(frozen=True)
class Verdict:
    """Whether a second run was the same.

    `digest` is that of the log's poses. Where they differ: the first tick in which they do, the
    first robot (or thing that can be pushed), and by how much the second run's pose is off (m, m,
    rad); tick 0 is the start.
    """

    ticks: int
    digest: str
    told_digest: str | None
    tick: int | None = None
    who: str | None = None
    difference: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def equal(self) -> bool:
        """Whether every pose of every tick was the same, and so the digest that the run told."""
        return self.tick is None and self.told_digest in (None, self.digest)


def check(reader: LogReader, told_digest: str | None) -> Verdict:
    """Move the bodies of a log's world again and compare every pose of every tick, bit by bit.

    No program runs: robots get the commands that the log says were carried out, in the tick in
    which they were. `told_digest`: that of the run's result, if it has one. Raises LogError.
    """
    loaded = loaded_again(reader.attachments(), reader.path)
    stage = Stage(loaded.layout, loaded.world.models, loaded.world.clock)
    entering: dict[int, list[contents.Entry]] = defaultdict(list)
    entries = contents.entries(reader)
    for entry in entries:
        entering[entry.tick].append(entry)
    names = [entry.name for entry in entries]
    if not entries:
        raise LogError(f"{reader.path}: no robot has entered in it: there is nothing to run again")
    begun = np.array([entry.pose for entry in entering[0]]).reshape(-1, 3)
    start = loaded.place(reader.whole("seed"))
    wrong = first_difference(begun, as_told(start))
    if wrong is not None:
        robot, difference = wrong
        return Verdict(0, "", told_digest, 0, names[robot], difference)
    for entry, pose in zip(entering[0], start, strict=True):
        stage.add_robot(entry.model, pose)
    told = by_tick(contents.sent(reader))
    hands = {one["tick"]: one for _, one in reader.messages("/troupe/hands")}
    digest = hashlib.sha256()
    tick = 0
    for tick, poses, movables in kept(reader, loaded.world.clock.interval):
        by_hand(stage, hands.get(tick))
        for row in told.get(tick, ()):
            obey(stage, row)
        stage.tick()
        for entry in entering.get(tick, ()):
            stage.add_robot(entry.model, at_door(loaded.layout, entry.pose))
        digest.update(poses.tobytes())
        for own, again, called in (
            (poses, stage.poses, names),
            (movables, stage.movable_poses, things_of(loaded.world)),
        ):
            wrong = first_difference(own, again)
            if wrong is not None:
                which, difference = wrong
                return Verdict(tick, "", told_digest, tick, called[which], difference)
    if not tick:
        raise LogError(f"{reader.path}: the run has no tick in it: there is nothing to run again")
    return Verdict(tick, "sha256:" + digest.hexdigest(), told_digest)


Ticks = Iterator[tuple[int, NDArray[np.float64], NDArray[np.float64]]]


def kept(reader: LogReader, interval: float) -> Ticks:
    """Ticks from 1 on, the poses (n, 3) of robots and (m, 3) of what can be pushed.

    Raises LogError where some are missing.
    """
    due = 1
    for alike, messages, _ in contents.states(reader):
        nothing = np.zeros((len(messages), 0))
        ticks = alike.read(messages, "tick")[:, 0].tolist()
        poses, movables = (
            alike.read(messages, path) if path in alike.places else nothing
            for path in ("poses", "movable_poses")
        )
        for tick, row, things in zip(ticks, poses, movables, strict=True):
            if tick != due:
                raise LogError(
                    f"{reader.path}: tick {due} is missing (at {due * interval:g} s): what came "
                    "after it cannot be run again"
                )
            due += 1
            yield tick, row.reshape(-1, 3), things.reshape(-1, 3)


def things_of(world: World) -> list[str]:
    """What the obstacles that can be pushed are called: those without a name by their number."""
    pushed = [obstacle for obstacle in world.obstacles if obstacle.movable]
    return [one.name or f"movable obstacle {number}" for number, one in enumerate(pushed, 1)]


def as_told(poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """Poses (n, 3) at which robots enter, as entries tell them: the yaw in (-pi, pi]."""
    told = poses.copy()
    told[:, 2] = wrapped(poses[:, 2])
    return told


def at_door(layout: Layout, pose: tuple[float, float, float]) -> NDArray[np.float64]:
    """The exact pose of the door through which a robot came, whose entry tells `pose`."""
    doors = np.array([[*door.centre, door.heading] for door in layout.doors]).reshape(-1, 3)
    same = np.flatnonzero((as_told(doors) == pose).all(axis=1))
    return doors[same[0]] if len(same) else np.array(pose)


def by_hand(stage: Stage, hands: dict[str, Any] | None) -> None:
    """Put down robots and things, settle robots, grip and let go, in the order of all that."""
    if hands is None:
        return
    names = ("numbers", "things", "settled", "holders")
    columns = [hands[name].tolist() for name in names]
    poses = hands["poses"].reshape(-1, 3)
    for number, thing, settles, holder, pose in zip(*columns, poses, strict=True):
        if holder >= 0:
            stage.hold(holder, number)
        elif holder == -1:
            stage.let_go(number)
        elif thing:
            stage.put_thing_down(number, pose_of(pose))
        elif settles:
            stage.settle(number)
        else:
            stage.put_down(number, pose_of(pose))


def by_tick(rows: NDArray[Any]) -> dict[int, NDArray[Any]]:
    """Commands by the tick in which they were carried out."""
    if not len(rows):
        return {}
    ticks = rows["tick"]
    order = np.argsort(ticks, kind="stable")
    rows = rows[order]
    firsts = np.flatnonzero(np.r_[True, np.diff(rows["tick"]) != 0])
    return {int(part["tick"][0]): part for part in np.split(rows, firsts[1:])}


def obey(stage: Stage, row: Any) -> None:
    """Give a robot a command of the log."""
    values = [float(row[name]) for name in commands.NUMBERS]
    values += [float(row["mode"]), float(row["motors"])]
    commands.obey(stage.records[int(row["robot"])], np.array(values))


def first_difference(
    kept: NDArray[np.float64], again: NDArray[np.float64]
) -> tuple[int, tuple[float, float, float]] | None:
    """The first row of poses (n, 3) that differs in any bit, and by how much."""
    if kept.shape != again.shape:
        return min(len(kept), len(again), max(len(kept), len(again)) - 1), (np.nan, np.nan, np.nan)
    if kept.tobytes() == again.tobytes():
        return None
    bits = np.ascontiguousarray(again).view(np.int64)
    kept = np.ascontiguousarray(kept)
    row = int(np.flatnonzero((kept.view(np.int64) != bits).any(axis=1))[0])
    x, y, yaw = (again[row] - kept[row]).tolist()
    return row, (x, y, yaw)
