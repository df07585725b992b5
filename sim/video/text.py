"""Text in a frame: plain, in balloons, and as labels with a halo. Glyphs are drawn once."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.video.palette import INK, PAPER, bgr

FONT = cv2.FONT_HERSHEY_SIMPLEX
"""OpenCV 5 sets it in a TrueType face that knows Unicode, OpenCV 4 in Hershey's strokes."""
SCALE = 0.45
FINE = 4
"""Glyphs are drawn this much larger and then shrunk: small digits stay legible."""
ROWS, ASCENT = 18, 13
"""Pixels of a line of text, and of its part above the baseline."""
LONGEST = 48
"""Characters of a balloon; the rest becomes an ellipsis."""


def printable(text: str, longest: int = LONGEST) -> str:
    """`text` on one line, without control characters, cut to `longest` characters."""
    line = " ".join("".join(c if c.isprintable() else " " for c in text).split())
    return line if len(line) <= longest else line[: longest - 3].rstrip() + "..."


@lru_cache(maxsize=1024)
def _glyph(character: str) -> NDArray[np.float32]:
    """A character's coverage (ROWS, advance), 0 to 1."""
    widths = [
        cv2.getTextSize(text, FONT, SCALE * FINE, 1)[0][0] for text in (character, character * 2)
    ]
    advance = widths[1] - widths[0]
    columns = max(1, round(advance / FINE))
    large = np.zeros((ROWS * FINE, columns * FINE), np.uint8)
    origin = ((columns * FINE - advance) // 2, ASCENT * FINE)
    cv2.putText(large, character, origin, FONT, SCALE * FINE, (255,), 1, cv2.LINE_AA)
    small = cv2.resize(large, (columns, ROWS), interpolation=cv2.INTER_AREA)
    coverage: NDArray[np.float32] = small.astype(np.float32) / 255
    return coverage


@lru_cache(maxsize=2048)
def _inked(character: str, color: int) -> NDArray[np.uint8]:
    """A character (ROWS, advance, 3) BGR in `color` on PAPER."""
    ink, paper = np.array(bgr(color), np.float32), np.array(bgr(PAPER), np.float32)
    pixels: NDArray[np.uint8] = np.rint(
        paper + _glyph(character)[..., None] * (ink - paper)
    ).astype(np.uint8)
    return pixels


def text_width(text: str) -> int:
    """Pixels that the text takes."""
    return sum(_glyph(character).shape[1] for character in text)


def draw_text(image: NDArray[np.uint8], text: str, origin: tuple[int, int], color: int) -> None:
    """Writes text on PAPER with its baseline's left end at `origin` (column, row).

    What sticks out of the image to the right is cut; nothing may stick out elsewhere.
    """
    if not text:
        return
    line = np.concatenate([_inked(character, color) for character in text], axis=1)
    x, y = origin
    area = image[y - ASCENT : y - ASCENT + ROWS, x : x + line.shape[1]]
    area[:] = line[: area.shape[0], : area.shape[1]]


@lru_cache(maxsize=4096)
def _label(text: str) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """A text with a halo as (keep, add): a pixel p under it becomes p * keep + add."""
    ink = np.concatenate([_glyph(character) for character in text], axis=1)
    ink = cv2.copyMakeBorder(ink, 2, 2, 3, 3, cv2.BORDER_CONSTANT, value=0)
    spread = cv2.GaussianBlur(cv2.dilate(ink, np.ones((3, 3), np.uint8)), (3, 3), 0)
    ink, halo = ink[..., None], 0.85 * spread[..., None]
    paper, dark = np.array(bgr(PAPER), np.float32), np.array(bgr(INK), np.float32)
    add = (paper * halo * (1 - ink) + dark * ink).astype(np.float32)
    keep = np.broadcast_to((1 - halo) * (1 - ink), add.shape).astype(np.float32)
    return keep, add


def draw_label(image: NDArray[np.uint8], text: str, centre: tuple[float, float]) -> None:
    """Writes a short text with a light halo around `centre` (column, row); cut at the edges."""
    if not text:
        return
    keep, add = _label(text)
    rows, columns = keep.shape[:2]
    left, top = round(centre[0] - columns / 2), round(centre[1] - rows / 2)
    x0, y0 = max(left, 0), max(top, 0)
    x1, y1 = min(left + columns, image.shape[1]), min(top + rows, image.shape[0])
    if x0 >= x1 or y0 >= y1:
        return
    part = (slice(y0 - top, y1 - top), slice(x0 - left, x1 - left))
    under = image[y0:y1, x0:x1]
    under[:] = under * keep[part] + add[part]


Box = tuple[int, int, int, int]
"""Left, top, width, height in pixels."""


def balloon_box(
    text: str, tip: tuple[float, float], size: tuple[int, int], taken: Sequence[Box]
) -> Box:
    """Where a balloon over `tip` (column, row) goes: inside of an image of `size` (columns, rows).

    It moves up until it covers none of those in `taken`; where the image ends, it covers.
    """
    width, height = min(text_width(text) + 14, size[0] - 6), ROWS + 2
    left = min(max(round(tip[0]) - width // 2, 3), size[0] - width - 3)
    lowest = min(max(round(tip[1]) - height - 7, 3), size[1] - height - 3)
    for top in range(lowest, 2, -height - 3):
        if not any(
            left < x + w and x < left + width and top < y + h and y < top + height
            for x, y, w, h in taken
        ):
            return left, top, width, height
    return left, lowest, width, height


def draw_balloon(
    image: NDArray[np.uint8], text: str, tip: tuple[float, float], box: Box, color: int
) -> None:
    """A speech balloon in `box` whose pointer ends at `tip` (column, row)."""
    left, top, width, height = box
    x, y = round(tip[0]), round(tip[1])
    outline = _rounded(width, height) + np.array([left, top], np.int32)
    edge = bgr(color)
    cv2.fillConvexPoly(image, outline, bgr(PAPER), cv2.LINE_AA)
    cv2.polylines(image, [outline], True, edge, 1, cv2.LINE_AA)
    base, right = top + height, left + width
    if base < y:
        root = min(max(x, left + 10), right - 10)
        pointer = np.array([[root - 4, base], [x, y], [root + 4, base]], np.int32)
        cv2.fillConvexPoly(image, pointer, bgr(PAPER), cv2.LINE_AA)
        cv2.polylines(image, [pointer], False, edge, 1, cv2.LINE_AA)
        cv2.line(image, (root - 3, base), (root + 3, base), bgr(PAPER), 1)
    # Between the edges; a frame narrower than the text shows its beginning.
    draw_text(image[top + 1 : base, : right - 3], text, (left + 7, ASCENT), INK)


@lru_cache(maxsize=256)
def _rounded(width: int, height: int, radius: int = 5) -> NDArray[np.int32]:
    """Corners (k, 2) of a rectangle at the origin with round corners."""
    angles = np.linspace(0, np.pi / 2, 5)
    arc = np.stack([np.cos(angles), np.sin(angles)], axis=1) * radius
    parts = [
        np.array([width - radius, height - radius]) + arc,
        np.array([radius, height - radius]) + arc[::-1] * (-1, 1),
        np.array([radius, radius]) - arc,
        np.array([width - radius, radius]) + arc[::-1] * (1, -1),
    ]
    outline: NDArray[np.int32] = np.rint(np.concatenate(parts)).astype(np.int32)
    return outline
