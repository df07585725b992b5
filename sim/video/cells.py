"""Robots on a grid of cells, in the style of the other pictures: as pixels and as SVG."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.video.paint import rectangles_of
from sim.video.palette import GRID, GROUND, INK, OUTSIDE, SOFT_INK, STRIP, TINTS, bgr, mix
from sim.video.projection import UNIT_HEIGHT
from sim.video.svg import document, path, text
from sim.video.text import Lettering, printable

WALL, FREE, ARROW, DOT, DIAMOND, DOOR = 0, 1, 2, 6, 7, 8
"""What a cell holds: nothing, an arrow (up, and three more clockwise), a dot, a diamond. DOOR is
added to what a door's cell holds."""

WALL_COLOR = mix(INK, SOFT_INK, 0.6)
ACTIVE = TINTS[5]
SETTLED = mix(TINTS[2], GROUND, 0.35)
DOOR_COLOR = TINTS[4]

LARGEST = 960
"""Pixels of the grid's longer side, if a cell then is at least one pixel."""
LARGEST_CELL = 48
LEAST_WIDTH = 470
"""Pixels that a picture is wide at least: for the lines below."""
LINE = 26
"""Units of a line below the grid."""
MARGIN, GAP = 10, 18
"""Units at both ends of a line, and between two entries."""
LEGEND = ((DOT, "just entered"), (ARROW + 1, "on its way"), (DIAMOND, "settled"), (DOOR, "door"))

SHAPES = {
    ARROW: np.array(
        [[0, -0.42], [0.34, 0.04], [0.12, 0.04], [0.12, 0.4], [-0.12, 0.4], [-0.12, 0.04],
         [-0.34, 0.04]]
    ),
    DIAMOND: np.array([[0, -0.38], [0.38, 0], [0, 0.38], [-0.38, 0]]),
}  # fmt: skip
"""Outlines (k, 2) in a cell of 1 x 1 about its middle, y downwards."""
for _turn in range(1, 4):
    SHAPES[ARROW + _turn] = SHAPES[ARROW + _turn - 1][:, ::-1] * [-1, 1]
DOT_RADIUS = 0.3


