"""The shape of a model: its blocks, its bitmap's pixels, or the box that Stage gives it without."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from sim.worldfile.shapes import crossing_edges
from troupe.importers.stage import values
from troupe.importers.stage.bitmap import read_plan, rectangles
from troupe.importers.stage.notes import Notes
from troupe.importers.stage.polygons import Polygon, area, bounds, cleaned, hull, is_convex
from troupe.importers.stage.syntax import Entity
from troupe.importers.stage.things import NO_BODY, Thing
from troupe.importers.stage.values import Pose

FLAT = 0.001
"""Metres: the height of what has none, as a mark on the floor."""
LEAST = 0.001
"""Metres: the length of what has none."""

Rise = tuple[float, float]
"""From which height to which something reaches, in metres above the floor."""


@dataclass(frozen=True)
class Shape:
    """A simple polygon (counter-clockwise, metres, in the model's frame), and how high it reaches.

    `box` is its length and width where it is a box centred on the model's pose.
    """

    corners: Polygon
    rise: Rise
    box: tuple[float, float] | None = None

    def moved(self, pose: Pose) -> Shape:
        """The shape in the frame in which the model has this pose."""
        if pose[:2] == (0.0, 0.0) and pose.a == 0.0:
            return self
        return Shape([pose.then(Pose(x, y))[:2] for x, y in self.corners], self.rise)


def shapes_of(thing: Thing, folder: str, notes: Notes) -> list[Shape]:
    """What a model is made of, without what stands on it; nothing for one that has no body.

    As in Stage all polygons together are scaled to the model's size, whatever units they are in.
    """
    entity = thing.entity
    length, width = (max(side, LEAST) for side in thing.size[:2])
    bottom = thing.pose.z + thing.origin.z
    rise = bottom, bottom + max(thing.size[2], FLAT)
    if min(thing.size[:2]) <= 0.0 and entity.type not in NO_BODY:
        notes.differs(entity.place, f"what has no length is {LEAST:g} m long here")
    bitmap = values.get(entity, "bitmap")
    if bitmap is not None and bitmap.values != ("",):
        plan = read_plan(str(bitmap.values[0]), folder, Pose(), (length, width), bitmap.place)
        found = [Shape(corners, rise) for corners in rectangles(plan)] if plan else []
        return [shape.moved(thing.origin) for shape in found]
    blocks = _blocks(entity, notes) + _polygons(entity)
    if not blocks:
        if entity.type in NO_BODY or values.number(entity, "noblocks", 0):
            return []
        x, y = length / 2, width / 2
        box = Shape([(-x, -y), (x, -y), (x, y), (-x, y)], rise, (length, width))
        return [box.moved(thing.origin)]
    left, low, right, high = bounds(point for polygon, _ in blocks for point in polygon)
    floor, top = min(z[0] for _, z in blocks), max(z[1] for _, z in blocks)
    found = []
    for polygon, z in blocks:
        scaled = cleaned(
            [
                (
                    (x - (left + right) / 2) * length / max(right - left, 1e-12),
                    (y - (low + high) / 2) * width / max(high - low, 1e-12),
                )
                for x, y in polygon
            ]
        )
        if len(scaled) >= 3 and crossing_edges(scaled) is not None:
            notes.differs(
                entity.place, "a block whose edges cross or touch is its convex hull here"
            )
            scaled = hull(scaled)
        if len(scaled) >= 3 and area(scaled) > 0.0:
            found.append(Shape(scaled, _scaled(z, floor, top, rise)).moved(thing.origin))
    if not found:
        notes.differs(entity.place, "blocks without an area are left out")
    return found


def _scaled(z: Rise, floor: float, top: float, rise: Rise) -> Rise:
    """A block's heights in the file in metres: from the floor of all blocks on, as Stage has it.

    Blocks are scaled so that they span the model's height; what lies below 0 stays there.
    """
    per = (rise[1] - rise[0]) / max(top - floor, 1e-12)
    low, high = rise[0] + z[0] * per, rise[0] + z[1] * per
    return low, max(high, low + FLAT)


def _blocks(entity: Entity, notes: Notes) -> list[tuple[Polygon, Rise]]:
    found = []
    for block in entity.children:
        if block.type != "block":
            continue
        count = int(values.number(block, "points", 0))
        points: Polygon = []
        for index in range(count):
            point = values.numbers(block, f"point[{index}]", 2)
            if point is not None:
                points.append((point[0], point[1]))
        z = values.numbers(block, "z", 2) or [0.0, 1.0]
        if {"color", "color_rgba"} & set(block.properties):
            block.used |= {"color", "color_rgba"}
            notes.looks(block.place, "the colour of a block: only Stage's window shows it")
        if len(points) < max(count, 3):
            notes.differs(
                block.place, "a block of fewer points than it says, or than 3, is left out"
            )
        elif len(points) >= 3:
            found.append((points, (z[0], z[1])))
    return found


def _polygons(entity: Entity) -> list[tuple[Polygon, Rise]]:
    """The polygons of Stage 2: `polygon[i].points` and `polygon[i].point[k]`."""
    entity.used.add("polygons")
    found = []
    for key in [key for key in entity.properties if key.endswith("].points")]:
        stem = key.removesuffix(".points")
        count = int(values.number(entity, key, 0))
        points = [values.numbers(entity, f"{stem}.point[{k}]", 2) for k in range(count)]
        for part in ("filled", "color"):
            entity.used.add(f"{stem}.{part}")
        if count >= 3 and all(point is not None for point in points):
            found.append(([(p[0], p[1]) for p in points if p is not None], (0.0, 1.0)))
    return found


def hull_of(shapes: Sequence[Shape]) -> Polygon:
    """The convex hull of all shapes."""
    return hull(corner for shape in shapes for corner in shape.corners)


def body_of(shapes: Sequence[Shape]) -> dict[str, Any]:
    """Shapes as the body of a world file: a box, a convex polygon, or a compound of parts."""
    (first, *rest) = shapes
    if not rest and first.box is not None:
        return {"shape": "box", "size": list(first.box)}
    if not rest and is_convex(first.corners):
        return {"shape": "polygon", "points": [list(corner) for corner in first.corners]}
    return {"shape": "compound", "parts": [_part(shape) for shape in shapes]}


def _part(shape: Shape) -> dict[str, Any]:
    if shape.box is not None:
        return {"shape": "box", "size": list(shape.box)}
    left, low, right, high = bounds(shape.corners)
    upright = {(left, low), (right, low), (right, high), (left, high)}
    if len(shape.corners) == 4 and set(shape.corners) == upright:
        middle = [(left + right) / 2, (low + high) / 2, 0]
        return {"shape": "box", "size": [right - left, high - low], "pose": middle}
    return {"shape": "polygon", "points": [list(corner) for corner in shape.corners]}


def height_of(rise: Rise) -> dict[str, Any]:
    """`z` and `height` of what reaches so high; nothing of it lies below the floor."""
    low, high = max(rise[0], 0.0), max(rise[1], FLAT)
    found: dict[str, Any] = {"z": low} if low > 1e-9 else {}
    return found | {"height": max(high - low, FLAT)}
