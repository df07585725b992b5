"""Drawing into the simulation's picture, in the robot's own frame."""

from __future__ import annotations

from operator import index

import numpy.typing as npt

from player.codes import Interface
from player.proxies.base import Proxy
from player.xdr import Color

RED = 0xFF0000

POINTS, POLYLINE, POLYGON, MULTILINE = 2, 3, 4, 5


class Graphics2dProxy(Proxy):
    """Player's graphics2d: shapes that the video shows, until they are cleared.

    Points are (k, 2): x ahead of the robot, y to its left, metres. Colours are 0xRRGGBB, as those
    of blobs. Raises ValueError for what is no colour, or no array of points.
    """

    interface = Interface.GRAPHICS2D

    def clear(self) -> None:
        """Removes what this robot has drawn."""
        self._command(1)

    def draw_points(self, points: npt.ArrayLike, color: int = RED) -> None:
        """Draws points."""
        self._command(POINTS, points=points, color=_color(color))

    def draw_polyline(self, points: npt.ArrayLike, color: int = RED) -> None:
        """Draws a line from point to point."""
        self._command(POLYLINE, points=points, color=_color(color))

    def draw_multiline(self, points: npt.ArrayLike, color: int = RED) -> None:
        """Draws a line between the first and the second point, the third and the fourth, ..."""
        self._command(MULTILINE, points=points, color=_color(color))

    def draw_polygon(
        self, points: npt.ArrayLike, color: int = RED, *, fill: int | None = None
    ) -> None:
        """Draws a polygon: its edge, and its inside in the colour `fill` if there is one."""
        self._command(
            POLYGON,
            points=points,
            color=_color(color),
            fill_color=_color(color if fill is None else fill),
            filled=int(fill is not None),
        )


def _color(number: int) -> Color:
    """0xRRGGBB as it travels; it hides what is behind it."""
    try:
        number = index(number)
    except TypeError:
        number = -1
    if not 0 <= number <= 0xFFFFFF:
        raise ValueError("a colour is a whole number 0xRRGGBB, such as 0xff0000 for red")
    return Color(255, number >> 16, number >> 8 & 255, number & 255)
