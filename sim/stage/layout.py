"""The layout of a world: everything in it that is no robot, as plain geometry, built once."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sensors.eyes import eyes
from sensors.noise import random_color
from sim.stage.boundary import inner_faces, walls_outside
from sim.stage.distance_field import DistanceField, distance_field
from sim.stage.door_cells import door_cells
from sim.stage.geometry import (
    Bools,
    Floats,
    counter_clockwise,
    in_convex,
    pieces,
    placed,
    rectangle,
)
from sim.stage.imagemap import read_image_map
from sim.stage.levels import MOST_LEVELS, Levels, TooManyLevels, range_of
from sim.stage.raster import (
    MOST_OUTLINES,
    Raster,
    TooRagged,
    merged_outlines,
    rectangles_in_world,
)
from sim.stage.standing import DoorCell, Fixture, Landmark, Look, Movable, Pose, Solid, stood
from sim.stage.textmap import read_text_map
from sim.worldfile.extents import low_corner
from sim.worldfile.mistakes import Mistake, WorldError
from sim.worldfile.values import RANDOM

if TYPE_CHECKING:
    from collections.abc import Mapping, Sized

    from sim.worldfile.schema import Map, World


@dataclass(frozen=True)
class Layout:
    """A world without its robots.

    size: (width, height) metres; low: x, y of its lower left corner. region: convex polygon (k, 2)
    or None.
    arena (k, 2): where robots may be: within the size, or the region where its edges are walls.
    solids: all that stands, for physics and drawing; the boundary lies outside of `size`.
    obstacles: the outlines of what stands on the floor and is solid, in convex pieces; pushed: of
    what is movable, at the start.
    segments (m, 4), of which each has one of the `looks` (m,): the straight faces
    that can be seen, merged, for the sensors. insides: what lies behind those faces:
    the solids but for round ones, and in place of the boundary's walls the arena, clockwise: all
    that lies outside of it is wall. landmarks: what sensors see besides, each with its fiducial.
    fixtures: those of what stands that may be put elsewhere.
    levels: at which heights bodies can touch. raster: the map's walls, if they are solid.
    grid: the text map's walls (rows, columns) bool, row 0 at the top, and `cell` its cell size
    in metres; both None for other worlds.
    """

    size: tuple[float, float]
    low: tuple[float, float]
    region: Floats | None
    arena: Floats
    solids: tuple[Solid, ...]
    obstacles: tuple[Floats, ...]
    pushed: tuple[Floats, ...]
    segments: Floats
    looks: tuple[Look, ...]
    segment_looks: NDArray[np.int64]
    insides: tuple[Solid, ...]
    landmarks: tuple[Landmark, ...]
    movables: tuple[Movable, ...]
    fixtures: tuple[Fixture, ...]
    levels: Levels
    doors: tuple[DoorCell, ...]
    raster: Raster | None
    grid: Bools | None
    cell: float | None

    @cached_property
    def distances(self) -> DistanceField:
        """How far every place is from what stands, at least; made once for all runs here."""
        return distance_field(self)

    def moved(self, poses: Mapping[int, Pose]) -> Layout:
        """The same with fixtures, by their numbers, at other poses."""
        solids, insides, obstacles = list(self.solids), list(self.insides), list(self.obstacles)
        landmarks, fixtures = list(self.landmarks), list(self.fixtures)
        segments = self.segments.copy()
        for number, pose in poses.items():
            one = fixtures[number]
            made = stood(one.body, pose, one.group, self.levels.of(one.body))
            solids[one.solids], insides[one.insides] = made.solids, made.insides
            obstacles[one.obstacles] = made.obstacles
            landmarks[one.landmarks], segments[one.segments] = made.landmarks, made.segments
            fixtures[number] = replace(one, pose=pose)
        return replace(
            self,
            solids=tuple(solids),
            obstacles=tuple(obstacles),
            segments=segments,
            insides=tuple(insides),
            landmarks=tuple(landmarks),
            fixtures=tuple(fixtures),
        )

    def inside(self, points: ArrayLike) -> Bools:
        """For points (n, 2), whether each is in the region and in no wall or obstacle; (n,).

        Without a region the world's size is the region. An obstacle counts where it stands at
        the start, a movable one too.
        """
        flat = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        free = in_convex(flat, _rectangle(self.low, self.size))
        if self.region is not None:
            free &= in_convex(flat, self.region)
        if self.raster is not None:
            free &= ~self.raster.is_wall(flat)
        for vertices in (*self.obstacles, *self.pushed):
            low, high = vertices.min(axis=0), vertices.max(axis=0)
            near = np.nonzero(free & np.all((flat >= low) & (flat <= high), axis=1))[0]
            free[near] &= ~in_convex(flat[near], vertices)
        return free


class _Faces:
    """Collects visible segments with their looks."""

    def __init__(self) -> None:
        self.segments: list[Floats] = []
        self.numbers: dict[Look, int] = {}
        self.looks: list[int] = []

    def __len__(self) -> int:
        return len(self.looks)

    def add(self, segments: Floats, look: Look) -> None:
        self.segments.append(segments)
        self.looks += [self.numbers.setdefault(look, len(self.numbers))] * len(segments)


def build_layout(world: World, folder: Path) -> Layout:
    """Build the layout of a world whose relative file names start at `folder`.

    Raises WorldError: a map that is missing, unreadable or does not fit, no size, a door that
    has no place.
    """
    raster, lettered, is_text = _read_map(world.map, folder)
    levels = _levels(world)
    size = _size(world, raster, is_text)
    low = low_corner(world.origin, size)
    if raster is not None:
        raster = replace(raster, low=low)
    region = None if world.region is None else counter_clockwise(world.region)
    solids: list[Solid] = []
    insides: list[Solid] = []
    faces = _Faces()
    group = 0
    wall = world.boundary
    ring = _rectangle(low, size)
    if wall is not None:
        if wall.shape == "region" and region is not None:
            ring = region
        for vertices in walls_outside(ring, wall.thickness):
            solids.append(Solid(vertices, Look(wall.color, wall.height), wall.friction, group))
            group += 1
        faces.add(inner_faces(ring, wall.thickness), Look(wall.color, wall.height))
        insides.append(Solid(ring[::-1], Look(wall.color, wall.height), wall.friction))
    if raster is not None and world.map is not None:
        drawn = world.map
        look = Look(drawn.color, drawn.height, 0.0, eyes(drawn.seen_by), drawn.solid)
        height = levels.between(0.0, drawn.height) if drawn.solid else 0
        try:
            outlines = merged_outlines(raster)
        except TooRagged:
            what = f"the map's walls have more than {MOST_OUTLINES} edges"
            allowed = "plain dark walls on a light ground, as in a floorplan"
            raise WorldError(
                [Mistake(("map", "file"), what, str(world.map.file), allowed)]
            ) from None
        blocks = [
            Solid(rectangle(*edges), look, drawn.friction, group, levels=height)
            for edges in rectangles_in_world(raster)
        ]
        solids += blocks
        insides += blocks if drawn.solid else []
        group += 1
        faces.add(outlines, look)
    movables: list[Movable] = []
    fixtures: list[Fixture] = []
    landmarks: list[Landmark] = []
    obstacles: list[Floats] = []
    pushed: list[Floats] = []
    for index, told in enumerate(world.obstacles):
        entry = told
        if told.color == RANDOM:
            drawn_color = random_color(world.seed, f"obstacles.{index}")
            entry = told.model_copy(update={"color": drawn_color})
        x, y, degrees = entry.pose
        pose = (x, y, math.radians(degrees))
        if entry.movable:
            if entry.solid and entry.z == 0.0:
                pushed += [placed(vertices, pose) for vertices, _ in pieces(entry)]
            movables.append(
                Movable(entry, pose, entry.color, entry.height, entry.mass, entry.friction)
            )
            continue
        made = stood(entry, pose, group, levels.of(entry))
        whole: tuple[Sized, ...] = (solids, insides, obstacles, faces, landmarks)
        begins = [len(one) for one in whole]
        solids += made.solids
        insides += made.insides
        obstacles += made.obstacles
        landmarks += made.landmarks
        if len(made.segments):
            faces.add(made.segments, made.solids[0].look)
        if entry.name is not None:
            own = (slice(at, len(one)) for at, one in zip(begins, whole, strict=True))
            first, inside, outline, segment, landmark = own
            fixtures.append(
                Fixture(
                    entry.name, entry, group, pose, pose,
                    solids=first, insides=inside, obstacles=outline, segments=segment,
                    landmarks=landmark,
                )
            )  # fmt: skip
        group += 1
    return Layout(
        size=size,
        low=low,
        region=region,
        arena=ring,
        solids=tuple(solids),
        obstacles=tuple(obstacles),
        pushed=tuple(pushed),
        segments=np.concatenate([np.zeros((0, 4)), *faces.segments]),
        looks=tuple(faces.numbers),
        segment_looks=np.array(faces.looks, dtype=np.int64),
        insides=tuple(insides),
        landmarks=tuple(landmarks),
        movables=tuple(movables),
        fixtures=tuple(fixtures),
        levels=levels,
        doors=door_cells(world, raster, lettered, is_text),
        raster=raster if world.map is None or world.map.solid else None,
        grid=raster.walls if raster is not None and is_text else None,
        cell=raster.cell if raster is not None and is_text else None,
    )


def _rectangle(low: tuple[float, float], size: tuple[float, float]) -> Floats:
    """An upright rectangle (4, 2) from its lower left corner and its size."""
    return rectangle(low[0], low[1], low[0] + size[0], low[1] + size[1])


def _levels(world: World) -> Levels:
    """At which heights the bodies of a world can touch. Raises WorldError."""
    bodies = [model.body for model in world.models.values()]
    ranges = [range_of(body) for body in (*bodies, *world.obstacles) if body.solid]
    if world.map is not None and world.map.solid:
        ranges.append((0.0, world.map.height))
    try:
        return Levels(ranges)
    except TooManyLevels:
        what = f"bodies stand in more than {MOST_LEVELS} storeys of `z` and `height`"
        raise WorldError([Mistake(("obstacles",), what, None, "fewer different heights")]) from None


def _read_map(
    entry: Map | None, folder: Path
) -> tuple[Raster | None, tuple[tuple[int, int], ...], bool]:
    """The map's raster, the door cells (column, row) of a text map, and whether it is text."""
    if entry is None:
        return None, (), False
    path = folder / entry.file
    if entry.cell is not None:
        text = read_text_map(path)
        return Raster(text.walls, entry.cell), text.doors, True
    if entry.resolution is None:
        what = "a map needs `resolution` (an image, metres per pixel) or `cell` (a text map)"
        raise WorldError([Mistake(("map",), what)])
    return Raster(read_image_map(path), entry.resolution), (), False


def _size(world: World, raster: Raster | None, is_text: bool) -> tuple[float, float]:
    """The world's size; that of a text map follows from the map."""
    if raster is None:
        if world.size is None:
            raise WorldError([Mistake(("size",), "a world without a map needs its size")])
        return world.size
    width, height = raster.size
    if world.size is None:
        return width, height
    # Half a cell: more is another map, less is how far a size in round figures may be off.
    over = max(width - world.size[0], height - world.size[1])
    under = max(world.size[0] - width, world.size[1] - height) if is_text else 0.0
    if max(over, under) > raster.cell / 2:
        given = f"{world.size[0]:g} x {world.size[1]:g} m"
        allowed = f"{width:g} x {height:g} m, as the map is"
        raise WorldError([Mistake(("size",), "the size does not fit the map", given, allowed)])
    return (width, height) if is_text else world.size
