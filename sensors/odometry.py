"""Odometry: where each robot believes to be, in the frame of its own start.

Exact odometry is the true pose seen from the start. With noise, each increment of the true motion
is measured wrongly and the wrong increments are added up, as wheels do it: the error grows with
the way, stays while the robot stands, and is never white noise on the pose. The error of an
increment is Gaussian with a variance in proportion to its length, so that it does not matter how
often one looks: after 1 m the distance is wrong by `slip` metres (standard deviation), after 4 m
by twice that; likewise `turn` for a radian turned. With `bias` the errors are constant factors of
ways and turns besides, as of wheels that are a little too large. A gps reports the world pose.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from sensors.compiled import compiled
from sensors.grid import Flags, Floats
from sensors.noise import Keys, gaussian_at, stream_key

ROUNDING = 1e-12
"""Radians by which sums of angles may be off."""


class Odometry:
    """The reported poses of all robots; a robot's index is the order in which it was added."""

    def __init__(self, seed: int) -> None:
        self.seed = seed
        self._count = 0
        self._reported = np.zeros((0, 3))  # these have room for more robots than there are
        self._true = np.zeros((0, 3))  # true poses at the last update
        self._frames = np.zeros((0, 3))  # exact odometry: the frame's origin in the world
        self._gps = np.zeros(0, np.bool_)
        self._errors = np.zeros((0, 5))  # slip, turn; factors of ways ahead and aside, of turns
        self._keys: Keys = np.zeros(0, np.uint64)
        self.poses: Floats = self._reported
        """(n, 3) the last reported x, y in metres and yaw in (-pi, pi]."""

    def __len__(self) -> int:
        return self._count

    def add_robot(
        self,
        name: str,
        pose: Sequence[float],
        *,
        gps: bool = False,
        slip: float = 0.0,
        turn: float = 0.0,
        bias: Sequence[float] = (0.0, 0.0, 0.0),
        frame: Sequence[float] | None = None,
    ) -> int:
        """Add a robot that stands at `pose` (x, y, heading in the world) and return its index.

        Args:
            name: makes, with the seed, the robot's own stream of noise.
            gps: report the world pose, without noise.
            slip: standard deviation of the distance after one metre, in metres.
            turn: standard deviation of the heading after one radian turned, in radians.
            bias: how wide the spread is of the constant relative errors of ways ahead, of ways
                aside and of turns: each is drawn once, evenly from half of it below 0 to half
                above.
            frame: the pose in the world from which odometry counts; unless given, `pose`.
        """
        if not (min(slip, turn, *bias) >= 0.0 and math.isfinite(slip + turn + sum(bias))):
            raise ValueError(f"odometry noise must not be negative: {slip}, {turn}, {tuple(bias)}")
        robot = self._count
        if robot == len(self._true):
            for of in ("_reported", "_true", "_frames", "_gps", "_errors", "_keys"):
                old = getattr(self, of)
                new = np.zeros((2 * robot + 8, *old.shape[1:]), old.dtype)
                new[:robot] = old
                setattr(self, of, new)
        self._count += 1
        self._true[robot] = pose
        self._gps[robot] = gps
        drawn = [
            width * (float(stream_key(self.seed, name, "bias", axis)) / 2.0**64 - 0.5)
            if width
            else 0.0
            for axis, width in enumerate(bias)
        ]
        self._errors[robot] = slip, turn, *drawn
        self._keys[robot] = stream_key(self.seed, name, "odometry")
        if gps:
            x, y, heading = self._true[robot]
            self._reported[robot] = x, y, _wrap(heading)
        else:
            self._frames[robot] = self._true[robot] if frame is None else frame
            self._reported[robot] = _seen_from(self._frames[robot], self._true[robot])
        self.poses = self._reported[: self._count]
        return robot

    def update(self, true_poses: npt.ArrayLike, dt: float, tick: int) -> Floats:
        """Take the true poses (n, 3) after a tick and return the reported ones (n, 3).

        Args:
            true_poses: x, y, heading of all robots, in the order in which they were added.
            dt: seconds since the last update; the drift depends on the way alone.
            tick: the number of the tick: the noise of a tick is always the same.
        """
        true = np.ascontiguousarray(true_poses, np.float64)
        if true.shape != self.poses.shape:
            raise ValueError(f"odometry of {len(self.poses)} robots got poses of {true.shape}")
        _update(
            true, self._true, self._frames, self._gps, self._errors, self._keys, tick, self.poses
        )
        return self.poses

    def set_odometry(self, robot: int, pose: Sequence[float]) -> None:
        """Make `pose` (x, y, yaw) what the robot reports where it stands now.

        A gps knows the world pose and stays as it is.
        """
        if not self._gps[robot]:
            x, y, yaw = map(float, pose)
            self.poses[robot] = x, y, _wrap(yaw)
            self._anchor(robot)

    def reset(self, robot: int) -> None:
        """Make the robot's present place the origin of its odometry; a gps stays as it is."""
        self.set_odometry(robot, (0.0, 0.0, 0.0))

    def relocate(self, robot: int, pose: Sequence[float]) -> None:
        """Tell that the robot was put to `pose` in the world by hand: no wheel turned.

        Odometry goes on from what it reported before; a gps reports the new pose.
        """
        self._true[robot] = pose
        if self._gps[robot]:
            self.poses[robot] = self._true[robot, 0], self._true[robot, 1], _wrap(float(pose[2]))
        else:
            self._anchor(robot)

    def in_world(self, robot: int) -> tuple[float, float, float]:
        """Where the robot believes to be, in the world: x, y, yaw from where its frame lies."""
        x, y, yaw = self.poses[robot].tolist()
        fx, fy, turn = self._frames[robot].tolist()
        cos, sin = math.cos(turn), math.sin(turn)
        return fx + cos * x - sin * y, fy + sin * x + cos * y, turn + yaw

    def _anchor(self, robot: int) -> None:
        """Lay the frame so that the true pose, seen from it, is the reported one."""
        x, y, yaw = self.poses[robot]
        heading = self._true[robot, 2] - yaw
        cos, sin = math.cos(heading), math.sin(heading)
        self._frames[robot, 0] = self._true[robot, 0] - (cos * x - sin * y)
        self._frames[robot, 1] = self._true[robot, 1] - (sin * x + cos * y)
        self._frames[robot, 2] = heading


