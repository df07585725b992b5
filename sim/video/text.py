"""Text in a frame: plain, as labels with a halo, and in balloons. Glyphs are drawn once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.video.palette import INK, PAPER, bgr
from sim.video.projection import SHIFT

FONT = cv2.FONT_HERSHEY_SIMPLEX
"""OpenCV 5 sets it in a TrueType face that knows Unicode, OpenCV 4 in Hershey's strokes."""
SCALE = 0.45
FINE = 4
"""Glyphs are drawn this much larger and then shrunk: small digits stay legible."""
ROWS, ASCENT = 18, 13
"""Units of a line of text, and of its part above the baseline."""
FINEST = 1 << SHIFT
LONGEST = 28
"""Characters of a balloon; the rest becomes an ellipsis."""


def printable(text: str, longest: int = LONGEST) -> str:
    """`text` on one line, without control characters, cut to `longest` characters."""
    line = " ".join("".join(c if c.isprintable() else " " for c in text).split())
    return line if len(line) <= longest else line[: longest - 3].rstrip() + "..."


@dataclass(frozen=True)
class Lettering:
    """Text of one size: `unit` pixels are a unit."""

    unit: float = 1.0

    @property
    def rows(self) -> int:
        """Pixels of a line's height."""
        return round(ROWS * self.unit)

    @property
    def ascent(self) -> int:
        """Pixels of a line above the baseline."""
        return round(ASCENT * self.unit)

    def width(self, text: str) -> int:
        """Pixels that the text takes."""
        return _width(text, self.unit)

    def draw(
        self,
        image: NDArray[np.uint8],
        text: str,
        origin: tuple[int, int],
        color: int,
        paper: int = PAPER,
    ) -> None:
        """Writes text on `paper` with its baseline's left end at `origin` (column, row).

        What sticks out of the image is cut.
        """
        if not text:
            return
        line = np.concatenate([_inked(each, color, paper, self.unit) for each in text], axis=1)
        left, top = origin[0], origin[1] - self.ascent
        x0, y0 = max(left, 0), max(top, 0)
        x1, y1 = min(left + line.shape[1], image.shape[1]), min(top + self.rows, image.shape[0])
        if x0 < x1 and y0 < y1:
            image[y0:y1, x0:x1] = line[y0 - top : y1 - top, x0 - left : x1 - left]

    def label(self, image: NDArray[np.uint8], text: str, box: Box) -> None:
        """Writes a short text with a light halo in `box`; cut at the image's edges."""
        if not text:
            return
        keep, add = _label(text, self.unit)
        rows, columns = keep.shape[:2]
        left, top = box[0] + (box[2] - columns) // 2, box[1] + (box[3] - rows) // 2
        x0, y0 = max(left, 0), max(top, 0)
        x1, y1 = min(left + columns, image.shape[1]), min(top + rows, image.shape[0])
        if x0 >= x1 or y0 >= y1:
            return
        part = (slice(y0 - top, y1 - top), slice(x0 - left, x1 - left))
        under = image[y0:y1, x0:x1]
        under[:] = under * keep[part] + add[part]

    def balloon(
        self,
        image: NDArray[np.uint8],
        text: str,
        tip: tuple[float, float],
        box: Box,
        color: int,
    ) -> None:
        """A balloon in `box` with a pointer to `tip` (column, row), its edge in `color`."""
        left, top, width, _ = box
        outline = [np.rint(balloon_outline(box, tip, self.unit) * FINEST).astype(np.int32)]
        line = max(1, round(self.unit - 0.3))
        cv2.fillPoly(image, outline, bgr(PAPER), cv2.LINE_AA, SHIFT)
        cv2.polylines(image, outline, True, bgr(color), line, cv2.LINE_AA, SHIFT)
        inner = image[:, : max(left + width - 3, 0)]
        self.draw(inner, text, (left + round(7 * self.unit), top + 1 + self.ascent), INK)


Box = tuple[int, int, int, int]
"""Left, top, width, height in pixels."""


