"""Image maps: a dark pixel is wall."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.stage.imagesize import KINDS, image_size
from sim.worldfile.mistakes import Mistake, WorldError
from sim.worldfile.reading import NotRead, read_regular

WHERE = ("map", "file")
DARK = 127
"""A pixel of at most this brightness (0 to 255) is wall, as for a bitmap of Stage."""
MOST_PIXELS = 64_000_000
"""8000 x 8000; decoded, with 16 bits for each of four channels, they take 512 MB."""
MOST_BYTES = 256_000_000
"""Of an image file: a PGM in decimal digits takes four for each pixel."""
_ROWS = 512
"""Rows looked at together: so many need little room besides the image itself."""


class TooLarge(NotRead):
    """The image has more than `MOST_PIXELS` pixels: `size` as its header has it."""

    def __init__(self, size: tuple[int, int]) -> None:
        super().__init__("is too large")
        self.size = size


def read_pixels(path: Path) -> NDArray[Any]:
    """The pixels of an image as OpenCV decodes them: (rows, columns) or (rows, columns, channels).

    8 bits each; of 16 the upper ones. Raises NotRead, before anything is decoded where the file
    is no image or larger than what is allowed.
    """
    import cv2  # noqa: PLC0415  (most worlds have no image map, and OpenCV takes time to load)

    data = read_regular(path, MOST_BYTES)
    size = image_size(data)
    if size is None:
        raise NotRead("is not an image")
    if size[0] * size[1] > MOST_PIXELS:
        raise TooLarge(size)
    if data[:2] in (b"P1", b"P2", b"P3"):
        data += b"\n"  # without it OpenCV looks for more digits of the last number
    level = cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    try:
        pixels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except (cv2.error, MemoryError):
        pixels = None
    finally:
        cv2.utils.logging.setLogLevel(level)
    if pixels is None:
        raise NotRead("is a damaged image, or ends too early")
    if pixels.dtype == np.uint16:
        upper = 1 if sys.byteorder == "little" else 0
        return np.asarray(pixels).view(np.uint8)[..., upper::2]
    if pixels.dtype != np.uint8:
        raise NotRead("is an image with more than 16 bits for a colour")
    return np.asarray(pixels)


def read_image_map(path: Path) -> NDArray[np.bool_]:
    """The walls of an image: (rows, columns) bool, row 0 at the top.

    Colours are turned to brightness first; where the image has an alpha channel, what is
    transparent is free. Raises WorldError where the file is missing, is no image, or one that
    is too large.
    """
    try:
        pixels = read_pixels(path)
    except TooLarge as error:
        given = f"{error.size[0]} x {error.size[1]} pixels"
        allowed = f"at most {MOST_PIXELS} pixels"
        raise WorldError([Mistake(WHERE, "the map is too large", given, allowed)]) from None
    except NotRead as error:
        allowed = f"an image: {KINDS}; or a text map, with `cell` in place of `resolution`"
        raise WorldError([Mistake(WHERE, f"the map {error}", str(path), allowed)]) from None
    walls = np.empty(pixels.shape[:2], np.bool_)
    for row in range(0, len(pixels), _ROWS):
        walls[row : row + _ROWS] = _dark(np.ascontiguousarray(pixels[row : row + _ROWS]))
    return walls


def _dark(pixels: NDArray[Any]) -> NDArray[np.bool_]:
    import cv2  # noqa: PLC0415

    if pixels.ndim == 2:
        return np.asarray(pixels <= DARK)
    if pixels.shape[2] == 4:
        seen = pixels[:, :, 3] > DARK
        return np.asarray((cv2.cvtColor(pixels, cv2.COLOR_BGRA2GRAY) <= DARK) & seen)
    return np.asarray(cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY) <= DARK)
