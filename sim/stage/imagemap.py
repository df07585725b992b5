"""Image maps: a dark pixel is wall."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sim.worldfile.mistakes import Mistake, WorldError

WHERE = ("map", "file")
DARK = 127
"""A pixel of at most this brightness (0 to 255) is wall, as for a bitmap of Stage."""
MOST_PIXELS = 64_000_000


def read_image_map(path: Path) -> NDArray[np.bool_]:
    """The walls of an image: (rows, columns) bool, row 0 at the top.

    Colours are turned to brightness first; where the image has an alpha channel, what is
    transparent is free. Raises WorldError where the file is missing or is no image.
    """
    import cv2  # noqa: PLC0415  (most worlds have no image map, and OpenCV takes time to load)

    try:
        data = path.read_bytes()
    except OSError as error:
        raise WorldError(
            [Mistake(WHERE, f"the map cannot be read: {error.strerror}", str(path))]
        ) from None
    try:
        pixels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error:
        pixels = None
    if pixels is None:
        allowed = "an image such as PNG, or a text map with a name in .txt"
        raise WorldError([Mistake(WHERE, "the map is not an image", str(path), allowed)])
    if pixels.shape[0] * pixels.shape[1] > MOST_PIXELS:
        given = f"{pixels.shape[1]} x {pixels.shape[0]} pixels"
        allowed = f"at most {MOST_PIXELS} pixels"
        raise WorldError([Mistake(WHERE, "the map is too large", given, allowed)])
    if pixels.dtype == np.uint16:
        pixels = (pixels >> 8).astype(np.uint8)
    elif pixels.dtype != np.uint8:
        pixels = np.clip(pixels * 255.0, 0, 255).astype(np.uint8)
    if pixels.ndim == 2:
        return np.asarray(pixels <= DARK)
    if pixels.shape[2] == 4:
        seen = pixels[:, :, 3] > DARK
        return np.asarray((cv2.cvtColor(pixels, cv2.COLOR_BGRA2GRAY) <= DARK) & seen)
    return np.asarray(cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY) <= DARK)
