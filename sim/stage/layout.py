"""The layout of a world: everything in it that is no robot, as plain geometry, built once."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from sim.stage.boundary import inner_faces, walls_outside
from sim.stage.geometry import (
    Bools,
    Floats,
    counter_clockwise,
    in_convex,
    outline,
    placed,
    rectangle,
)
from sim.stage.imagemap import read_image_map
from sim.stage.raster import (
    MOST_OUTLINES,
    Raster,
    TooRagged,
    merged_outlines,
    rectangles_in_world,
)
from sim.stage.textmap import read_text_map
from sim.worldfile.mistakes import Mistake, WorldError

if TYPE_CHECKING:
    from sim.worldfile.schema import Door, Map, World


@dataclass(frozen=True)
class Solid:
    """A standing convex body: a piece of a wall, or an obstacle.

    vertices (k, 2) counter-clockwise in the world; color 0xRRGGBB; height in metres. Pieces of
    one thing (all blocks of a map) share `group`, so that a robot that slides from block to
    block touches one wall once. Chipmunk multiplies the coefficients of friction of two bodies
    that touch. circle: x, y and radius in metres of what is round; its vertices
    are those of a polygon of the same area, for pictures and placement.
    """

    vertices: Floats
    color: int
    height: float
    friction: float
    group: int = 0
    circle: tuple[float, float, float] | None = None


@dataclass(frozen=True)
class Movable:
    """An obstacle that robots can push: `body` of the schema, start pose (x, y, yaw) radians."""

    body: Any
    pose: tuple[float, float, float]
    color: int
    height: float
    mass: float
    friction: float = 0.5


@dataclass(frozen=True)
class DoorCell:
    """A door: robots of `model` enter at `centre` with `heading` (radians), one by one.

    size: width and depth in metres of the upright cell that must be free. period in seconds.
    """

    name: str
    centre: tuple[float, float]
    size: tuple[float, float]
    heading: float
    period: float
    model: str
    controller: str | None

    @property
    def rectangle(self) -> Floats:
        """The door's cell (4, 2), counter-clockwise."""
        (x, y), (width, depth) = self.centre, self.size
        return rectangle(x - width / 2, y - depth / 2, x + width / 2, y + depth / 2)


@dataclass(frozen=True)
class Layout:
    """A world without its robots.

    size: (width, height) metres, from the origin. region: convex polygon (k, 2) or None.
    arena (k, 2): where robots may be: within the size, or the region where its edges are walls.
    solids: all that stands, for physics and drawing; the boundary lies outside of `size`.
    segments (m, 4) with segment_colors (m,) uint32 and segment_heights (m,): the straight faces
    of the solids that can be seen, merged, for the sensors. insides: what lies behind those faces:
    the solids but for round ones, and in place of the boundary's walls the arena, clockwise: all
    that lies outside of it is wall. raster: the map's walls, or None.
    grid: the text map's walls (rows, columns) bool, row 0 at the top, and `cell` its cell size
    in metres; both None for other worlds.
    """

    size: tuple[float, float]
    region: Floats | None
    arena: Floats
    solids: tuple[Solid, ...]
    obstacles: tuple[Floats, ...]
    segments: Floats
    segment_colors: np.ndarray[Any, np.dtype[np.uint32]]
    segment_heights: Floats
    insides: tuple[Solid, ...]
    movables: tuple[Movable, ...]
    doors: tuple[DoorCell, ...]
    raster: Raster | None
    grid: Bools | None
    cell: float | None

    def inside(self, points: ArrayLike) -> Bools:
        """For points (n, 2), whether each is in the region and in no wall or obstacle; (n,).

        Without a region the world's size is the region. An obstacle counts where it stands at
        the start, a movable one too.
        """
        flat = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        free = in_convex(flat, rectangle(0.0, 0.0, *self.size))
        if self.region is not None:
            free &= in_convex(flat, self.region)
        if self.raster is not None:
            free &= ~self.raster.is_wall(flat)
        for vertices in self.obstacles:
            low, high = vertices.min(axis=0), vertices.max(axis=0)
            near = np.nonzero(free & np.all((flat >= low) & (flat <= high), axis=1))[0]
            free[near] &= ~in_convex(flat[near], vertices)
        return free


class _Faces:
    """Collects visible segments with their colours and heights."""

    def __init__(self) -> None:
        self.segments: list[Floats] = []
        self.colors: list[int] = []
        self.heights: list[float] = []

    def add(self, segments: Floats, color: int, height: float) -> None:
        self.segments.append(segments)
        self.colors += [color] * len(segments)
        self.heights += [height] * len(segments)


