"""What can be seen: entities with a pose, a colour and a height, made of polygons and circles."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from .grid import Bodies, Flags, Floats, Ints, Walls, place_bodies, wall_grid
from .solids import Solids, sort_solids

Seen = tuple[Bodies, Walls, Solids]
"""What the kernels take: `Scene.arrays`."""
Colors = npt.NDArray[np.uint32]
Outline = tuple[Floats, bool, tuple[float, float, float]]


class Scene:
    """Everything that a sensor can perceive, as arrays over entities.

    An entity is a thing with one colour, height and fiducial id, and a pose; its shapes are given
    in its own frame. Polygons and circles are bodies: they may move at every tick. Segments are
    walls: they may move too, but that sorts all walls anew. Poses are x, y in metres and heading
    in radians, counter-clockwise from the x axis.

    Bodies are solid: a sensor of another entity within one sees nothing but it, at range 0.
    Segments alone are as thin as a sheet; `add_solid` tells what lies within walls made of them.

    Write new poses into `poses` (in place) or by `move`, then call `refresh`: sensors see what
    was true at the last `refresh`, except for colours, heights and fiducials, which they see as
    they are. `add_entity` may replace the arrays: take them anew after it.
    """

    def __init__(self) -> None:
        self._count = 0
        self._poses = np.zeros((16, 3))
        self._colors = np.zeros(16, np.uint32)
        self._heights = np.ones(16)
        self._fiducials = np.zeros(16, np.int32)
        self._hidden = np.zeros(16, np.bool_)
        self._shapes: list[tuple[int, int, int, int]] = []
        self._bounds: list[tuple[float, float, float]] = []
        self._vertices: list[Floats] = []
        self._corners = 0  # of all polygons
        self._polygons: dict[bytes, Outline] = {}  # a crowd is made of few different ones
        self._walls: list[tuple[int, Floats]] = []
        self._solids: list[tuple[int, Floats, bool]] = []
        self._stale = True
        self._walls_stale = True
        self._wall_entities = np.zeros(0, np.int64)
        self._wall_poses = np.zeros((0, 3))
        self.arrays: Seen
        """What the kernels take."""
        self.bodies: Bodies
        self.walls: Walls
        self.solids: Solids
        self.refresh()

    def __len__(self) -> int:
        return self._count

    @property
    def poses(self) -> Floats:
        """(E, 3) x, y, heading: a view, to be written in place."""
        return self._poses[: self._count]

    @property
    def colors(self) -> Colors:
        """(E,) 0xRRGGBB: a view, to be written in place."""
        return self._colors[: self._count]

    @property
    def heights(self) -> Floats:
        """(E,) metres: a view, to be written in place."""
        return self._heights[: self._count]

    @property
    def fiducials(self) -> npt.NDArray[np.int32]:
        """(E,) the id that fiducial finders see, 0 for none: a view, to be written in place."""
        return self._fiducials[: self._count]

    @property
    def hidden(self) -> Flags:
        """(E,) whether an entity is out of everybody's sight: read it; write with `hide`."""
        return self._hidden[: self._count]

    def add_entity(
        self,
        *,
        color: int = 0,
        height: float = 1.0,
        fiducial: int = 0,
        pose: Sequence[float] = (0.0, 0.0, 0.0),
    ) -> int:
        """Add an entity without shapes and return its index."""
        entity = self._count
        if entity == len(self._poses):
            for name in ("_poses", "_colors", "_heights", "_fiducials", "_hidden"):
                old = getattr(self, name)
                setattr(self, name, np.concatenate([old, np.zeros_like(old)]))
        self._count += 1
        self._poses[entity] = pose
        self._colors[entity] = color
        self._heights[entity] = height
        self._fiducials[entity] = fiducial
        self._hidden[entity] = False
        return entity

    def add_polygon(self, entity: int, vertices: npt.ArrayLike) -> None:
        """Add a polygon (k, 2) in the entity's frame, counter-clockwise, with k >= 3.

        Clockwise ones are turned round; concave ones are seen correctly too, only slower.
        """
        self._check(entity)
        given = np.array(vertices, np.float64)
        known = self._polygons.get(given.tobytes())
        if known is None:
            known = self._polygons[given.tobytes()] = _outline(given)
        corners, convex, bounds = known
        self._shapes.append((entity, self._corners, len(corners), int(convex)))
        self._bounds.append(bounds)
        self._vertices.append(corners)
        self._corners += len(corners)
        self._stale = True

    def add_circle(
        self, entity: int, radius: float, centre: tuple[float, float] = (0.0, 0.0)
    ) -> None:
        """Add a circle, in the entity's frame."""
        self._check(entity)
        if not (np.isfinite(radius) and radius > 0.0 and np.isfinite(centre).all()):
            raise ValueError(f"a circle needs a positive radius, not {radius} about {centre}")
        self._shapes.append((entity, 0, 0, 1))
        self._bounds.append((float(centre[0]), float(centre[1]), float(radius)))
        self._stale = True

    def add_segments(self, entity: int, segments: npt.ArrayLike) -> None:
        """Add walls: segments (m, 4) x1, y1, x2, y2 in the entity's frame."""
        self._check(entity)
        lines = np.array(segments, np.float64).reshape(-1, 4)
        if not np.isfinite(lines).all():
            raise ValueError("segments must be finite")
        self._walls.append((entity, lines))
        self._walls_stale = True

    def add_solid(self, entity: int, vertices: npt.ArrayLike) -> None:
        """Make solid what lies within a polygon (k, 2) in the entity's frame.

        A clockwise polygon is hollow: all but what lies within it is solid, as round an arena.
        Nothing of it is seen; its faces are segments of the same entity.
        """
        self._check(entity)
        self._solids.append((entity, *_polygon(vertices)))
        self._walls_stale = True

    def move(self, entities: npt.ArrayLike, poses: npt.ArrayLike) -> None:
        """Give entities (k,) new poses (k, 3)."""
        self._poses[: self._count][np.asarray(entities)] = poses

    def hide(self, entity: int, hidden: bool = True) -> None:
        """Take an entity out of everybody's sight, or bring it back."""
        self._check(entity)
        self._hidden[entity] = hidden
        self._walls_stale = True

    def refresh(self) -> None:
        """Bring what sensors see up to date with the poses.

        Raises:
            ValueError: a pose is not finite.
        """
        changed = self._stale
        if changed:
            self._allocate()
        walls = self._wall_entities
        if self._walls_stale or (
            walls.size and not np.array_equal(self._poses[walls], self._wall_poses)
        ):
            self._sort_walls()
            changed = True
        if changed:
            self.arrays = (self.bodies, self.walls, self.solids)
        bounds, shapes, vertices, frame, start, items = self.bodies
        lost = place_bodies(
            self._poses,
            self._hidden,
            shapes,
            self._bounds_local,
            self._vertices_local,
            bounds,
            vertices,
            start,
            items,
            self._cells,
            frame,
        )
        if lost >= 0:
            raise ValueError(f"the pose of entity {lost} is not finite: {self._poses[lost]}")

    def world_edges(self) -> tuple[Floats, Ints]:
        """All visible straight edges as of the last refresh: (m, 4) x1, y1, x2, y2, entity (m,)."""
        _, shapes, vertices, *_ = self.bodies
        edges = [np.empty((0, 4))]
        owners = [np.empty(0, np.int64)]
        for entity, first, count, _ in shapes:
            if count and not self._hidden[entity]:
                corners = vertices[first : first + count]
                edges.append(np.hstack([corners, np.roll(corners, -1, axis=0)]))
                owners.append(np.full(count, entity))
        segments = self.walls[0]
        edges.append(np.hstack([segments[:, :2], segments[:, :2] + segments[:, 2:]]))
        owners.append(self.walls[1])
        return np.concatenate(edges), np.concatenate(owners)

    def world_circles(self) -> tuple[Floats, Ints]:
        """All visible circles as of the last refresh: (m, 3) x, y, radius, and entity (m,)."""
        bounds, shapes, *_ = self.bodies
        rows = (shapes[:, 2] == 0) & ~self._hidden[shapes[:, 0]]
        return bounds[rows], shapes[rows, 0]

    def _check(self, entity: int) -> None:
        if not 0 <= entity < self._count:
            raise IndexError(f"no entity {entity}: the scene has {self._count}")

    def _allocate(self) -> None:
        shapes = np.array(self._shapes, np.int64).reshape(-1, 4)
        self._bounds_local = np.array(self._bounds, np.float64).reshape(-1, 3)
        self._vertices_local = np.concatenate([np.empty((0, 2)), *self._vertices])
        count = len(shapes)
        self._cells = np.zeros(count, np.int64)
        self.bodies = (
            np.zeros((count, 3)),
            shapes,
            np.zeros_like(self._vertices_local),
            np.zeros(6),
            np.zeros(2 * count + 66, np.int64),
            np.zeros(count, np.int64),
        )
        self._stale = False

    def _sort_walls(self) -> None:
        standing = {e for e, _ in self._walls} | {e for e, _, _ in self._solids}
        self._wall_entities = np.array(sorted(standing), np.int64)
        self._wall_poses = self._poses[self._wall_entities].copy()
        if not np.isfinite(self._wall_poses).all():
            raise ValueError("the pose of a wall is not finite")
        placed, owners = [np.empty((0, 4))], [np.empty(0, np.int64)]
        for entity, lines in self._walls:
            if self._hidden[entity]:
                continue
            start, end = self._placed(entity, lines[:, :2]), self._placed(entity, lines[:, 2:])
            long = (start != end).any(axis=1)
            placed.append(np.hstack([start, end - start])[long])
            owners.append(np.full(int(long.sum()), entity, np.int64))
        walls = np.ascontiguousarray(np.concatenate(placed))
        self.walls = (walls, np.concatenate(owners), *wall_grid(walls))
        corners, pieces, count = [np.empty((0, 2))], [], 0
        for entity, vertices, hollow in self._solids:
            if not self._hidden[entity]:
                pieces.append((entity, count, len(vertices), int(hollow)))
                corners.append(self._placed(entity, vertices))
                count += len(vertices)
        self.solids = sort_solids(
            np.ascontiguousarray(np.concatenate(corners)),
            np.array(pieces, np.int64).reshape(-1, 4),
        )
        self._walls_stale = False

    def _placed(self, entity: int, points: Floats) -> Floats:
        """Points (k, 2) of an entity's frame in the world."""
        x, y, heading = self._poses[entity]
        cos, sin = np.cos(heading), np.sin(heading)
        placed: Floats = points @ np.array([[cos, sin], [-sin, cos]]) + (x, y)
        return placed


