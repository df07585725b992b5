"""What can be seen: entities with a pose, a colour and a height, made of polygons and circles."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from sensors.eyes import EVERY_EYE
from sensors.grid import HOLLOW, WALLS_MOVED, Flags, Floats, Ints
from sensors.outlines import Outline, outline_of, polygon_of
from sensors.sight import Outlines, Seen, Sight, Standing, stand

Colors = npt.NDArray[np.uint32]
Levels = npt.NDArray[np.uint8]
ON_LEVEL = 1e-9
"""m: a sensor as high as a thing ends or begins still sees it, rounding or not."""


class Scene:
    """Everything that a sensor can perceive, as arrays over entities.

    An entity is a thing with one colour, height and fiducial id, and a pose; its shapes are given
    in its own frame. Polygons and circles are bodies: they may move at every tick. Segments are
    walls: they may move too, but that sorts all walls anew. Poses are x, y in metres and heading
    in radians, counter-clockwise from the x axis.

    Bodies are solid: a sensor of another entity within one sees nothing but it, at range 0.
    Segments alone are as thin as a sheet; `add_solid` tells what lies within walls made of them.
    An entity that is not solid is an empty shell: from within, its outline is seen from within.

    Which kinds of sensor see an entity, and between which heights it reaches, is told when it is
    added: `seen` gives the kernels what one kind of sensor at one height sees.

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
        self._hollow = np.zeros(16, np.bool_)
        self._bottoms = np.zeros(16)
        self._eyes = np.zeros(16, np.uint8)
        self._choosy = False  # whether there is anything that not every kind of sensor sees
        self._shapes: list[tuple[int, int, int, int]] = []
        self._bounds: list[tuple[float, float, float]] = []
        self._vertices: list[Floats] = []
        self._corners = 0  # of all polygons
        self._polygons: dict[bytes, Outline] = {}  # a crowd is made of few different ones
        self._walls: list[tuple[int, Floats]] = []
        self._solids: list[tuple[int, Floats, bool]] = []
        self.version = 0
        """Another number whenever the arrays of `seen` may be others than before."""
        self._stale = True
        self._walls_stale = True
        self._wall_entities = np.zeros(0, np.int64)
        self._wall_poses = np.zeros((0, 3))
        self._standing: Standing
        self._outlines: Outlines
        self._whole: Sight
        self._sights: dict[bytes, Sight] = {}  # by which entities are seen
        self._found: dict[tuple[int, float | None], Sight] = {}  # by eye and height
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
        solid: bool = True,
        seen_by: int = EVERY_EYE,
        bottom: float = 0.0,
    ) -> int:
        """Add an entity without shapes and return its index.

        solid: whether it has an inside. seen_by: bits of `eyes.EYES`. bottom: m, where it begins
        above the floor; it is `height` high.
        """
        entity = self._count
        if entity == len(self._poses):
            for name in ("_poses", "_colors", "_heights", "_fiducials", "_hidden", "_hollow",
                         "_bottoms", "_eyes"):  # fmt: skip
                old = getattr(self, name)
                setattr(self, name, np.concatenate([old, np.zeros_like(old)]))
        self._count += 1
        self._poses[entity] = pose
        self._colors[entity] = color
        self._heights[entity] = height
        self._fiducials[entity] = fiducial
        self._hidden[entity] = False
        self._hollow[entity] = not solid
        self._bottoms[entity] = bottom
        self._eyes[entity] = seen_by
        self._choosy = self._choosy or seen_by != EVERY_EYE
        self._sights.clear()
        self._found.clear()
        self._stale = True
        self.version += 1
        return entity

    def add_polygon(self, entity: int, vertices: npt.ArrayLike) -> None:
        """Add a polygon (k, 2) in the entity's frame, counter-clockwise, with k >= 3.

        Clockwise ones are turned round; concave ones are seen correctly too, only slower.
        """
        self._check(entity)
        given = np.array(vertices, np.float64)
        known = self._polygons.get(given.tobytes())
        if known is None:
            known = self._polygons[given.tobytes()] = outline_of(given)
        corners, convex, bounds = known
        kind = HOLLOW if self._hollow[entity] else int(convex)
        self._shapes.append((entity, self._corners, len(corners), kind))
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
        self._shapes.append((entity, 0, 0, HOLLOW if self._hollow[entity] else 1))
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
        self._solids.append((entity, *polygon_of(vertices)))
        self._walls_stale = True

    def move(self, entities: npt.ArrayLike, poses: npt.ArrayLike) -> None:
        """Give entities (k,) new poses (k, 3)."""
        self._poses[: self._count][np.asarray(entities)] = poses

    def hide(self, entity: int, hidden: bool = True) -> None:
        """Take an entity out of everybody's sight, or bring it back."""
        self._check(entity)
        self._hidden[entity] = hidden
        self._walls_stale = True

    @property
    def arrays(self) -> Seen:
        """What the kernels take, of everything that is not hidden."""
        return self._whole.arrays

    def seen(self, eye: int = 0, z: float | None = None) -> Seen:
        """What the kernels take of what a kind of sensor sees, as of the last refresh.

        eye: of `eyes.EYES`, or 0 for one that sees everything. z: how high it looks, in metres;
        None: it sees things of all heights. Two kinds that see the same get the same arrays.
        """
        if z is None and not (self._choosy and eye):
            return self._whole.arrays
        sight = self._found.get((eye, z))
        if sight is None:
            sight = self._found[eye, z] = self._sight(self.sees(eye, z))
        return sight.arrays

    def sees(self, eye: int, z: float | None) -> Flags:
        """(E,) which entities a kind of sensor at a height would see, if nothing hid them."""
        seen = np.ones(self._count, np.bool_)
        if eye:
            seen &= (self._eyes[: self._count] & eye) != 0
        if z is not None:
            bottoms = self._bottoms[: self._count]
            seen &= (bottoms <= z + ON_LEVEL) & (bottoms + self.heights >= z - ON_LEVEL)
        return seen

    def _sight(self, seen: Flags) -> Sight:
        """The sight of these entities (E,), ready for use."""
        if seen.all():
            return self._whole
        key = seen.tobytes()
        if key not in self._sights:
            sight = self._sights[key] = Sight(self._outlines, seen)
            sight.sort(self._standing, self.poses, self.hidden)
            sight.place()
        return self._sights[key]

    def refresh(self) -> None:
        """Bring what sensors see up to date with the poses.

        Raises:
            ValueError: a pose is not finite.
        """
        if self._stale or self._walls_stale:
            self._sort()
        lost = self._whole.place()
        if lost == WALLS_MOVED:
            self._sort()
            lost = self._whole.place()
        if lost >= 0:
            raise ValueError(f"the pose of entity {lost} is not finite: {self._poses[lost]}")
        for sight in self._sights.values():
            sight.place()

    def _sort(self) -> None:
        """After a change, or where a wall has moved: sort all anew that is seen."""
        if self._stale:
            self._allocate()
        self._place_walls()
        self.version += 1
        for sight in (self._whole, *self._sights.values()):
            sight.sort(self._standing, self.poses, self.hidden)

    def world_edges(self) -> tuple[Floats, Ints]:
        """All visible straight edges as of the last refresh: (m, 4) x1, y1, x2, y2, entity (m,)."""
        _, shapes, vertices, *_ = self._whole.bodies
        edges = [np.empty((0, 4))]
        owners = [np.empty(0, np.int64)]
        for entity, first, count, _ in shapes:
            if count and not self._hidden[entity]:
                corners = vertices[first : first + count]
                edges.append(np.hstack([corners, np.roll(corners, -1, axis=0)]))
                owners.append(np.full(count, entity))
        _, (segments, wall_owners, *_), _ = self.arrays
        edges.append(np.hstack([segments[:, :2], segments[:, :2] + segments[:, 2:]]))
        owners.append(wall_owners)
        return np.concatenate(edges), np.concatenate(owners)

    def world_circles(self) -> tuple[Floats, Ints]:
        """All visible circles as of the last refresh: (m, 3) x, y, radius, and entity (m,)."""
        bounds, shapes, *_ = self._whole.bodies
        rows = (shapes[:, 2] == 0) & ~self._hidden[shapes[:, 0]]
        return bounds[rows], shapes[rows, 0]

    def _check(self, entity: int) -> None:
        if not 0 <= entity < self._count:
            raise IndexError(f"no entity {entity}: the scene has {self._count}")

    def _allocate(self) -> None:
        """Make room for all shapes that there are."""
        vertices = np.concatenate([np.empty((0, 2)), *self._vertices])
        self._outlines = Outlines(
            bounds_local=np.array(self._bounds, np.float64).reshape(-1, 3),
            vertices_local=vertices,
            bounds=np.zeros((len(self._shapes), 3)),
            shapes=np.array(self._shapes, np.int64).reshape(-1, 4),
            vertices=np.zeros_like(vertices),
        )
        self._whole = Sight(self._outlines, None)
        self._sights.clear()
        self._found.clear()
        self._stale = False

    def _place_walls(self) -> None:
        """Put all walls where their entities are."""
        standing = {e for e, _ in self._walls} | {e for e, _, _ in self._solids}
        self._wall_entities = np.array(sorted(standing), np.int64)
        self._wall_poses = self._poses[self._wall_entities].copy()
        if not np.isfinite(self._wall_poses).all():
            raise ValueError("the pose of a wall is not finite")
        placed = stand(self._walls, self._solids, self._poses, self._hidden, self._hollow)
        self._standing = Standing(*placed, self._wall_entities, self._wall_poses)
        self._walls_stale = False
