"""What one kind of sensor sees of a scene, as the arrays that the kernels take.

What a kind of sensor does not see, and what ends below its height or begins above it, is left out
of the grids before anything is cast. So the kernels ask nothing of the kind, and a ray costs the
same whatever it does not see.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from sensors.grid import Bodies, Flags, Floats, Ints, Walls, place_bodies, wall_grid
from sensors.solids import Solids, sort_solids

Seen = tuple[Bodies, Walls, Solids]
"""What the kernels take."""


class Outlines(NamedTuple):
    """All bodies of a scene: `bounds` and `vertices` in the world are shared by its sights."""

    bounds_local: Floats
    vertices_local: Floats
    bounds: Floats
    shapes: Ints
    vertices: Floats


class Standing(NamedTuple):
    """All walls of a scene, in the world.

    segments (M, 4) ax, ay, ex, ey from a to a + e, their entities, and whether they are sheets
    without an inside; pieces of (entity, corners (k, 2), hollow). And the entities (w,) of all of
    these, with the poses (w, 3) for which all of it is true.
    """

    segments: Floats
    owners: Ints
    sheets: Flags
    pieces: list[tuple[int, Floats, bool]]
    entities: Ints
    poses: Floats


def stand(
    walls: Sequence[tuple[int, Floats]],
    solids: Sequence[tuple[int, Floats, bool]],
    poses: Floats,
    hidden: Flags,
    hollow: Flags,
) -> tuple[Floats, Ints, Flags, list[tuple[int, Floats, bool]]]:
    """Walls and what lies within them where their entities are; `hidden` ones are left out.

    walls: entities with segments (m, 4) in their frames; solids: entities with corners (k, 2) and
    whether all but what they hold is solid.
    """
    placed, owners = [np.empty((0, 4))], [np.empty(0, np.int64)]
    for entity, lines in walls:
        if hidden[entity]:
            continue
        start, end = _placed(poses[entity], lines[:, :2]), _placed(poses[entity], lines[:, 2:])
        long = (start != end).any(axis=1)
        placed.append(np.hstack([start, end - start])[long])
        owners.append(np.full(int(long.sum()), entity, np.int64))
    whose = np.concatenate(owners)
    pieces = [
        (entity, _placed(poses[entity], vertices), outside)
        for entity, vertices, outside in solids
        if not hidden[entity]
    ]
    return np.concatenate(placed), whose, hollow[whose], pieces


def _placed(pose: Floats, points: Floats) -> Floats:
    """Points (k, 2) of the frame at a pose in the world."""
    x, y, heading = pose
    cos, sin = np.cos(heading), np.sin(heading)
    placed: Floats = points @ np.array([[cos, sin], [-sin, cos]]) + (x, y)
    return placed


class Sight:
    """The arrays of the entities that some sensors see; `seen` (E,) None: of all."""

    def __init__(self, outlines: Outlines, seen: Flags | None) -> None:
        count = len(outlines.shapes)
        self._seen = seen
        self._outlines = outlines
        self._cells = np.zeros(count, np.int64)
        self.bodies: Bodies = (
            outlines.bounds,
            outlines.shapes,
            outlines.vertices,
            np.zeros(6),
            np.zeros(2 * count + 66, np.int64),
            np.zeros(count, np.int64),
        )
        self.arrays: Seen
        self._given: tuple[Any, ...] = ()  # what the kernel of `place` is given each time

    def sort(self, standing: Standing, poses: Floats, hidden: Flags) -> None:
        """Take over the walls that are seen, and the arrays (E, 3), (E,) that `place` goes by.

        To be called whenever any of these has changed, but for the content of `poses`.
        """
        unseen = hidden if self._seen is None else hidden | ~self._seen
        outlines = self._outlines
        bounds, shapes, vertices, frame, start, items = self.bodies
        self._given = (
            poses, unseen, shapes, outlines.bounds_local, outlines.vertices_local, bounds,
            vertices, start, items, self._cells, frame, standing.entities, standing.poses,
        )  # fmt: skip
        segments, owners, sheets, pieces = standing[:4]
        if unseen.any():
            shown = ~unseen[owners]
            segments, owners, sheets = segments[shown], owners[shown], sheets[shown]
        segments = np.ascontiguousarray(segments)
        walls: Walls = (segments, owners, sheets, *wall_grid(segments))
        corners, rows, count = [np.empty((0, 2))], [], 0
        for entity, vertices, hollow in pieces:
            if not unseen[entity]:
                rows.append((entity, count, len(vertices), int(hollow)))
                corners.append(vertices)
                count += len(vertices)
        solids = sort_solids(
            np.ascontiguousarray(np.concatenate(corners)),
            np.array(rows, np.int64).reshape(-1, 4),
        )
        self.arrays = (self.bodies, walls, solids)

    def place(self) -> int:
        """Bring the bodies to their entities' poses; as `grid.place_bodies` tells it."""
        return place_bodies(*self._given)
