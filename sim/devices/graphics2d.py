"""graphics2d: shapes that a robot's program draws into the video."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from player import DeviceAddr
from player.codes import Interface
from sim.devices.device import FARTHEST, Context, Refused, Values
from sim.robot import Robot
from sim.view.figure import Figure

MAX_DRAWINGS = 2_000
"""Shapes kept of one robot: older ones go."""
MAX_POINTS = 50_000
"""Points kept of one robot's shapes in all: again, older ones go."""


class Graphics2d:
    """Shapes that a program draws into the video, in its robot's frame."""

    def __init__(self, context: Context, robot: Robot) -> None:
        self.context = context
        self.robot = robot
        self.addr = DeviceAddr(Interface.GRAPHICS2D, 0)
        self.drawings: list[Figure] = []  # as they are going to be

    def publish(self) -> Iterable[tuple[int, bytes]]:
        return ()

    def command(self, name: str, values: Values) -> None:
        if name == "clear":
            self.drawings.clear()
        else:
            self.draw(name, values)
        self.context.later(self.robot, self.show, "drawings")

    def show(self) -> None:
        self.robot.drawings = list(self.drawings)

    def draw(self, name: str, values: Values) -> None:
        """One more shape, at the cost of the oldest where there are too many."""
        drawings = self.drawings
        fill = rgb(values["fill_color"]) if values.get("filled") else None
        points = np.array(values["points"], np.float64).reshape(-1, 2)[:MAX_POINTS]
        if not np.isfinite(points).all():
            what = f"graphics2d's {name} with points that are no numbers: nothing is drawn"
            self.context.complain(self.robot, what)
            return
        far = np.abs(points).max(axis=1, initial=FARTHEST, keepdims=True)
        points = np.clip(points * (FARTHEST / far), -FARTHEST, FARTHEST)  # in its direction
        drawings.append(Figure(name, points, rgb(values["color"]), fill))
        del drawings[:-MAX_DRAWINGS]
        while sum(len(drawing.points) for drawing in drawings) > MAX_POINTS:
            del drawings[0]

    def request(self, name: str, values: Values) -> Values | None:
        raise Refused


def rgb(color: tuple[int, int, int, int]) -> int:
    """Player's (alpha, red, green, blue) as 0xRRGGBB."""
    _, red, green, blue = color
    return red << 16 | green << 8 | blue


def devices(context: Context, robot: Robot) -> Iterable[Graphics2d]:
    """Every robot can draw."""
    return [Graphics2d(context, robot)]
