"""What of a run does not change, as the page gets it once."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.showing import backdrop_of
from sim.silhouette import silhouette
from sim.stage.geometry import pieces
from sim.video import palette
from sim.view.moment import Scene

if TYPE_CHECKING:
    from sim.build import LoadedWorld

MOST_FANS = 32
"""Robots up to which the readings of all of them show; of more, those of who is selected."""
MOST_TOLD, MOST_SAID = 12, 20
"""Lines of a controller's output, and of what it said, on its robot's card."""


def scene_of(
    loaded: LoadedWorld,
    *,
    seed: int,
    duration: float,
    again: bool,
    stepped: bool = False,
    log: Mapping[str, Any] | None = None,
) -> Scene:
    """The scene of a run; `again`: whether a page may have it begun again.

    `stepped`: whether a program makes its steps, so that no page does. `log`: the time line of a
    run that is over (see `timeline.py`).
    """
    backdrop = backdrop_of(loaded)
    world = loaded.world
    about = {
        "title": backdrop.title,
        "size": list(backdrop.size),
        "low": list(backdrop.low),
        "doors": [np.asarray(door).round(4).tolist() for door in backdrop.doors],
        "models": {name: model_of(model) for name, model in world.models.items()},
        "things": [
            {"shape": shape_of(movable.body), "color": movable.color}
            for movable in loaded.layout.movables
        ]
        + [
            {"shape": shape_of(one.body), "parts": parts_of(one.body)}
            for one in loaded.layout.fixtures
        ],
        "floor": floor_of(loaded),
        "interval": world.clock.interval,
        "duration": duration,
        "seed": seed,
        "again": again,
        "stepped": stepped,
        "log": log,
        "palette": {
            "tints": list(palette.TINTS),
            "ground": palette.GROUND,
            "outside": palette.OUTSIDE,
            "grid": palette.GRID,
            "ink": palette.INK,
            "soft_ink": palette.SOFT_INK,
        },
    }
    return Scene(about, [*backdrop.marks, *backdrop.solids])


def floor_of(loaded: LoadedWorld) -> dict[str, Any]:
    """The cells of the paint layer."""
    resolution = loaded.world.floor.resolution
    width, height = loaded.layout.size
    columns, rows = (max(1, int(np.ceil(side / resolution - 1e-9))) for side in (width, height))
    return {"resolution": resolution, "columns": columns, "rows": rows}


def model_of(model: Any) -> dict[str, Any]:
    """What a page needs to know of a model."""
    drive = model.drive
    return {
        "shape": shape_of(model.body),
        "drive": None
        if drive is None
        else {
            "max_speed": drive.max_speed,
            "max_turn_rate": float(np.radians(drive.max_turn_rate)),
        },
    }


def parts_of(body: Any) -> list[list[list[float]]]:
    """The convex outlines that a body is made of, in its frame: what a hand can get hold of."""
    return [corners.round(6).tolist() for corners, _ in pieces(body)]


def shape_of(body: Any) -> dict[str, Any]:
    """A body's outline: a radius, or corners in its frame."""
    if body.shape == "circle":
        return {"radius": body.radius}
    return {"corners": np.asarray(silhouette(body), float).round(6).tolist()}