def _outline(vertices: Floats) -> Outline:
    """A polygon's corners (k, 2) counter-clockwise, whether it is convex, and its bounding circle.

    Raises:
        ValueError: it has fewer than three vertices, is not finite or without an area.
    """
    corners, _ = _polygon(vertices)
    edges = np.roll(corners, -1, axis=0) - corners
    after = np.roll(edges, -1, axis=0)
    turns = edges[:, 0] * after[:, 1] - edges[:, 1] * after[:, 0]
    # All turns to the left, and once round in all: a star turns left too, but twice round.
    angles = np.arctan2(turns, np.sum(edges * after, axis=1))
    convex = bool((turns >= 0.0).all() and abs(angles.sum() - 2.0 * np.pi) < 1.0)
    centre = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    radius = float(np.hypot(*(corners - centre).T).max()) * (1.0 + 1e-12)
    return corners, convex, (float(centre[0]), float(centre[1]), radius)


def _polygon(vertices: npt.ArrayLike) -> tuple[Floats, bool]:
    """The vertices (k, 2) of a polygon counter-clockwise, and whether they were clockwise.

    Raises:
        ValueError: fewer than three, not finite, or without an area.
    """
    corners = np.array(vertices, np.float64)
    if corners.ndim != 2 or corners.shape[1] != 2 or len(corners) < 3:
        raise ValueError(f"a polygon needs (k, 2) vertices with k >= 3, not {corners.shape}")
    own = corners - corners[:1]
    before = np.roll(own, 1, axis=0)
    area = float(np.sum(before[:, 0] * own[:, 1] - before[:, 1] * own[:, 0]))
    if not np.isfinite(corners).all() or area == 0.0:
        raise ValueError(f"a polygon needs finite vertices and an area: {corners.tolist()}")
    return (corners[::-1].copy() if area < 0.0 else corners), area < 0.0