class CellPicture:
    """Draws the moments of runs on one grid."""

    def __init__(
        self, shape: tuple[int, ...], rule: str = "", title: str = "", pixels: int | None = None
    ) -> None:
        """`shape`: rows and columns; `pixels` per cell: unless told, for a handy picture."""
        rows, columns = shape
        self.pixels = pixels or max(1, min(LARGEST_CELL, LARGEST // max(rows, columns)))
        grid = columns * self.pixels, rows * self.pixels
        self.unit = max(1.0, min(grid[1] / UNIT_HEIGHT, grid[0] / LEAST_WIDTH))
        self.lettering = Lettering(self.unit)
        width, height = max(grid[0], LEAST_WIDTH), grid[1] + 2 * round(LINE * self.unit)
        self.size = width + width % 2, height + height % 2
        """Width and height in pixels; even, as H.264 wants them."""
        self.left = (self.size[0] - grid[0]) // 2
        self._grid = grid
        self._rule = f"rule {rule}" if rule else ""
        self._title = printable(title, 40)
        self._still = self._draw_still()

    def draw(self, cells: NDArray[np.uint8], entries: Sequence[str]) -> NDArray[np.uint8]:
        """A moment as (height, width, 3) BGR: what stands in each cell, and what is said of it."""
        image = self._still.copy()
        width, height = self._grid
        drawn = _tiles(self.pixels)[cells].transpose(0, 2, 1, 3, 4).reshape(height, width, 3)
        image[:height, self.left : self.left + width] = drawn
        for k, (words, x) in enumerate(self._entries(entries)):
            self.lettering.draw(image, words, (x, self._baseline(0)), INK if not k else SOFT_INK)
        return image

    def svg(self, cells: NDArray[np.uint8], entries: Sequence[str]) -> str:
        """The same as an SVG document."""
        width, height = self._grid
        pixels, left = self.pixels, self.left
        outside, strip = f'fill="#{OUTSIDE:06x}"', f'fill="#{STRIP:06x}"'
        ground, line = f'fill="#{GROUND:06x}"', f'stroke="#{GRID:06x}"'
        parts = [
            "<defs>",
            *(f'<g id="k{kind}">{_symbol(kind)}</g>' for kind in range(ARROW, 2 * DOOR)),
            "</defs>",
            f'<rect width="{self.size[0]}" height="{self.size[1]}" {outside}/>',
            f'<rect x="{left}" width="{width}" height="{height}" {ground}/>',
        ]
        if pixels >= 6:
            across = "".join(f"M{left} {y}h{width}" for y in range(pixels, height, pixels))
            down = "".join(f"M{left + x} 0v{height}" for x in range(pixels, width, pixels))
            parts.append(f'<path d="{across}{down}" {line}/>')
        walls = [
            np.array([[c, r], [c + w, r], [c + w, r + h], [c, r + h]], float) * pixels + (left, 0)
            for _, rectangles in rectangles_of((cells == WALL).astype(np.int16))
            for r, c, h, w in rectangles
        ]
        parts.append(path(walls, fill=WALL_COLOR))
        parts.append(f'<g transform="translate({left} 0) scale({pixels})">')
        held = np.argwhere(cells > FREE)
        parts += [
            f'<use href="#k{cells[row, column]}" x="{column + 0.5}" y="{row + 0.5}"/>'
            for row, column in held.tolist()
        ]
        parts.append("</g>")
        rest = self.size[1] - height
        parts.append(f'<rect y="{height}" width="{self.size[0]}" height="{rest}" {strip}/>')
        parts += [
            text(self.lettering, words, x, self._baseline(0), INK if not k else SOFT_INK)
            for k, (words, x) in enumerate([*self._entries(entries), *self._fixed()])
        ]
        side = self._symbol_side()
        for kind, x, words, start in self._legend():
            y = self._baseline(1) - 4.5 * self.unit
            parts.append(
                f'<use href="#k{kind}" transform="translate({x + side / 2} {y}) scale({side})"/>'
            )
            parts.append(text(self.lettering, words, start, self._baseline(1), SOFT_INK))
        return document(self.size, self._title, parts)

    def _draw_still(self) -> NDArray[np.uint8]:
        """All but the cells and what is said of them."""
        image = np.empty((self.size[1], self.size[0], 3), np.uint8)
        image[:] = bgr(OUTSIDE)
        image[self._grid[1] :] = bgr(STRIP)
        for words, x in self._fixed():
            self.lettering.draw(image, words, (x, self._baseline(0)), SOFT_INK)
        side = self._symbol_side()
        for kind, x, words, start in self._legend():
            top = self._baseline(1) - round(4.5 * self.unit) - side // 2
            image[top : top + side, x : x + side] = _tiles(side, bare=True)[kind]
            self.lettering.draw(image, words, (start, self._baseline(1)), SOFT_INK)
        return image

    def _baseline(self, line: int) -> int:
        return self._grid[1] + round((17 + 24 * line) * self.unit)

    def _symbol_side(self) -> int:
        return round(16 * self.unit)

    def _entries(self, entries: Sequence[str]) -> list[tuple[str, int]]:
        """The entries with the columns where they begin; each has room for a longer one."""
        placed, x = [], round(MARGIN * self.unit)
        for words in entries:
            placed.append((words, x))
            digits = sum(c.isdigit() for c in words)
            room = self.lettering.width(words) + max(0, 3 - digits) * self.lettering.width("0")
            x += room + round(GAP * self.unit)
        return placed

    def _fixed(self) -> list[tuple[str, int]]:
        """The rule and, where there is room, the title at the right end of the line."""
        end, placed = self.size[0] - round(MARGIN * self.unit), []
        least = self.lettering.width("step 00000" + "00000 robots, 00000 settled") + 60 * self.unit
        for words in (self._title, self._rule):
            start = end - self.lettering.width(words)
            if words and (start > least or words == self._rule):
                placed.append((words, start))
                end = start - round(GAP * self.unit)
        return placed

    def _legend(self) -> list[tuple[int, int, str, int]]:
        """(kind, column of its symbol, its name, column of that) for each."""
        found, x = [], round(MARGIN * self.unit)
        for kind, words in LEGEND:
            start = x + self._symbol_side() + round(5 * self.unit)
            found.append((kind, x, words, start))
            x = start + self.lettering.width(words) + round(GAP * self.unit)
        return found


def _color(kind: int) -> int:
    return SETTLED if kind % DOOR == DIAMOND else ACTIVE


def _symbol(kind: int) -> str:
    """What stands in a cell as SVG, in a cell of 1 x 1 about its middle."""
    what, color = kind % DOOR, _color(kind)
    words = ""
    if kind >= DOOR:
        words += (
            f'<rect x="-0.46" y="-0.46" width="0.92" height="0.92" fill="none" '
            f'stroke="#{DOOR_COLOR:06x}" stroke-width="0.08"/>'
        )
    if what == DOT:
        return words + f'<circle r="{DOT_RADIUS}" fill="#{color:06x}"/>'
    if what in SHAPES:
        return words + path([SHAPES[what]], fill=color)
    return words


@lru_cache(maxsize=8)
def _tiles(pixels: int, bare: bool = False) -> NDArray[np.uint8]:
    """(16, pixels, pixels, 3) BGR: a picture of one cell for each kind, `bare` without grid."""
    scale = 8  # drawn larger, then reduced: smooth edges
    size = pixels * scale
    tiles = np.empty((2 * DOOR, pixels, pixels, 3), np.uint8)
    for kind in range(2 * DOOR):
        what, color = kind % DOOR, bgr(_color(kind))
        large = np.empty((size, size, 3), np.uint8)
        large[:] = bgr(STRIP if bare else WALL_COLOR if what == WALL else GROUND)
        if what != WALL and pixels >= 6 and not bare:
            line = scale * max(1, pixels // 24)
            cv2.rectangle(large, (0, 0), (size - 1, size - 1), bgr(GRID), line)
        if what >= ARROW and pixels < 4:
            large[:] = color
        elif what == DOT:
            centre = (size // 2, size // 2)
            cv2.circle(large, centre, round(size * DOT_RADIUS), color, -1)
        elif what in SHAPES:
            corners = np.rint((SHAPES[what] + 0.5) * size).astype(np.int32)
            cv2.fillPoly(large, [corners], color)
        if kind >= DOOR:
            line = 2 * scale * max(1, pixels // 12)
            cv2.rectangle(large, (0, 0), (size - 1, size - 1), bgr(DOOR_COLOR), line)
        tiles[kind] = cv2.resize(large, (pixels, pixels), interpolation=cv2.INTER_AREA)
    return tiles