def build_layout(world: World, folder: Path) -> Layout:
    """Build the layout of a world whose relative file names start at `folder`.

    Raises WorldError: a map that is missing, unreadable or does not fit, no size, a door that
    has no place.
    """
    raster, door_cells, is_text = _read_map(world.map, folder)
    size = _size(world, raster, is_text)
    region = None if world.region is None else counter_clockwise(world.region)
    solids: list[Solid] = []
    insides: list[Solid] = []
    faces = _Faces()
    group = 0
    wall = world.boundary
    ring = rectangle(0.0, 0.0, *size)
    if wall is not None:
        if wall.shape == "region" and region is not None:
            ring = region
        for vertices in walls_outside(ring, wall.thickness):
            solids.append(Solid(vertices, wall.color, wall.height, wall.friction, group))
            group += 1
        faces.add(inner_faces(ring, wall.thickness), wall.color, wall.height)
        insides.append(Solid(ring[::-1], wall.color, wall.height, wall.friction))
    if raster is not None and world.map is not None:
        color, height, friction = world.map.color, world.map.height, world.map.friction
        try:
            outlines = merged_outlines(raster)
        except TooRagged:
            what = f"the map's walls have more than {MOST_OUTLINES} edges"
            allowed = "plain dark walls on a light ground, as in a floorplan"
            raise WorldError(
                [Mistake(("map", "file"), what, str(world.map.file), allowed)]
            ) from None
        blocks = [
            Solid(rectangle(*edges), color, height, friction, group)
            for edges in rectangles_in_world(raster)
        ]
        solids += blocks
        insides += blocks
        group += 1
        faces.add(outlines, color, height)
    movables: list[Movable] = []
    obstacles: list[Floats] = []
    for entry in world.obstacles:
        x, y, degrees = entry.pose
        pose = (x, y, math.radians(degrees))
        vertices = placed(outline(entry), pose)
        obstacles.append(vertices)
        if entry.movable:
            movables.append(
                Movable(entry, pose, entry.color, entry.height, entry.mass, entry.friction)
            )
            continue
        circle = (x, y, entry.radius) if entry.shape == "circle" else None
        solid = Solid(vertices, entry.color, entry.height, entry.friction, group, circle)
        solids.append(solid)
        group += 1
        if circle is not None:
            continue
        insides.append(solid)
        ends = np.roll(vertices, -1, axis=0)
        faces.add(np.concatenate([vertices, ends], axis=1), entry.color, entry.height)
    return Layout(
        size=size,
        region=region,
        arena=ring,
        solids=tuple(solids),
        obstacles=tuple(obstacles),
        segments=np.concatenate([np.zeros((0, 4)), *faces.segments]),
        segment_colors=np.array(faces.colors, dtype=np.uint32),
        segment_heights=np.array(faces.heights, dtype=np.float64),
        insides=tuple(insides),
        movables=tuple(movables),
        doors=_doors(world, raster, door_cells, is_text),
        raster=raster,
        grid=raster.walls if raster is not None and is_text else None,
        cell=raster.cell if raster is not None and is_text else None,
    )


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


def _doors(
    world: World, raster: Raster | None, cells: tuple[tuple[int, int], ...], is_text: bool
) -> tuple[DoorCell, ...]:
    """The doors with their places; those `at: S` take the map's S in reading order."""
    doors: list[DoorCell] = []
    mistakes: list[Mistake] = []
    waiting = iter(cells)
    lettered = sum(isinstance(door.at, str) for door in world.doors)
    if lettered and lettered != len(cells):
        index = next(i for i, door in enumerate(world.doors) if isinstance(door.at, str))
        what = "each door `at: S` needs an S of its own in the text map, and each S a door"
        given = f"{lettered} door(s), {len(cells)} S in the map"
        raise WorldError([Mistake(("doors", index, "at"), what, given)])
    for index, door in enumerate(world.doors):
        where = ("doors", index, "at")
        if isinstance(door.at, str):
            column, row = next(waiting)
        elif is_text and raster is not None:
            column, row = raster.at(*door.at)
            rows, columns = raster.walls.shape
            if not (0 <= column < columns and 0 <= row < rows) or raster.walls[row, column]:
                given = f"[{door.at[0]:g}, {door.at[1]:g}]"
                mistakes.append(Mistake(where, "the door is in a wall or off the map", given))
                continue
        if is_text and raster is not None:
            doors.append(_door(door, raster.centre(column, row), (raster.cell, raster.cell)))
        elif not isinstance(door.at, str) and door.model in world.models:
            doors.append(_door(door, door.at, _room(world.models[door.model].body, door.heading)))
    if mistakes:
        raise WorldError(mistakes)
    return tuple(doors)


def _room(body: Any, heading: float) -> tuple[float, float]:
    """Width and depth of the upright rectangle about the origin that a body takes at a heading."""
    vertices = placed(outline(body), (0.0, 0.0, math.radians(heading)))
    width, depth = 2 * np.abs(vertices).max(axis=0)
    return float(width), float(depth)


def _door(door: Door, centre: tuple[float, float], size: tuple[float, float]) -> DoorCell:
    heading = math.radians(door.heading)
    return DoorCell(door.name, centre, size, heading, door.period, door.model, door.controller)
