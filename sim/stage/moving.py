"""All that moves in a world, tick by tick, as arrays over robots."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sensors.eyes import EYES, eyes
from sim.stage.contacts import Touches
from sim.stage.fixtures import Fixtures
from sim.stage.geometry import Bools, Floats, wrapped
from sim.stage.layout import Layout
from sim.stage.may_touch import CALM
from sim.stage.memory import read_bodies
from sim.stage.physics import Physics, pose_of
from sim.stage.records import MOVER
from sim.stage.steps import BEGIN, run_steps

if TYPE_CHECKING:
    from sim.worldfile.schema import Clock, Model
BUMPER = EYES["bumper"]
NOBODY: NDArray[np.int64] = np.zeros(0, dtype=np.int64)
"""No robot's way is asked for."""
NO_WAYS: Floats = np.zeros((0, 1, 3))
NOTHING: Floats = np.zeros((0, 3))
"""The poses of no obstacles."""


class Hand(NamedTuple):
    """What no wheel does: something is put down at a pose, a robot becomes a standing body, or a
    movable obstacle is gripped or let go."""

    number: int
    """A robot, or a thing: a movable obstacle in the layout's order, after them its fixtures."""
    pose: tuple[float, float, float] | None
    thing: bool = False
    holder: int | None = None
    """The robot that holds the obstacle from now on, -1: nobody; None: that is as it was."""


