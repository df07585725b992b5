"""The outline of a model on the floor: its blocks, or the box that Stage gives it without."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from troupe.importers.stage import values
from troupe.importers.stage.notes import Notes
from troupe.importers.stage.polygons import Polygon, bounds, cleaned, convex_pieces, hull
from troupe.importers.stage.syntax import Entity
from troupe.importers.stage.things import Thing
from troupe.importers.stage.tokens import StageError
from troupe.importers.stage.values import Pose


@dataclass(frozen=True)
class Footprint:
    """Convex pieces (counter-clockwise, metres, in the model's frame) that fill an outline.

    `box` is its length and width where it is a box centred on the model's pose.
    """

    pieces: tuple[Polygon, ...]
    box: tuple[float, float] | None

    @property
    def hull(self) -> Polygon:
        """The convex hull of all pieces."""
        return hull(corner for piece in self.pieces for corner in piece)


def footprint(thing: Thing, notes: Notes, shape: Sequence[Polygon] = ()) -> Footprint:
    """The outline of a model; `shape` are polygons to use in place of its blocks (of a bitmap).

    As in Stage all polygons together are scaled to the model's size, whatever units they are in.
    """
    length, width = thing.size[:2]
    polygons = list(shape) or _blocks(thing.entity, notes)
    if not polygons:
        if thing.entity.type in ("ranger", "laser", "blobfinder", "fiducial", "bumper"):
            return Footprint((), None)
        if values.number(thing.entity, "noblocks", 0):
            return Footprint((), None)
        corner = (length / 2, width / 2)
        box = [(-corner[0], -corner[1]), (corner[0], -corner[1]), corner, (-corner[0], corner[1])]
        if thing.origin == Pose():
            return Footprint((box,), (length, width))
        return Footprint((_moved(box, thing.origin),), None)
    left, bottom, right, top = bounds(point for polygon in polygons for point in polygon)
    pieces = []
    for polygon in polygons:
        scaled = [
            (
                (x - (left + right) / 2) * length / max(right - left, 1e-12),
                (y - (bottom + top) / 2) * width / max(top - bottom, 1e-12),
            )
            for x, y in polygon
        ]
        pieces += [_moved(piece, thing.origin) for piece in convex_pieces(scaled)]
    if not pieces:
        raise StageError(thing.entity.place, f"the blocks of {thing.entity.word} have no area")
    return Footprint(tuple(pieces), None)


def _moved(polygon: Polygon, origin: Pose) -> Polygon:
    return [origin.then(Pose(x, y))[:2] for x, y in polygon]


def _blocks(entity: Entity, notes: Notes) -> list[Polygon]:
    found = []
    for block in entity.children:
        if block.type != "block":
            continue
        count = int(values.number(block, "points", 0))
        if count < 3:
            raise StageError(block.place, f"a block needs at least 3 points, {count} are given")
        points: Polygon = []
        for index in range(count):
            point = values.numbers(block, f"point[{index}]", 2)
            if point is None:
                raise StageError(block.place, f"points is {count}, but there is no point[{index}]")
            points.append((point[0], point[1]))
        rise = values.numbers(block, "z", 2)
        if rise is not None and rise[0] > 0.0:
            notes.differs(
                block.properties["z"].place, "a block above the floor reaches down to it here"
            )
        if {"color", "color_rgba"} & set(block.properties):
            block.used |= {"color", "color_rgba"}
            notes.lost(block.place, "the colour of a block: a model has one colour here")
        found.append(cleaned(points) if len(points) > 3 else points)
    return [polygon for polygon in found if len(polygon) >= 3]
