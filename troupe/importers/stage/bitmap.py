"""Bitmaps of floorplans: which pixels are wall by Stage's rule, and the map image made of them."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from troupe.importers.stage.polygons import Polygon
from troupe.importers.stage.tokens import Place, StageError
from troupe.importers.stage.values import Pose

SOLID = 127
"""A pixel whose first channel is at most this is solid, in Stage."""

MOST_CELLS = 16_000_000
"""Cells of a map image that is made anew."""

MOST_PIXELS = 400_000_000
"""Pixels of a bitmap, which are held in memory once."""

Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Plan:
    """A model drawn by a bitmap.

    walls (rows, columns), row 0 at the top: the bitmap cut to its solid pixels, which Stage
    scales to `size` (length and width in metres) about `pose`, the middle in the world.
    `whole`: there was nothing to cut, and our reader of maps finds the same walls in the file.
    """

    path: str
    walls: Bools
    pose: Pose
    size: tuple[float, float]
    whole: bool

    @property
    def pitch(self) -> tuple[float, float]:
        """Metres per pixel along x and y of the model."""
        rows, columns = self.walls.shape
        return self.size[0] / columns, self.size[1] / rows

    @property
    def square(self) -> bool:
        """Whether pixels are square: over the whole image the two pitches differ by a quarter."""
        x, y = self.pitch
        return bool(abs(x - y) * max(self.walls.shape) < 0.25 * min(x, y))

    def at(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> Bools:
        """Whether there is a wall at points of the world (arrays of one shape)."""
        angle = math.radians(self.pose.a)
        cos, sin = math.cos(angle), math.sin(angle)
        dx, dy = x - self.pose.x, y - self.pose.y
        rows, columns = self.walls.shape
        across, up = self.pitch
        column = np.floor((cos * dx + sin * dy) / across + columns / 2).astype(np.int64)
        row = rows - 1 - np.floor((cos * dy - sin * dx) / up + rows / 2).astype(np.int64)
        on = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
        found = np.zeros(x.shape, np.bool_)
        found[on] = self.walls[row[on], column[on]]
        return found


def read_plan(
    name: str, folder: str, pose: Pose, size: tuple[float, float], place: Place
) -> Plan | None:
    """Read a model's bitmap; relative names start at the world file's folder. Raises StageError.

    None for one without a dark pixel, of which nothing is solid.
    """
    from sim.stage.imagemap import TooLarge, read_pixels  # noqa: PLC0415  (loads OpenCV)
    from sim.worldfile.reading import NotRead  # noqa: PLC0415

    path = os.path.join(folder, name)
    try:
        walls, whole = _dark(read_pixels(Path(path))), True
    except TooLarge as error:
        walls, whole = _coarse(path, error.size, place), False
    except NotRead as error:
        raise StageError(place, f"the bitmap {path} {error} (convert it to PNG?)") from None
    if not walls.any():
        return None
    rows, columns = np.flatnonzero(walls.any(axis=1)), np.flatnonzero(walls.any(axis=0))
    cut = walls[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    whole = whole and cut.shape == walls.shape and np.array_equal(_as_map(path), walls)
    return Plan(path, cut, pose, size, bool(whole))


def _dark(pixels: NDArray[Any]) -> Bools:
    """Which pixels are solid by Stage's rule: those whose first channel (red) is dark."""
    first = pixels if pixels.ndim == 2 else pixels[:, :, min(2, pixels.shape[2] - 1)]
    return np.asarray(first <= SOLID)


def _coarse(path: str, size: tuple[int, int], place: Place) -> Bools:
    """The solid pixels of an image that is larger than a map may be, several to a cell.

    A cell is solid if any of its pixels is, so that thin walls stay closed. Raises StageError.
    """
    import cv2  # noqa: PLC0415

    width, height = size
    pixels = cv2.imread(path, cv2.IMREAD_UNCHANGED) if width * height <= MOST_PIXELS else None
    if pixels is None or pixels.dtype != np.uint8:
        what = f"the bitmap {path} is too large or cannot be read: {width} x {height} pixels"
        raise StageError(place, f"{what} (at most {MOST_PIXELS})")
    walls = _dark(pixels)
    step = math.ceil(math.sqrt(walls.size / MOST_CELLS))
    rows, columns = (side - side % -step for side in walls.shape)
    padded = np.zeros((rows, columns), np.bool_)
    padded[: walls.shape[0], : walls.shape[1]] = walls
    blocks = padded.reshape(rows // step, step, columns // step, step)
    return np.asarray(blocks.any(axis=(1, 3)))


def _as_map(path: str) -> Bools:
    """The walls that the reader of world files' maps finds in an image."""
    from sim.stage.imagemap import read_image_map  # noqa: PLC0415

    return read_image_map(Path(path))


def rectangles(plan: Plan) -> list[Polygon]:
    """A bitmap's solid pixels as rectangles that fill them, in metres about the plan's middle."""
    from sim.stage.raster import merged_rectangles  # noqa: PLC0415

    rows, columns = plan.walls.shape
    across, up = plan.pitch
    found: list[Polygon] = []
    for left, top, right, bottom in merged_rectangles(plan.walls).tolist():
        x0, x1 = (left - columns / 2) * across, (right - columns / 2) * across
        y0, y1 = (rows / 2 - bottom) * up, (rows / 2 - top) * up
        found.append([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
    return found


@dataclass(frozen=True)
class Drawn:
    """Plans drawn into one image: walls (rows, columns), row 0 at the top, and metres per cell."""

    walls: Bools
    cell: float


def draw(plans: Sequence[Plan], corner: tuple[float, float], size: tuple[float, float]) -> Drawn:
    """All plans on one raster over the rectangle from `corner` (its lower left) of `size`.

    A single upright plan with square pixels that fills the rectangle keeps its pixels. Otherwise
    cells are half as large as the smallest pixel (or larger, above MOST_CELLS): a wall's edge
    lies at most half a cell beside its place.
    """
    plan = plans[0]
    if len(plans) == 1 and plan.square and math.isclose(plan.pose.a % 360.0, 0.0, abs_tol=1e-9):
        fills = all(abs(s - p) < 1e-6 for s, p in zip(size, plan.size, strict=True))
        if fills:
            return Drawn(plan.walls, plan.pitch[0])
    finest = min(min(plan.pitch) for plan in plans) / 2
    cell = max(finest, math.sqrt(size[0] * size[1] / MOST_CELLS))
    columns = max(1, math.ceil(size[0] / cell - 1e-6))
    cell = size[0] / columns
    rows = max(1, math.ceil(size[1] / cell - 0.5))
    y = corner[1] + (rows - np.arange(rows) - 0.5) * cell
    x = corner[0] + (np.arange(columns) + 0.5) * cell
    grid_x, grid_y = np.meshgrid(x, y)
    walls = np.zeros((rows, columns), np.bool_)
    for plan in plans:
        walls |= plan.at(grid_x, grid_y)
    return Drawn(walls, cell)


def write_png(path: Path, walls: Bools) -> None:
    """Write walls as an image, black on white. Raises OSError."""
    import cv2  # noqa: PLC0415

    _, data = cv2.imencode(".png", np.where(walls, 0, 255).astype(np.uint8))
    path.write_bytes(data.tobytes())