class Moving:
    """Robots, movable obstacles and walls in one physical space, and time that goes by.

    Robots are numbered in the order in which they came. All arrays are views that the next
    tick, or the next robot to come, replaces: copy what must stay. Poses are (x, y, yaw) in
    metres and radians in the world's frame, yaw in (-pi, pi].
    """

    def __init__(self, layout: Layout, models: Mapping[str, Model], clock: Clock) -> None:
        self.models = models
        self._interval = clock.interval
        self._steps = max(1, round(clock.interval / clock.physics_step))
        self._physics = Physics(layout)
        self._fixtures = Fixtures(layout, self._physics)
        self._movables = len(layout.movables)
        self._touches = Touches(self._movables)
        self._count = 0
        room = self._movables + 8
        self._movers = np.zeros(room, dtype=MOVER)
        self._order = np.arange(room)
        self._poses, self._velocities = np.zeros((room, 3)), np.zeros((room, 3))
        self._distances, self._stalls = np.zeros(room), np.zeros(room, dtype=np.bool_)
        self._state = np.zeros((room, 6))  # of the movers' bodies: see `memory`
        self._known = -1  # of how many movers the names are known
        self._given: tuple[Any, ...] = ()  # what the physics of a tick is given each time
        self._contact_counts = np.zeros(room, dtype=np.int64)
        self._kinds: list[Model] = []  # by robot
        self._touches.unfelt = {
            -1 - solid.group for solid in layout.solids if not solid.look.seen_by & BUMPER
        }
        for number, movable in enumerate(layout.movables):
            self._feel(number, movable.body)
            record = self._movers[number : number + 1]
            self._physics.add(record, movable.body, None, movable.pose)
        self._changed = True
        self.told = 0
        """How many commands there have been, motors switched and robots come included."""
        self.hands: list[Hand] = []
        """What no wheel did between the latest tick and the one before, in its order."""
        self.later_hands: list[Hand] = []
        """What none has done since the latest tick."""
        self.holders: dict[int, int] = {}
        """The robot that holds a movable obstacle, by the obstacle's number."""

    # --- robots come and stand still

    def add_robot(self, model: str, pose: ArrayLike) -> int:
        """Put a robot of a model of the world on the stage, at rest; returns its number."""
        at = pose_of(pose)
        kind = self.models[model]
        robot = self._count
        number = self._movables + robot
        self._grow(number + 1)
        self._feel(number, kind.body)
        self._physics.add(self._movers[number : number + 1], kind.body, kind.drive, at)
        self._order[number] = number
        self._count += 1
        self.told += 1
        self._show(robot, at)
        self._kinds.append(kind)
        return robot

    def _feel(self, number: int, body: Any) -> None:
        """Note whether bumpers feel the touch of a mover."""
        if not eyes(body.seen_by) & BUMPER:
            self._touches.unfelt.add(number)

    def settle(self, robot: int) -> None:
        """Make a robot a standing body: nothing moves it any more, and it obeys no command."""
        record = self._record(robot)
        if record["standing"]:
            return
        self._physics.settle(self._movables + robot, record)
        record["standing"], record["driven"] = True, False
        self.later_hands.append(Hand(robot, None))
        self._rest(record)
        self._velocities[robot] = 0.0
        self._stalls[robot] = False
        self._changed = True

    def _rest(self, record: Any) -> None:
        record["wanted_x"], record["wanted_y"], record["wanted_turn"] = 0.0, 0.0, 0.0

    def _show(self, robot: int, pose: tuple[float, float, float]) -> None:
        self._poses[robot] = pose[0], pose[1], math.pi - (math.pi - pose[2]) % (2.0 * math.pi)
        self._velocities[robot] = 0.0
        self._changed = True

    # --- time

    def tick(self, traced: NDArray[np.int64] = NOBODY) -> Floats:
        """Let one interval of the clock go by.

        Returns the ways (k, m, 3) of the robots `traced` (k,): x, y and yaw, not wrapped, at the
        beginning and after each substep of the physics, in which bodies move and turn evenly.

        A command takes effect one step of physics after the tick's beginning: Chipmunk moves
        bodies with the velocities that it found in the step before.
        """
        if self.later_hands or self.hands:
            self.hands, self.later_hands = self.later_hands, []
        if self._changed:
            self._prepare()
        numbers = self._movables + traced if len(traced) else NOBODY
        place, ways = BEGIN, []
        while True:
            place, contacts, notes = run_steps(place, numbers, *self._given)
            if len(contacts):
                self._touches.add(contacts)
            ways.append(notes)
            if place[0] == self._steps:
                break
            self._sort_out()
        self._touches.finish(self._contact_counts)
        return np.concatenate(ways).swapaxes(0, 1).copy() if len(traced) else NO_WAYS

    def _sort_out(self) -> None:
        """Put into the space what may meet something, and take out what is far from everything."""
        movers = self._movers[: self._movables + self._count]
        inside, calm = movers["inside"], movers["calm"]
        for number in np.nonzero(~inside & (calm == 0))[0].tolist():
            self._physics.put_in(number, movers[number])
        stays = movers["standing"] | movers["gripped"]
        for number in np.nonzero(inside & (calm >= CALM) & ~stays)[0].tolist():
            self._physics.take_out(number, movers[number])

    def _prepare(self) -> None:
        """After a change: gather what the physics of a tick is given, and look where bodies are."""
        count, physics, field = (
            self._movables + self._count,
            self._physics,
            self._fixtures.distances,
        )
        movers, state = self._movers[:count], self._state[:count]
        if self._known != count:  # who came is named once
            self._known = count
            self._touches.rename(*physics.names())
        self._given = (
            physics.machine, state, movers, self._movables, count, self._order[:count],
            field.cells, field.frame, physics.outlines, physics.sides, self._interval, self._steps,
            self._poses, self._velocities, self._distances, self._stalls,
        )  # fmt: skip
        read_bodies(state, movers, count)
        order = self._order[:count]  # a tick keeps it sorted; a crowd that has come is sorted here
        order[:] = order[np.argsort(state[order, 0], kind="stable")]
        self._changed = False

    def _grow(self, needed: int) -> None:
        """Make room for so many movers."""
        if needed <= len(self._movers):
            return

        def longer(array: NDArray[Any]) -> NDArray[Any]:
            return np.concatenate([array, np.zeros_like(array)])

        self._movers, self._order = longer(self._movers), longer(self._order)
        self._poses, self._velocities = longer(self._poses), longer(self._velocities)
        self._distances, self._stalls = longer(self._distances), longer(self._stalls)
        self._state = longer(self._state)
        self._contact_counts = longer(self._contact_counts)

    # --- what there is to see

    @property
    def layout(self) -> Layout:
        """All that stands, where it stands now."""
        return self._fixtures.layout

    @property
    def records(self) -> NDArray[Any]:
        """(n,) of dtype MOVER: all that is known of each robot, the command in force included."""
        return self._movers[self._movables : self._movables + self._count]

    def _telling(self, robot: int) -> Any:
        """The record of a robot that is told something."""
        self.told += 1
        return self._record(robot)

    def _record(self, robot: int) -> Any:
        if not 0 <= robot < self._count:
            raise IndexError(f"there is no robot {robot}; the stage has {self._count}")
        return self._movers[self._movables + robot]

    def model(self, robot: int) -> Model:
        """The model that a robot was built by."""
        return self._kinds[robot]

    @property
    def count(self) -> int:
        """Number of robots."""
        return self._count

    @property
    def poses(self) -> Floats:
        """(n, 3) x, y, yaw."""
        return self._poses[: self._count]

    @property
    def velocities(self) -> Floats:
        """(n, 3) vx, vy, wz in the robot's frame, as the bodies really move."""
        return self._velocities[: self._count]

    @property
    def stalls(self) -> Bools:
        """(n,) Whether each was kept from what it wanted to do in the latest tick.

        Precisely: over the tick it was wanted to move faster than 0.01 m/s, and went less than
        half of the wanted way along the wanted direction; or it was wanted to turn faster than
        0.02 rad/s, and turned less than half of that. Wanted is what the limits of acceleration
        leave of the command, so that speeding up is no stall.
        """
        return self._stalls[: self._count]

    @property
    def contact_counts(self) -> NDArray[np.int64]:
        """(n,) How often each began to touch another body or a wall.

        A pair counts in a tick in which it touches if it did not in the tick before. The walls
        of a map are one thing, each wall of the boundary and each obstacle is another.
        """
        return self._contact_counts[: self._count]

    @property
    def distances(self) -> Floats:
        """(n,) Metres that each has gone, driven or pushed."""
        return self._distances[: self._count]

    @property
    def settled(self) -> Bools:
        """(n,) Which are standing bodies."""
        standing: Bools = self.records["standing"]
        return standing

    @property
    def contact_points(self) -> tuple[NDArray[np.int64], Floats]:
        """Robots (k,) ascending, and points (k, 2) in the world, of the latest tick's contacts."""
        return self._touches.points

    def contact_points_of(self, robots: NDArray[np.int64]) -> tuple[NDArray[np.int64], Floats]:
        """Those of some robots (r,) alone: quicker where these are few."""
        return self._touches.points_of(robots)

    @property
    def stretches(self) -> tuple[NDArray[np.int64], Floats, Floats]:
        """Robots (m,) ascending, and where they touched something in the latest tick.

        (m, 2) and (m, 2): where the straight stretch of the robot's own outline that touched begins
        and ends; the same where a corner or something round touches in a point.
        """
        return self._touches.stretches

    @property
    def touching(self) -> Bools:
        """(n,) Which robots touched anything in the latest tick."""
        found = np.zeros(self._count, dtype=np.bool_)
        found[self._touches.pairs[0]] = True
        return found

    def thing_pose(self, number: int) -> tuple[float, float, float]:
        """Where a thing is."""
        if number >= self._movables:
            return self.layout.fixtures[number - self._movables].pose
        x, y, yaw = self.movable_poses[number].tolist()
        return x, y, yaw

    @property
    def movable_poses(self) -> Floats:
        """(m, 3) Poses of the movable obstacles, in the layout's order."""
        if not self._movables:
            return NOTHING
        state = np.zeros((self._movables, 6))
        read_bodies(state, self._movers, self._movables)
        poses = state[:, :3].copy()
        poses[:, 2] = wrapped(poses[:, 2])
        return poses
