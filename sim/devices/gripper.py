"""gripper: paddles that close on what can be pushed, hold it, and let it go."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from player import DeviceAddr, layouts
from player.codes import Interface
from sim.devices.device import Context, Refused, Values, flat_pose
from sim.devices.jaws import BEAMS, Between, Jaws
from sim.robot import Robot
from sim.stage.geometry import Floats, placed
from sim.view.figure import Figure
from sim.worldfile.schema import Gripper as Mount

STATE = layouts.data(Interface.GRIPPER).head
OPEN, CLOSED = 1, 2

THICKNESS = 0.1
"""Of a paddle as it is drawn, in widths of the space between the two."""
COLOR = 0x404040


class Gripper:
    """A gripper of a robot. Its paddles open and close at once, and have no bodies.

    They close on one thing: a movable obstacle that breaks a beam, lies between them with all that
    it is, shares a height with the robot's body, and is held by nobody. Of several it is one that
    breaks the inner beam, then the nearest to the middle. It is fixed to the robot as it lies.
    """

    def __init__(self, context: Context, robot: Robot, mount: Mount, index: int) -> None:
        self.context = context
        self.robot = robot
        self.mount = mount
        self.index = index
        self.addr = DeviceAddr(Interface.GRIPPER, index)
        self.state = OPEN
        self.thing: int | None = None  # the movable obstacle that it has closed on
        layout = context.scenery.stage.layout
        bodies, levels = [one.body for one in layout.movables], layout.levels
        self.jaws = Jaws(mount, bodies)
        own = levels.of(robot.model.body)
        self.reachable = [bool(levels.of(body) & own) for body in bodies]
        self.show(self.jaws.width / 2, -self.jaws.width / 2)

    def publish(self) -> Iterable[tuple[int, bytes]]:
        beams = 0
        surroundings = self.context.scenery.surroundings
        for one in self.between(surroundings.scene.poses[surroundings.movables]):
            if self.state == OPEN or one.number == self.held:
                beams |= one.beams
        return ((1, STATE.pack(self.state, beams, 0)),)

    def between(self, poses: Floats) -> list[Between]:
        """What breaks a beam of the movable obstacles, which are at poses (m, 3)."""
        robot = self.context.scenery.stage.poses[self.robot.index]
        return [one for one in self.jaws.lying(robot, poses) if self.reachable[one.number]]

    @property
    def held(self) -> int | None:
        """What it holds: somebody may have taken it away by hand."""
        thing, holders = self.thing, self.context.scenery.stage.holders
        return thing if thing is not None and holders.get(thing) == self.robot.index else None

    def command(self, name: str, values: Values) -> None:
        action = {"open": self.open, "close": self.close}.get(name)
        if action is not None:  # there is nothing to stop half-way, and no store
            self.context.later(self.robot, action, ("gripper", self.index))

    def open(self) -> None:
        self.state = OPEN
        if self.held is not None:
            self.context.scenery.stage.let_go(self.held)
        self.thing = None
        self.show(self.jaws.width / 2, -self.jaws.width / 2)

    def close(self) -> None:
        if self.state == CLOSED:
            return
        self.state = CLOSED
        stage = self.context.scenery.stage
        there = self.between(stage.movable_poses)
        free = [one for one in there if one.fits and one.number not in stage.holders]
        if not free:
            self.show(0.0, 0.0)
            return
        inner = BEAMS[0][0]
        chosen = min(free, key=lambda one: (not one.beams & inner, one.off, one.number))
        self.thing = chosen.number
        stage.hold(self.robot.index, chosen.number)
        self.show(chosen.sides[1], chosen.sides[0])

    def show(self, left: float, right: float) -> None:
        """Have the paddles drawn with their inner sides at y = `left` and `right`."""
        length, thick = self.jaws.length / 2, THICKNESS * self.jaws.width
        self.robot.paddles[self.index] = [
            Figure("polygon", placed(corners, self.jaws.pose), COLOR, COLOR)
            for corners in (
                np.array([(-length, y), (length, y), (length, y + out), (-length, y + out)])
                for y, out in ((left, thick), (right, -thick))
            )
        ]
        self.robot.show_drawings()

    def request(self, name: str, values: Values) -> Values | None:
        if name != "geometry":
            raise Refused
        (length, width), height = self.mount.space, self.robot.model.body.height
        return {
            "pose": flat_pose(*self.jaws.pose),
            "outer_size": (width * (1 + 2 * THICKNESS), length, height),
            "inner_size": (width, length, height),
            "beams": len(BEAMS),
            "capacity": 0,
        }


def devices(context: Context, robot: Robot) -> Iterable[Gripper]:
    """One for each gripper of the robot's model."""
    mounts = [one for one in robot.model.actuators if isinstance(one, Mount)]
    return [Gripper(context, robot, mount, index) for index, mount in enumerate(mounts)]
