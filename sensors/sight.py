"""What one kind of sensor sees of a scene, as the arrays that the kernels take.

What a kind of sensor does not see, and what ends below its height or begins above it, is left out
of the grids before anything is cast. So the kernels ask nothing of the kind, and a ray costs the
same whatever it does not see.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

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
    without an inside; pieces of (entity, corners (k, 2), hollow).
    """

    segments: Floats
    owners: Ints
    sheets: Flags
    pieces: list[tuple[int, Floats, bool]]


def stand(
    walls: Sequence[tuple[int, Floats]],
    solids: Sequence[tuple[int, Floats, bool]],
    poses: Floats,
    hidden: Flags,
    hollow: Flags,
) -> Standing:
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
    return Standing(np.concatenate(placed), whose, hollow[whose], pieces)


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

    def sort_walls(self, standing: Standing, hidden: Flags) -> None:
        """Take over the walls that are seen."""
        unseen = self._unseen(hidden)
        segments, owners, sheets, pieces = standing
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

    def place(self, poses: Floats, hidden: Flags) -> int:
        """Bring the bodies to their entities' poses; -1, or an entity whose pose is not finite."""
        bounds, shapes, vertices, frame, start, items = self.bodies
        return place_bodies(
            poses,
            self._unseen(hidden),
            shapes,
            self._outlines.bounds_local,
            self._outlines.vertices_local,
            bounds,
            vertices,
            start,
            items,
            self._cells,
            frame,
        )

    def _unseen(self, hidden: Flags) -> Flags:
        """(E,) what is left out."""
        return hidden if self._seen is None else hidden | ~self._seen
