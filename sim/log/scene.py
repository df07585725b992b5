"""What stands and moves, as markers and grids that a viewer draws without knowing us."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sim.log.cdr import stamp
from sim.log.floor import FloorMirror
from sim.log.frames import WORLD, base
from sim.log.moment import Event
from sim.stage.geometry import outline, pieces

if TYPE_CHECKING:
    from sim.stage.layout import Layout
    from sim.stage.standing import Look

CUBE, CYLINDER, TRIANGLES = 1, 3, 11
"""visualization_msgs/Marker's numbers of kinds."""
MARKERS, GRID = "visualization_msgs/MarkerArray", "nav_msgs/OccupancyGrid"
MOST_CELLS = 1 << 20
"""Of the grid of what stands: a larger world gets larger cells."""
GRID_CELL = 0.1
"""Metres of a cell of that grid, if the world is not too large."""
FLAT, FAINT = 0.005, 0.5
"""How high (m) and how opaque things are drawn that are not solid."""
PAINTS = 99
"""Robots that a grid of paint tells apart: its cells are from 0 to 100."""


def wall_event(layout: Layout, time: float = 0.0) -> Event:
    """Walls and standing obstacles: one list of triangles for each look, flat if not solid."""
    alike: dict[Look, list[NDArray[np.float64]]] = {}
    for solid in layout.solids:
        look = solid.look
        triangles = fan(solid.vertices, look.z + look.height if look.solid else FLAT)
        alike.setdefault(look, []).append(triangles)
    markers = [
        marker(
            WORLD,
            "walls",
            number,
            TRIANGLES,
            look.color,
            points=np.concatenate(points),
            opacity=1.0 if look.solid else FAINT,
        )
        for number, (look, points) in enumerate(alike.items())
    ]
    return Event(time, "/troupe/walls", MARKERS, {"markers": markers})


def fan(vertices: NDArray[np.float64], height: float) -> NDArray[np.float64]:
    """A convex outline (k, 2) as triangles: their corners (3 * (k - 2), 3)."""
    k = len(vertices)
    order = np.stack([np.zeros(k - 2, int), np.arange(1, k - 1), np.arange(2, k)], axis=1)
    flat = vertices[order.reshape(-1)]
    return np.concatenate([flat, np.full((len(flat), 1), height)], axis=1)


def body_event(time: float, robots: Sequence[tuple[int, str, Any, int]]) -> Event:
    """Robots' bodies, fixed to their frames: (index, name for ROS, the schema's body, colour)."""
    markers = [
        body_marker(base(name), "robots", index, body, color) for index, name, body, color in robots
    ]
    return Event(time, "/troupe/bodies", MARKERS, {"markers": markers})


def body_marker(frame: str, space: str, number: int, body: Any, color: int) -> dict[str, Any]:
    """The marker of a body."""
    height = float(body.height)
    level = float(body.z) + 0.5 * height
    middle = {"position": {"z": level}}
    if body.shape == "circle":
        size = {"x": 2 * body.radius, "y": 2 * body.radius, "z": height}
        return marker(frame, space, number, CYLINDER, color, pose=middle, scale=size)
    if body.shape == "compound":
        parts = [fan(vertices, body.z + height) for vertices, _ in pieces(body)]
        return marker(frame, space, number, TRIANGLES, color, points=np.concatenate(parts))
    corners = outline(body)
    if body.shape == "box":
        low, high = corners.min(axis=0), corners.max(axis=0)
        length, width = (high - low).tolist()
        x, y = (0.5 * (low + high)).tolist()
        place = {"position": {"x": x, "y": y, "z": level}}
        size = {"x": length, "y": width, "z": height}
        return marker(frame, space, number, CUBE, color, pose=place, scale=size)
    return marker(frame, space, number, TRIANGLES, color, points=fan(corners, body.z + height))


def marker(
    frame: str,
    space: str,
    number: int,
    kind: int,
    color: int,
    *,
    pose: dict[str, Any] | None = None,
    scale: dict[str, float] | None = None,
    points: NDArray[np.float64] | Sequence[float] = (),
    opacity: float = 1.0,
) -> dict[str, Any]:
    """A marker that stays; colour 0xRRGGBB."""
    parts = [(color >> shift & 255) / 255 for shift in (16, 8, 0)]
    return {
        "header": {"frame_id": frame},
        "ns": space,
        "id": number,
        "type": kind,
        "pose": {"orientation": {"w": 1.0}, **(pose or {})},
        "scale": scale or {"x": 1.0, "y": 1.0, "z": 1.0},
        "color": {"r": parts[0], "g": parts[1], "b": parts[2], "a": opacity},
        "frame_locked": True,
        "points": points,
    }


def map_event(layout: Layout, time: float = 0.0) -> Event:
    """/map: cells that stand in a wall or an obstacle are 100, free ones 0."""
    width, height = layout.size
    cell = max(GRID_CELL, math.sqrt(width * height / MOST_CELLS))
    columns, rows = max(1, math.ceil(width / cell - 1e-9)), max(1, math.ceil(height / cell - 1e-9))
    x, y = (np.arange(columns) + 0.5) * cell, (np.arange(rows) + 0.5) * cell
    centres = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2) + layout.low
    free = replace(layout, region=None, pushed=()).inside(centres)
    return grid_event(time, "/map", rows, columns, cell, layout.low, np.where(free, 0, 100))


def paint_event(mirror: FloorMirror, time: float) -> Event:
    """/troupe/paint_grid: who painted each cell last, 1 to 99 for the robots in turn; 0: bare."""
    floor, owner = mirror.floor, mirror.owner.reshape(-1).astype(int)
    cells = np.where(owner > 0, (owner - 1) % PAINTS + 1, 0)
    return grid_event(
        time, "/troupe/paint_grid", floor.rows, floor.columns, floor.resolution, floor.low, cells
    )


def grid_event(
    time: float,
    topic: str,
    rows: int,
    columns: int,
    cell: float,
    low: tuple[float, float],
    cells: NDArray[np.int_],
) -> Event:
    """A grid of cells (rows * columns,) of `cell` metres; low: x, y of its lower left corner."""
    values = {
        "header": {"stamp": stamp(time), "frame_id": WORLD},
        "info": {
            "resolution": cell,
            "width": columns,
            "height": rows,
            "origin": {
                "position": {"x": low[0], "y": low[1]},
                "orientation": {"w": 1.0},
            },
        },
        "data": cells,
    }
    return Event(time, topic, GRID, values)
