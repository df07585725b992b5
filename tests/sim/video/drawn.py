"""Pictures of one robot, and what is in them."""

from __future__ import annotations

import numpy as np
from video_arenas import SQUARE

from sim.video import Backdrop, Snapshot
from sim.video.layers import SHOWN
from sim.video.picture import Picture

GREEN = 0x00FF00


def pixel(picture: Picture, image: np.ndarray, x: float, y: float) -> list[int]:
    """BGR at a place in the world."""
    column, row = picture.projection.edges(np.array([x, y], dtype=float))
    return image[int(row), int(column)].tolist()


def one_robot(backdrop: Backdrop, **snapshot: object) -> tuple[Picture, np.ndarray]:
    picture = Picture(backdrop, show=snapshot.pop("show", SHOWN))  # type: ignore[arg-type]
    picture.add_robot("r1", SQUARE)
    values = {"time": 0.0, "poses": np.array([[4.0, 5.0, 0.0]]), "colors": [GREEN]} | snapshot
    return picture, picture.draw(Snapshot(**values))


def bounds(backdrop: Backdrop, pose: list[float]) -> tuple[float, float, float, float]:
    """Left, bottom, right, top in metres of all pixels that a robot at a pose changes."""
    picture, image = one_robot(backdrop, poses=np.array([pose]), show=frozenset())
    _, away = one_robot(backdrop, poses=np.array([[1e4, 1e4, 0.0]]), show=frozenset())
    rows, columns = np.nonzero((image != away).any(axis=2))
    p = picture.projection
    return (
        (columns.min() - p.left) / p.scale,
        (p.bottom - rows.max() - 1) / p.scale,
        (columns.max() + 1 - p.left) / p.scale,
        (p.bottom - rows.min()) / p.scale,
    )