def balloon_outline(box: Box, tip: tuple[float, float], unit: float) -> NDArray[np.float64]:
    """A rectangle with round corners and a pointer to `tip` (column, row): corners (k, 2)."""
    left, top, width, height = box
    radius = min(max(3, round(5 * unit)), width // 2, height // 2)
    half = min(4 * unit, width / 2 - radius, max(height / 2 - radius, 2.0))
    angles = np.linspace(0, np.pi / 2, 5)
    arc = np.stack([np.cos(angles), np.sin(angles)], axis=1) * radius
    right, base = left + width, top + height
    x, y = tip
    across = min(max(x, left + radius + half), right - radius - half)
    down = min(max(y, top + radius + half), base - radius - half)
    corners = [  # clockwise as seen, from the right side on
        np.array([right - radius, base - radius]) + arc,
        np.array([left + radius, base - radius]) + arc[::-1] * (-1, 1),
        np.array([left + radius, top + radius]) - arc,
        np.array([right - radius, top + radius]) + arc[::-1] * (1, -1),
    ]
    pointer: tuple[int, list[tuple[float, float]]] | None = None  # after which corner
    if y > base:
        pointer = 0, [(across + half, base), (x, y), (across - half, base)]
    elif y < top:
        pointer = 2, [(across - half, top), (x, y), (across + half, top)]
    elif x < left:
        pointer = 1, [(left, down + half), (x, y), (left, down - half)]
    elif x > right:
        pointer = 3, [(right, down - half), (x, y), (right, down + half)]
    if pointer is not None:
        corners.insert(pointer[0] + 1, np.array(pointer[1], float))
    return np.concatenate(corners)


@lru_cache(maxsize=4096)
def _width(text: str, unit: float) -> int:
    return sum(_glyph(character, unit).shape[1] for character in text)


@lru_cache(maxsize=1024)
def _glyph(character: str, unit: float) -> NDArray[np.float32]:
    """A character's coverage (rows, advance), 0 to 1."""
    lettering, scale = Lettering(unit), SCALE * FINE * unit
    widths = [cv2.getTextSize(text, FONT, scale, 1)[0][0] for text in (character, character * 2)]
    advance = widths[1] - widths[0]
    columns = max(1, round(advance / FINE))
    large = np.zeros((lettering.rows * FINE, columns * FINE), np.uint8)
    origin = ((columns * FINE - advance) // 2, lettering.ascent * FINE)
    cv2.putText(large, character, origin, FONT, scale, (255,), 1, cv2.LINE_AA)
    small = cv2.resize(large, (columns, lettering.rows), interpolation=cv2.INTER_AREA)
    coverage: NDArray[np.float32] = small.astype(np.float32) / 255
    return coverage


@lru_cache(maxsize=2048)
def _inked(character: str, color: int, paper: int, unit: float) -> NDArray[np.uint8]:
    """A character (rows, advance, 3) BGR in `color` on `paper`."""
    ink, ground = np.array(bgr(color), np.float32), np.array(bgr(paper), np.float32)
    pixels: NDArray[np.uint8] = np.rint(
        ground + _glyph(character, unit)[..., None] * (ink - ground)
    ).astype(np.uint8)
    return pixels


@lru_cache(maxsize=4096)
def _label(text: str, unit: float) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """A text with a halo as (keep, add): a pixel p under it becomes p * keep + add."""
    ink = np.concatenate([_glyph(character, unit) for character in text], axis=1)
    ink = cv2.copyMakeBorder(ink, 2, 2, 3, 3, cv2.BORDER_CONSTANT, value=0)
    spread = cv2.GaussianBlur(cv2.dilate(ink, np.ones((3, 3), np.uint8)), (3, 3), 0)
    ink, halo = ink[..., None], 0.85 * spread[..., None]
    paper, dark = np.array(bgr(PAPER), np.float32), np.array(bgr(INK), np.float32)
    add = (paper * halo * (1 - ink) + dark * ink).astype(np.float32)
    keep = np.broadcast_to((1 - halo) * (1 - ink), add.shape).astype(np.float32)
    return keep, add
