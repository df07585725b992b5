"""From metres to pixels: the size of a frame and where the world lies in it."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from operator import index

import numpy as np
from numpy.typing import NDArray

from sim.video.errors import VideoError

LONG_SIDE = 840
"""Pixels of a frame's longer side where no size is asked for."""
SHORT_SIDE = 240
"""Pixels that the shorter side has at least, so that the status line can be read."""
SMALLEST, LARGEST = 64, 4096
"""Sides that H.264 players take (level 5.1 ends at 4096)."""
UNIT_HEIGHT, UNIT_WIDTH = 720, 480
"""Pixels of a frame in which text and lines have their plain size; in larger ones they grow."""
STRIP_HEIGHT = 26
"""Units of the status line at the lower edge."""
PADDING = 4
"""Units between the outermost wall and the edge."""
AXIS_ROOM = (8.0, 7.5, 22.0)
"""Units for the axes' numbers: to the left at least, more for each character, and below."""
SHIFT = 4
"""Fractional bits of the coordinates that OpenCV draws with: 1/16 pixel."""
FARTHEST = 20_000.0
"""Pixels: points farther outside are pulled in, so that no coordinate overflows."""


@dataclass(frozen=True)
class Projection:
    """Maps the world onto a frame of `width` x `height` pixels."""

    width: int
    height: int
    scale: float
    """Pixels per metre."""
    left: float
    """Column (pixel edges, not centres) of x = 0, where coordinates count from."""
    bottom: float
    """Row (pixel edges) of y = 0."""
    unit: float = 1.0
    """Pixels per unit, in which the sizes of text and lines are told."""
    extent: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    """Left, bottom, right, top in metres of what is shown: the world with its walls."""
    low: tuple[float, float] = (0.0, 0.0)
    """x, y in metres of the world's lower left corner."""

    def units(self, length: float) -> int:
        """A line's width in units as whole pixels, at least one: smoothing adds a little."""
        return max(1, round(length * self.unit - 0.3))

    def edges(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points (..., 2) in metres to (column, row) on the scale of pixel edges."""
        pixels = np.empty(points.shape)
        np.multiply(points[..., 0], self.scale, out=pixels[..., 0])
        np.multiply(points[..., 1], -self.scale, out=pixels[..., 1])
        pixels[..., 0] += self.left
        pixels[..., 1] += self.bottom
        return pixels

    def fixed(self, points: NDArray[np.float64]) -> NDArray[np.int32]:
        """Points (..., 2) in metres to OpenCV's fixed-point coordinates (SHIFT bits).

        OpenCV counts from the centre of a pixel, hence the half.
        """
        return to_fixed(self.edges(points))

    @property
    def field_height(self) -> int:
        """Rows above the status line."""
        return self.height - round(STRIP_HEIGHT * self.unit)


def unit_of(size: tuple[int, int]) -> float:
    """Pixels per unit: in proportion to a frame's height, as far as its width allows."""
    return max(1.0, min(size[1] / UNIT_HEIGHT, size[0] / UNIT_WIDTH))


def to_fixed(edges: NDArray[np.float64]) -> NDArray[np.int32]:
    """Pixel-edge coordinates (..., 2) to OpenCV's fixed-point ones; NaN goes far outside."""
    # fmax and fmin, unlike clip, turn NaN into their other argument.
    bounded = np.fmin(edges, FARTHEST)
    np.fmax(bounded, -FARTHEST, out=bounded)
    bounded -= 0.5
    bounded *= 1 << SHIFT
    return np.rint(bounded, out=bounded).astype(np.int32)


def default_size(world: tuple[float, float], long_side: int = LONG_SIDE) -> tuple[int, int]:
    """Width and height in pixels with the world's aspect: 640 x 840 for 16 x 21 m."""
    longest = max(world)
    sides = [max(SHORT_SIDE, 2 * round(long_side * side / longest / 2)) for side in world]
    return sides[0], sides[1]


def parse_size(size: str | tuple[int, int]) -> tuple[int, int]:
    """Width and height as they are, or of a text such as `640x840`; VideoError for any other."""
    if not isinstance(size, str):
        return check_size(size)
    match = re.fullmatch(r"\s*(\d{1,6})\s*[xX×]\s*(\d{1,6})\s*", size)
    if match is None:
        raise VideoError(f"video size {size!r}: not WIDTHxHEIGHT in pixels, such as 640x840")
    return check_size((int(match[1]), int(match[2])))


def check_size(size: tuple[int, int]) -> tuple[int, int]:
    """`size` itself; raises VideoError where no H.264 video can have it."""
    try:
        width, height = map(index, size)
    except (TypeError, ValueError):
        raise VideoError(
            f"video size {size!r}: not width and height in whole pixels, such as (640, 840)"
        ) from None
    if not (SMALLEST <= width <= LARGEST and SMALLEST <= height <= LARGEST):
        raise VideoError(
            f"video size {width}x{height}: each side must be {SMALLEST} to {LARGEST} pixels"
        )
    if width % 2 or height % 2:
        raise VideoError(
            f"video size {width}x{height}: H.264 needs even numbers, "
            f"such as {width + width % 2}x{height + height % 2}"
        )
    return width, height


def project(
    world: tuple[float, float],
    outlines: Iterable[NDArray[np.float64]],
    size: tuple[int, int],
    *,
    low: tuple[float, float] = (0.0, 0.0),
    axes: bool = False,
) -> Projection:
    """The largest projection that shows the world and the walls around it above the status line.

    Solids that reach out by more than a tenth of the world are cut, not followed. `low`: the
    world's lower left corner. `axes`: leaves room for them.
    """
    reach = 0.1 * max(world)
    least, most = np.array(low), np.add(low, world)
    for outline in outlines:
        least = np.minimum(least, outline.min(axis=0))
        most = np.maximum(most, outline.max(axis=0))
    least = np.maximum(least, np.subtract(low, reach))
    most = np.minimum(most, np.add(low, world) + reach)
    width, height = size
    unit = unit_of(size)
    padding, strip = PADDING * unit, round(STRIP_HEIGHT * unit)
    left = below = 0.0
    if axes:
        ends = (low[1], low[1] + world[1])
        characters = max(*(len(f"{end:.0f} m") for end in ends), len("0.5 m"))
        left = (AXIS_ROOM[0] + AXIS_ROOM[1] * characters) * unit
        below = AXIS_ROOM[2] * unit
    room = np.array([width - 2 * padding - left, height - strip - 2 * padding - below])
    room = np.maximum(room, 1.0)
    extent = most - least
    scale = float((room / extent).min())
    corner = (room - extent * scale) / 2 + padding + (left, 0.0)
    return Projection(
        width=width,
        height=height,
        scale=scale,
        left=float(corner[0] - least[0] * scale),
        bottom=float(corner[1] + most[1] * scale),
        unit=unit,
        extent=(float(least[0]), float(least[1]), float(most[0]), float(most[1])),
        low=low,
    )
