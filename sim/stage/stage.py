"""The stage: all that moves in a world, with what it is told and what hands do to it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sim.stage import commands
from sim.stage.geometry import Floats
from sim.stage.moving import Hand, Moving
from sim.stage.physics import pose_of
from sim.stage.putting import Places
from sim.stage.records import CAR, COMMAND_FIELDS, COMMANDS


class Stage(Moving):
    """What moves (see `Moving`), driven by commands and moved by hand.

    Robots are numbered in the order in which they came. Poses are (x, y, yaw) in metres and radians
    in the world's frame, yaw in (-pi, pi].
    """

    # --- moved by hand

    def hold(self, robot: int, number: int) -> None:
        """Let a robot hold a movable obstacle as it lies: it goes where the robot goes.

        Raises ValueError where somebody holds it.
        """
        self._record(robot)
        if number in self.holders or not 0 <= number < self._movables:
            raise ValueError(f"there is no movable obstacle {number} that nobody holds")
        ones = [self._movables + robot, number]
        for one in ones:
            if not self._movers[one]["inside"]:
                self._physics.put_in(one, self._movers[one])
        self._movers["gripped"][ones] = True
        self._physics.hold(*ones)
        self.holders[number] = robot
        self.later_hands.append(Hand(number, None, thing=True, holder=robot))

    def let_go(self, number: int) -> None:
        """Let whoever holds a movable obstacle let it go. Raises KeyError where nobody does."""
        holder = self.holders.pop(number)
        self._physics.let_go(number)
        self._movers["gripped"][number] = False
        self._movers["gripped"][self._movables + holder] = holder in self.holders.values()
        self.later_hands.append(Hand(number, None, thing=True, holder=-1))

    def set_pose(self, robot: int, pose: ArrayLike) -> None:
        """Lift a robot and put it down, at rest, at a pose (x, y, yaw); its commands stay.

        What it holds stays where it is. The way there does not count as gone. Raises ValueError
        where the robot would be outside of the world, or in a wall, an obstacle or another robot.
        """
        if self.set_poses({robot: pose}):
            raise ValueError(f"robot {robot} has no room at {pose_of(pose)}")

    def set_poses(self, poses: Mapping[int, ArrayLike]) -> list[int]:
        """Lift robots all at once and put them down at their poses, as `set_pose` does.

        Those for whom there is no room, in the order of the mapping, stay where they are and are
        in the way of others. Returns their numbers.
        """
        goals = {}
        for robot, pose in poses.items():
            self._record(robot)
            goals[robot] = pose_of(pose)
        found = self._places.fitting(goals, *self._moving())
        for robot, at in found.items():
            self.put_down(robot, at)
        return [robot for robot in goals if robot not in found]

    def put_thing(self, number: int, pose: ArrayLike) -> bool:
        """Lift a thing and put it down, at rest; False where there is no room for it.

        Things are the movable obstacles, and after them the layout's fixtures. Who holds one
        lets go.
        """
        goal = pose_of(pose)
        things = self._movables + len(self.layout.fixtures)
        if not (0 <= number < things and self.fits(self._count + number, goal)):
            return False
        self.put_thing_down(number, goal)
        return True

    def put_thing_down(self, number: int, at: tuple[float, float, float]) -> None:
        """Put a thing down, at rest, where there is known to be room for it."""
        if number in self.holders:
            self.let_go(number)
        self.later_hands.append(Hand(number, at, thing=True))
        self._changed = True
        if number >= self._movables:
            self._fixtures.put(number - self._movables, at)
            return
        self._physics.put(number, at)
        record = self._movers[number]
        record["x"], record["y"] = at[0], at[1]
        self._rest(record)

    def command_of(self, robot: int) -> tuple[str, tuple[float, ...]]:
        """What a robot was commanded last.

        "twist" with vx, vy, wz; "steering" with a speed and a curvature (1/m); "position" with a
        pose in the world; "heading" with a speed and a heading. Metres, radians, seconds.
        """
        record = self._record(robot)
        kind = COMMANDS[record["mode"]]
        return kind, tuple(float(record[name]) for name in COMMAND_FIELDS[kind])

    def put_down(self, robot: int, at: tuple[float, float, float]) -> None:
        """Put a robot down, at rest, at a pose where there is known to be room for it."""
        record = self._record(robot)
        for number in [one for one, holder in self.holders.items() if holder == robot]:
            self.let_go(number)
        self.later_hands.append(Hand(robot, at))
        self._physics.put(self._movables + robot, at)
        record["x"], record["y"] = at[0], at[1]
        self._rest(record)
        self._show(robot, at)

    def fits(self, robot: int, pose: ArrayLike, moved: Mapping[int, ArrayLike] = {}) -> bool:
        """Whether a robot could be put at a pose, once the robots `moved` are at theirs.

        Things come after the robots.
        """
        bodies, poses = self._moving()
        for other, at in moved.items():
            poses[other] = pose_of(at)
        if robot >= len(bodies):
            return self._fixtures.fits(robot - len(bodies), pose_of(pose), bodies, poses)
        others = np.arange(len(bodies)) != robot
        rest = [body for body, other in zip(bodies, others, strict=True) if other]
        return self._places.free(bodies[robot], pose_of(pose), rest, poses[others])

    def _moving(self) -> tuple[list[Any], Floats]:
        """The bodies of the robots, then of the movable obstacles, and a copy of their poses."""
        bodies: list[Any] = [kind.body for kind in self._kinds]
        bodies += [movable.body for movable in self.layout.movables]
        return bodies, np.concatenate([self.poses, self.movable_poses])

    @property
    def _places(self) -> Places:
        return self._fixtures.places

    # --- commands

    def command(self, robots: ArrayLike, twists: ArrayLike) -> None:
        """Set what robots (k,) are to do until told otherwise: twists (k, 3) vx, vy, wz.

        Metres and radians per second in the robot's frame, cut to the drive's limits: an
        omnidirectional drive to max_speed in any direction; a differential drive ignores vy; a
        car drives the circle of radius vx / wz, or the narrowest that it can steer, and a wider
        one where it would turn faster than max_turn_rate.
        """
        which = np.ascontiguousarray(robots, dtype=np.int64).reshape(-1)
        wanted = np.ascontiguousarray(twists, dtype=np.float64).reshape(-1, 3)
        everything = self._movers[: self._movables + self._count]
        self.told += 1
        commands.command_twists(everything, self._movables, which, wanted)

    def command_car(self, robot: int, speed: float, steering: float) -> None:
        """Set a car's speed (m/s) and the angle of its front wheels (rad), cut to its limits.

        The origin of a car's body is the middle of its rear axle: it drives a circle of radius
        wheelbase / tan(steering), or a wider one where that would turn it faster than its
        max_turn_rate. Raises ValueError for other drives.
        """
        record = self._telling(robot)
        car = self.model(robot).drive
        if record["kind"] != CAR or car is None or car.wheelbase is None:
            raise ValueError(f"robot {robot} has no steering")
        commands.command_steering(record, speed, steering, car.wheelbase)

    def command_position(
        self, robot: int, pose: ArrayLike, speed: float = 0.0, turn_rate: float = 0.0
    ) -> None:
        """Send a robot to a pose (x, y, yaw; world), not around anything; there it stays.

        speed (m/s) and turn_rate (rad/s) bound this journey; 0 stands for the drive's limits.
        A differential drive turns towards the goal, drives until it is within 0.02 m, and turns
        to the goal's yaw; an omnidirectional one does all at once; a car cannot: ValueError.
        """
        record = self._telling(robot)
        self._refuse_car(robot, record)
        commands.command_pose(record, pose_of(pose), speed, turn_rate)

    def command_heading(self, robot: int, speed: float, heading: float) -> None:
        """Set a robot's speed (m/s) and the heading (rad, world) that it shall turn to and hold.

        Raises ValueError for a car.
        """
        record = self._telling(robot)
        self._refuse_car(robot, record)
        commands.command_heading(record, speed, heading)

    def _refuse_car(self, robot: int, record: Any) -> None:
        if record["kind"] == CAR:
            raise ValueError(f"robot {robot} is a car: it takes speeds and steering, not poses")

    def motors(self, robot: int, on: bool) -> None:
        """Switch a robot's motors; switched off it brakes and stands, whatever it is told."""
        self._telling(robot)["motors"] = on
