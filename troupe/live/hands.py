"""What hands do to a run, between two ticks; all of it is put down in the run's result."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from sim.result import Touch

if TYPE_CHECKING:
    from sim.engine import Engine
    from sim.robot import Robot

Twist = tuple[float, float, float]
"""vx, vy, wz in the robot's frame: m/s and rad/s."""
STILL: Twist = (0.0, 0.0, 0.0)


class Grip:
    """A hand on a robot that somebody else drives: what that one commands does not count."""

    def __init__(self, meant: Twist) -> None:
        self.wish = STILL
        self.meant = meant
        """What the robot's own controller has commanded last."""


class Hands:
    """The hands that reach into one run."""

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        self.taken: dict[int, Grip] = {}

    def put(self, robot: int, pose: Sequence[float]) -> bool:
        """Lift a robot and put it down; False, and nothing done, where there is no room for it."""
        scenery = self.engine.scenery
        if not 0 <= robot < scenery.stage.count:
            return False
        goal = (pose[0], pose[1], math.remainder(pose[2], math.tau))
        if scenery.put({robot: goal}):
            return False
        scenery.refresh()
        self.note("put", self.engine.robots[robot].name, goal)
        return True

    def put_thing(self, thing: int, pose: Sequence[float]) -> bool:
        """The same for a thing."""
        scenery = self.engine.scenery
        goal = (pose[0], pose[1], math.remainder(pose[2], math.tau))
        if not scenery.put_thing(thing, goal):
            return False
        scenery.refresh()
        self.note("put_thing", str(thing), goal)
        return True

    def drive(self, robot: int, twist: Sequence[float]) -> str | None:
        """Have a robot drive from the next tick on; why not, if it cannot."""
        wish = (twist[0], twist[1], twist[2])
        refusal = cannot_drive(self.engine, robot)
        if refusal is not None:
            return refusal
        driven = self.engine.robots[robot]
        if robot in self.taken:
            self.taken[robot].wish = wish
            self.hold()
        else:
            driver = driving(driven)
            if driver is not None:
                return f"{driver} drives it: take it over first"
            context = self.engine.context
            context.later(driven, lambda: context.drive(driven, wish), "hand")
            self.engine.drivers.clocks.has_asked(driven.driver)  # the hand is there: nobody waits
        self.note("drive", driven.name, wish)
        return None

    def take(self, robot: int) -> str | None:
        """Hold a robot, whoever drives it, until it is given back; why not, if one cannot."""
        refusal = cannot_drive(self.engine, robot)
        if refusal is not None or robot in self.taken:
            return refusal
        kind, numbers = self.engine.scenery.stage.command_of(robot)
        meant = (numbers[0], numbers[1], numbers[2]) if kind == "twist" else STILL
        self.taken[robot] = Grip(meant)
        self.hold()
        self.note("take", self.engine.robots[robot].name)
        return None

    def give(self, robot: int) -> None:
        """Let a robot go that was taken: its controller's last command counts again."""
        grip = self.taken.pop(robot, None)
        if grip is None:
            return
        context, driven = self.engine.context, self.engine.robots[robot]
        back = grip.meant if driven.driver.running else STILL
        context.later(driven, lambda: context.drive(driven, back), "hand")
        self.note("give", driven.name)

    def hold(self) -> None:
        """Have the wishes of hands that hold robots come after all else that was commanded."""
        for robot in list(self.taken):
            driven = self.engine.robots[robot]
            if self.engine.scenery.stage.settled[robot]:
                del self.taken[robot]
            else:
                self.engine.context.later(driven, partial(self._have, driven), "hand")

    def _have(self, driven: Robot) -> None:
        context, grip = self.engine.context, self.taken.get(driven.index)
        if grip is not None:
            grip.meant = context.twists.get(driven.index, grip.meant)
            context.drive(driven, grip.wish)

    def note(self, what: str, who: str | None = None, numbers: Sequence[float] = ()) -> None:
        """Put down what was done; of the same to the same within one tick the last counts."""
        engine = self.engine
        touch = Touch(engine.time, engine.ticks, who, what, tuple(map(float, numbers)))
        first = len(engine.touched)
        while first and engine.touched[first - 1].tick == touch.tick:
            first -= 1
        of_now = engine.touched[first:]
        others = [one for one in of_now if (one.robot, one.what) != (touch.robot, touch.what)]
        engine.touched[first:] = [*others, touch]


def cannot_drive(engine: Engine, robot: int) -> str | None:
    """Why nobody can drive a robot; None: somebody could."""
    if not 0 <= robot < engine.scenery.stage.count:
        return "there is no such robot"
    if not engine.robots[robot].driver.drives:
        return "it has no drive"
    if engine.scenery.stage.settled[robot]:
        return "it has become a standing body, as its controller has ended"
    return None


def driving(robot: Robot) -> str | None:
    """Who drives a robot besides hands, in words."""
    driver = robot.driver
    if driver.running and (driver.launched or driver.kind == "function"):
        return "its controller"
    return "a client" if driver.driving else None
