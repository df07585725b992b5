"""What of a world shows: what never moves, bodies' shapes, and what programs have drawn."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sim.silhouette import silhouette
from sim.stage.boundary import touchable
from sim.stage.geometry import placed
from sim.video.palette import GROUND, mix
from sim.video.snapshot import Backdrop, Drawing, Shape
from sim.view.figure import Figure, figures_that_show

if TYPE_CHECKING:
    from sim.build import LoadedWorld
    from sim.stage.layout import Layout
    from sim.stage.standing import Look

PALE = 0.6
"""The share of the ground's colour in that of things which robots can drive over or under."""


def backdrop_of(loaded: LoadedWorld, layout: Layout | None = None) -> Backdrop:
    """What does not move by itself, as it stands in a layout, or at the start.

    Of the boundary that which can be met: where a map has walls of its own along the edge, the
    boundary behind them is not shown.
    """
    layout, world = layout or loaded.layout, loaded.world
    solids = [(one.vertices, one.look.color) for one in layout.solids if stops_robots(one.look)]
    marks = [
        (one.vertices, mix(one.look.color, GROUND, PALE))
        for one in layout.solids
        if not stops_robots(one.look)
    ]
    wall = world.boundary
    if wall is not None and layout.raster is not None and wall.shape == "size":
        count = len(layout.arena)
        pieces = touchable(layout.raster, layout.size, wall.thickness)
        solids = [(piece, wall.color) for piece in pieces] + solids[count:]
    return Backdrop(
        size=layout.size,
        low=layout.low,
        solids=solids,
        marks=marks,
        doors=[door.rectangle for door in layout.doors],
        title=world.name or loaded.path.stem,
    )


class Backdrops:
    """The backdrop of a world in which hands move what stands."""

    def __init__(self, loaded: LoadedWorld) -> None:
        self._loaded = loaded
        self._layout = loaded.layout
        self._latest: Backdrop | None = None

    def of(self, layout: Layout) -> Backdrop | None:
        """That of a layout: the same as before where nothing has moved, None where nothing ever."""
        if layout is not self._layout:
            self._layout, self._latest = layout, backdrop_of(self._loaded, layout)
        return self._latest


def stops_robots(look: Look) -> bool:
    """Whether a thing takes up floor: what does not is shown pale, and under the robots."""
    return look.solid and look.z == 0.0


def shape_of(body: Any) -> Shape:
    """A body's outline in its own frame, or its radius."""
    return body.radius if body.shape == "circle" else silhouette(body)


def movables_of(loaded: LoadedWorld) -> list[tuple[Shape, int]]:
    """Shape and colour of every thing that can be pushed."""
    return [(shape_of(movable.body), movable.color) for movable in loaded.layout.movables]


def thing_poses(layout: Layout, movable_poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """(k, 3) where all things are: what can be pushed, then the fixtures of a layout."""
    standing = np.array([one.pose for one in layout.fixtures]).reshape(-1, 3)
    return np.concatenate([movable_poses, standing])


def drawings_of(figures: Sequence[Sequence[Figure]], poses: NDArray[np.float64]) -> list[Drawing]:
    """What robots at poses (n, 3) have drawn, (n,) in their frames, in world coordinates."""
    drawn: list[Drawing] = []
    for robot, figure in figures_that_show(figures):
        kind: Any = figure.kind
        fill = figure.fill_color
        at = placed(figure.points, poses[robot])
        drawn.append(Drawing(kind, at, figure.color, fill is not None, fill))
    return drawn
