"""Walled worlds and a square body for the tests of the video."""

from __future__ import annotations

import numpy as np

from sim.video import Backdrop

RED = 0xFF0000
SQUARE = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])


def rectangle(left: float, bottom: float, right: float, top: float) -> np.ndarray:
    return np.array([[left, bottom], [right, bottom], [right, top], [left, top]], dtype=float)


def walled(width: float, height: float, thickness: float = 0.2) -> Backdrop:
    t = thickness
    walls = [
        rectangle(-t, -t, width + t, 0),
        rectangle(-t, height, width + t, height + t),
        rectangle(-t, 0, 0, height),
        rectangle(width, 0, width + t, height),
    ]
    return Backdrop((width, height), [(wall, RED) for wall in walls], title="A test")