def _seen_from(frame: Floats, pose: Floats) -> tuple[float, float, float]:
    """A pose in the frame at another one."""
    (x, y, yaw), (fx, fy, turn) = pose.tolist(), frame.tolist()
    dx, dy = x - fx, y - fy
    cos, sin = math.cos(turn), math.sin(turn)
    return cos * dx + sin * dy, cos * dy - sin * dx, _wrap(yaw - turn)


@compiled
def _wrap(angle: float) -> float:
    """The same angle in (-pi, pi]; half a turn is +pi, whatever it was rounded to."""
    turned = angle - 2.0 * math.pi * math.ceil((angle - math.pi) / (2.0 * math.pi))
    return turned if turned > ROUNDING - math.pi else math.pi


@compiled
def _update(
    true: Floats,
    last: Floats,
    frames: Floats,
    gps: Flags,
    errors: Floats,
    keys: Keys,
    tick: int,
    poses: Floats,
) -> None:
    for k in range(true.shape[0]):
        x, y, heading = true[k, 0], true[k, 1], true[k, 2]
        slip, turn = errors[k, 0], errors[k, 1]
        exact = errors[k, 2] == 0.0 and errors[k, 3] == 0.0 and errors[k, 4] == 0.0
        if gps[k]:
            poses[k, 0], poses[k, 1], poses[k, 2] = x, y, _wrap(heading)
        elif slip == 0.0 and turn == 0.0 and exact:
            dx, dy, origin = x - frames[k, 0], y - frames[k, 1], frames[k, 2]
            cos, sin = math.cos(origin), math.sin(origin)
            poses[k, 0] = cos * dx + sin * dy
            poses[k, 1] = cos * dy - sin * dx
            poses[k, 2] = _wrap(heading - origin)
        else:
            dx, dy, before = x - last[k, 0], y - last[k, 1], last[k, 2]
            cos, sin = math.cos(before), math.sin(before)
            ahead, aside = cos * dx + sin * dy, cos * dy - sin * dx
            turned = _wrap(heading - before)  # 179 to -179 degrees is a turn by 2, not by 358
            way = math.hypot(ahead, aside)
            if way > 0.0:
                stretch = 1.0 + slip * math.sqrt(way) * gaussian_at(keys[k], tick, 0) / way
                ahead, aside = ahead * stretch, aside * stretch
            turned += turn * math.sqrt(abs(turned)) * gaussian_at(keys[k], tick, 1)
            if not exact:
                ahead *= 1.0 + errors[k, 2]
                aside *= 1.0 + errors[k, 3]
                turned *= 1.0 + errors[k, 4]
            yaw = poses[k, 2]
            cos, sin = math.cos(yaw), math.sin(yaw)
            poses[k, 0] += cos * ahead - sin * aside
            poses[k, 1] += sin * ahead + cos * aside
            poses[k, 2] = _wrap(yaw + turned)
        last[k, 0], last[k, 1], last[k, 2] = x, y, heading
