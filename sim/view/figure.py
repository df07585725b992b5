"""What programs draw: figures of graphics2d, in the frames of their robots."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

FARTHEST = 1e6
"""Metres: figures that reach beyond are not shown."""


@dataclass
class Figure:
    """A figure; points (k, 2) in metres in the robot's frame, colours 0xRRGGBB."""

    kind: str
    points: NDArray[np.float64]
    color: int
    fill_color: int | None = None

    @property
    def shows(self) -> bool:
        """Whether it is of numbers that can be drawn."""
        points = self.points
        return bool(np.isfinite(points).all() and np.abs(points).max(initial=0.0) <= FARTHEST)


def figures_that_show(
    figures: Sequence[Sequence[Figure]],
) -> Iterator[tuple[int, Figure]]:
    """Robot and figure, of all that robots (n,) have drawn."""
    for robot, mine in enumerate(figures):
        yield from ((robot, figure) for figure in mine if figure.shows)


def told(figures: Sequence[Sequence[Figure]]) -> list[dict[str, Any]]:
    """The same as a page gets it: see `Moment.drawn`."""
    return [
        {
            "robot": robot,
            "kind": figure.kind,
            "points": figure.points.tolist(),
            "color": figure.color,
            "fill": figure.fill_color,
        }
        for robot, figure in figures_that_show(figures)
    ]
