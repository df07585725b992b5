"""Commands from Python: which robots they are for, and the velocities that they shall keep."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.engine import Engine
from sim.robot import Robot
from troupe.given import listed

Robots = int | str | Iterable[int | str] | None


class Driving:
    """What is commanded from Python to the robots of one engine."""

    def __init__(self, engine: Engine) -> None:
        self._robots = engine.robots
        self._by_name = engine.context.by_name
        self._stage = engine.scenery.stage
        self._all = np.zeros(0, np.int64)
        self._twists = np.zeros((0, 3))  # room for those of all robots
        self._free = True  # nobody else ever drives any of them, and all can be driven

    def indices(self, robots: Robots | ArrayLike = None) -> NDArray[np.int64]:
        """Robots, given by index or name, as indices (k,); None: all of them.

        Raises ValueError for a robot that is not there.
        """
        if robots is None:
            return self._everybody().copy()
        found = []
        for robot in np.atleast_1d(np.asarray(robots, dtype=object)).reshape(-1).tolist():
            if isinstance(robot, str):
                if robot not in self._by_name:
                    names = [one.name for one in self._robots]
                    raise ValueError(f"there is no robot {robot!r}; there are {listed(names)}")
                found.append(self._by_name[robot].index)
            elif isinstance(robot, int) and 0 <= robot < len(self._robots):
                found.append(robot)
            else:
                raise ValueError(
                    f"there is no robot {robot!r}: they are 0 to {len(self._robots) - 1}"
                )
        return np.array(found, np.int64)

    def command(
        self, robots: Robots | ArrayLike, forward: ArrayLike, side: ArrayLike, turn: ArrayLike
    ) -> None:
        """See `Simulation.command`."""
        which = self._everybody() if robots is None else self._known(robots)
        if robots is not None or not self._free:
            self._refuse_driven(which)
        twists = self._twists if robots is None else np.empty((len(which), 3))
        for column, given in enumerate((forward, side, turn)):
            values = np.asarray(given, np.float64)
            if values.shape not in ((), which.shape):
                name = ("forward", "side", "turn")[column]
                raise ValueError(
                    f"command: {name} has the shape {values.shape}; it must be a number, or one "
                    f"for each of the {len(which)} robots"
                )
            twists[:, column] = values
        try:
            self._stage.command(which, twists)
        except ValueError:
            raise ValueError("command: velocities must be finite numbers") from None

    def _everybody(self) -> NDArray[np.int64]:
        """(n,) the indices of all robots; not to be given away."""
        if len(self._all) != len(self._robots):
            self._all = np.arange(len(self._robots))
            self._twists = np.zeros((len(self._robots), 3))
            self._free = all(is_free(robot) for robot in self._robots)
        return self._all

    def _known(self, robots: Robots | ArrayLike) -> NDArray[np.int64]:
        """As `indices`; the arrays of indices that readings have are looked through at once."""
        if isinstance(robots, np.ndarray) and robots.dtype == np.int64 and robots.ndim == 1:
            given: NDArray[np.int64] = robots
            if ((given >= 0) & (given < len(self._robots))).all():
                return given
        return self.indices(robots)

    def _refuse_driven(self, robots: NDArray[np.int64]) -> None:
        """A robot with a controller of its own obeys that one alone."""
        self._everybody()
        if self._free:
            return
        for index in robots.tolist():
            robot = self._robots[index]
            if robot.driver.kind != "none" and robot.driver.running:
                raise ValueError(
                    f"command: {robot.name} is driven by its controller; give controllers=False, "
                    "or a mapping without it, to drive it from here"
                )
            if robot.model.drive is None:
                raise ValueError(f"command: {robot.name} has no drive")


def is_free(robot: Robot) -> bool:
    """Whether a robot has a drive and never a controller of its own."""
    return robot.driver.kind == "none" and robot.model.drive is not None
