"""The ray kernel: what each of a fan of rays hits first, and how far away.

A reading is a one-dimensional picture. Seen from a sensor, an edge covers a run of rays: find the
run from the bearings of the edge's ends, and keep the nearest edge per ray (a 1-D z-buffer). That
buffer is `picture`'s. Cells of the grids are taken ring by ring from near to far, until nothing
nearer can come.

What a ray sees: the nearest point of any edge or circle of another entity. What has an inside
(polygons, circles, and walls that were given one) is solid: a sensor that lies within it, or on
an edge (within ON, 1e-9 m), reads 0 along all its rays. What is hollow is seen from within, and an
edge of it on which a sensor stands is not seen.
"""

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from sensors.bare import bare
from sensors.compiled import compiled, inlined
from sensors.grid import HOLLOW, Bodies, Floats, Ints, Walls, locate, most_spans, ring_spans
from sensors.picture import (
    EDGE_ON,
    ON,
    Hits,
    Parts,
    cover_circle,
    cover_line,
    draw_polygon,
    outside_view,
    parts_of,
    rough_bearing,
    stands_on,
)
from sensors.readings import Fan
from sensors.scene import Scene
from sensors.sight import Seen
from sensors.solids import stands_within
from sensors.view import View


@compiled
def most_corners(shapes: Ints) -> int:
    """The number of vertices of the shape that has most."""
    most = 0
    for s in range(shapes.shape[0]):
        most = max(most, shapes[s, 2])
    return most


@inlined
def _all_nearer(depth: Floats, parts: Parts, distance: float) -> bool:
    """Whether every ray ends nearer than `distance`: then nothing farther can be seen.

    Fans in which it is so are no longer live.
    """
    ends, _, live = parts
    if distance <= 0.0:
        return False
    done = True
    for part in range(live.shape[0]):
        if live[part] == 0:
            continue
        nearer = True
        for i in range(ends[part], ends[part + 1]):
            if depth[i] * distance <= 1.0:
                nearer = False
                break
        if nearer:
            live[part] = 0
        else:
            done = False
    return done


@inlined
def _draw_walls(
    walls: Walls,
    stamps: Ints,
    spans: Ints,
    depth: Floats,
    hits: Hits,
    fan: Floats,
    parts: Parts,
    fov: float,
    max_range: float,
    own: int,
    ox: float,
    oy: float,
    cos: float,
    sin: float,
) -> int:
    """Draw all walls. Returns the entity on whose edge the sensor stands, or -1."""
    segments, owners, sheets, frame, start, items = walls
    side_x, side_y = math.cos(0.5 * fov), math.sin(0.5 * fov)
    narrow = fov <= math.pi
    farthest = max_range * max_range * (1.0 + 1e-9)
    parts[2][:] = 1
    stamps[-1] += 1
    stamp = stamps[-1]
    column, row, first, last, inset = locate(frame, ox, oy)
    for ring in range(first, last + 1):
        if ring > 0:
            near = (ring - 1) * frame[2] + inset
            if near > max_range or _all_nearer(depth, parts, near):
                break
        for n in range(ring_spans(frame, start, column, row, ring, spans)):
            for k in range(spans[n, 0], spans[n, 1]):
                wall = items[k]
                if stamps[wall] == stamp or owners[wall] == own:
                    continue
                stamps[wall] = stamp
                x, y = segments[wall, 0] - ox, segments[wall, 1] - oy
                dx, dy = segments[wall, 2], segments[wall, 3]
                ax, ay = cos * x + sin * y, cos * y - sin * x
                ex, ey = cos * dx + sin * dy, cos * dy - sin * dx
                area = ax * ey - ay * ex
                if stands_on(ax, ay, ex, ey, area):
                    if sheets[wall]:
                        continue
                    return int(owners[wall])
                square = ex * ex + ey * ey
                if area * area <= EDGE_ON * EDGE_ON * square:
                    continue
                if area * area > farthest * square:  # its whole line lies beyond the range
                    continue
                bx, by = ax + ex, ay + ey
                if narrow:
                    left_a, left_b = side_x * ay - side_y * ax, side_x * by - side_y * bx
                    right_a, right_b = -side_x * ay - side_y * ax, -side_x * by - side_y * bx
                    if min(left_a, left_b) > ON or min(right_a, right_b) > ON:
                        continue
                a, b = rough_bearing(ay, ax), rough_bearing(by, bx)
                cover_line(depth, hits, fan, parts, owners[wall], area, ax, ay, ex, ey, a, b)
    return -1


@inlined
def _draw_bodies(
    bodies: Bodies,
    scratch: Floats,
    spans: Ints,
    depth: Floats,
    hits: Hits,
    fan: Floats,
    parts: Parts,
    fov: float,
    max_range: float,
    own: int,
    ox: float,
    oy: float,
    cos: float,
    sin: float,
) -> int:
    """Draw all bodies. Returns the entity in which the sensor lies, or -1."""
    bounds, shapes, vertices, frame, start, items = bodies
    side_x, side_y = math.cos(0.5 * fov), math.sin(0.5 * fov)
    narrow = fov <= math.pi
    parts[2][:] = 1
    column, row, first, last, inset = locate(frame, ox, oy)
    for ring in range(first - 1, last + 1):
        if ring == first - 1:  # first the cell behind the last: the bodies larger than a cell
            behind = int(frame[3]) * int(frame[4])
            spans[0, 0], spans[0, 1] = start[behind], start[behind + 1]
            count = 1
        else:
            if ring > 0:
                near = (ring - 1) * frame[2] + inset - frame[5]
                if near > max_range or _all_nearer(depth, parts, near):
                    break
            count = ring_spans(frame, start, column, row, ring, spans)
        for n in range(count):
            for k in range(spans[n, 0], spans[n, 1]):
                s = items[k]
                entity = shapes[s, 0]
                if entity == own:
                    continue
                dx, dy, reach = bounds[s, 0] - ox, bounds[s, 1] - oy, bounds[s, 2] + ON
                square = dx * dx + dy * dy
                if square > (max_range + reach) * (max_range + reach):
                    continue
                x, y = cos * dx + sin * dy, cos * dy - sin * dx
                if narrow and outside_view(x, y, side_x, side_y, reach):
                    continue
                if shapes[s, 2] == 0:
                    on = cover_circle(
                        depth, hits, fan, parts, entity, x, y, bounds[s, 2], shapes[s, 3] == HOLLOW
                    )
                else:
                    on = draw_polygon(
                        depth,
                        hits,
                        fan,
                        parts,
                        entity,
                        vertices[shapes[s, 1] : shapes[s, 1] + shapes[s, 2]],
                        shapes[s, 3] == 1,
                        shapes[s, 3] == HOLLOW,
                        square > reach * reach,
                        ox,
                        oy,
                        cos,
                        sin,
                        scratch,
                    )
                if on:
                    return int(entity)
    return -1


@compiled
def _cast_rows(
    held_seen: Seen,
    held_spans: Ints,
    held_stamps: Ints,
    held_scratch: Floats,
    held_depth: Floats,
    held_hit: Hits,
    origins: Floats,
    own: Ints,
    rows: Ints,
    held_fan: Floats,
    held_parts: Parts,
    fov: float,
    max_range: float,
    held_out: tuple[tuple[Floats, Hits], ...],
) -> None:
    """`cast_fans` with room to work in: the arrays are held by the caller."""
    bodies, walls, solids = bare(held_seen)
    spans, stamps, scratch = bare(held_spans), bare(held_stamps), bare(held_scratch)
    depth, hit = bare(held_depth), bare(held_hit)
    fan, parts, out = bare(held_fan), bare(held_parts), bare(held_out)
    empty = 1.0 / max_range
    for j in rows:
        depth[:] = empty
        hit[:] = -1
        x, y = origins[j, 0], origins[j, 1]
        cos, sin = math.cos(origins[j, 2]), math.sin(origins[j, 2])
        on = stands_within(solids, own[j], x, y)
        if on < 0:
            on = _draw_walls(
                walls, stamps, spans, depth, hit, fan, parts, fov, max_range, own[j], x, y, cos, sin
            )
        if on < 0:
            on = _draw_bodies(
                bodies, scratch, spans, depth, hit, fan, parts, fov, max_range, own[j], x, y, cos,
                sin,
            )  # fmt: skip
        for part in range(len(out)):
            ranges, hits = out[part][0][j], out[part][1][j]
            begin = parts[0][part]
            if on >= 0:
                ranges[:] = 0.0
                hits[:] = on
                continue
            for i in range(ranges.shape[0]):
                near = depth[begin + i]
                far = 1.0 / near
                ranges[i] = far if near > empty and far < max_range else max_range
            hits[:] = hit[begin : begin + ranges.shape[0]]


@compiled
def cast_fans(
    seen: Seen,
    origins: Floats,
    own: Ints,
    rows: Ints,
    fan: Floats,
    ends: Ints,
    scales: Floats,
    fov: float,
    max_range: float,
    out: tuple[tuple[Floats, Hits], ...],
) -> None:
    """Cast fans of rays from every origin of `rows` into the same rows of their `out`.

    Fans that look from one place, over one field of view and equally far, are cast at once: what
    there is to see is looked for only once.

    Args:
        seen: `Scene.seen`.
        origins: (n, 3) x, y, heading; own: (n,) the entity that each sensor does not see, or -1.
        rows: (m,) the sensors to cast.
        fan: (2, samples) cosines and sines of the rays' bearings, of one fan behind the other;
            ends, scales: where they end, as `parts_of` has it; fov in radians.
        out: per fan, ranges and hits (n, its samples), written.
    """
    bodies, walls, _ = seen
    _cast_rows(
        seen,
        np.empty((max(most_spans(bodies[3]), most_spans(walls[3])), 2), np.int64),
        np.zeros(walls[0].shape[0] + 1, np.int64),  # per wall: the last sensor that drew it
        np.empty((most_corners(bodies[1]), 6)),
        np.empty(fan.shape[1]),
        np.empty(fan.shape[1], np.int32),
        origins,
        own,
        rows,
        fan,
        (ends, scales, np.ones(scales.shape[0], np.int64)),
        fov,
        max_range,
        out,
    )


@lru_cache(maxsize=256)
def fans_of(fov: float, samples: tuple[int, ...]) -> tuple[Floats, Ints, Floats]:
    """Fans of `fov` radians with so many samples each, one behind the other, as `cast_fans` wants.

    Cosines and sines (2, all samples) of the bearings from the right, `ends` and `scales`.
    """
    bearings = np.concatenate([bearings_of(fov, count) for count in samples])
    fan = np.ascontiguousarray(np.stack([np.cos(bearings), np.sin(bearings)]))
    return fan, *parts_of(fov, samples)


def cast_for(view: View, fans: Sequence[Fan]) -> None:
    """Cast fans of one field of view and reach from the sensors of a view, together."""
    fov = fans[0].fov
    cast_fans(
        view.seen,
        view.origins,
        view.entities,
        view.rows,
        *fans_of(fov, tuple([fan.ranges.shape[1] for fan in fans])),
        fov,
        fans[0].max_range,
        tuple([(fan.ranges, fan.hits) for fan in fans]),
    )


def bearings_of(fov: float, samples: int) -> Floats:
    """The bearings (samples,) of a fan: from -fov/2 to +fov/2, radians; one sample looks ahead."""
    return np.linspace(-0.5 * fov, 0.5 * fov, samples) if samples > 1 else np.zeros(1)


def cast(
    scene: Scene,
    origins: npt.ArrayLike,
    own_entity: npt.ArrayLike,
    fov: float,
    samples: int,
    max_range: float,
    *,
    seen: Seen | None = None,
    rows: Ints | None = None,
    out: tuple[Floats, Hits] | None = None,
) -> tuple[Floats, Hits]:
    """Cast a fan of rays from each of n sensors.

    Args:
        scene: what can be seen, refreshed.
        origins: (n, 3) x, y in metres and heading in radians, in the world.
        own_entity: (n,) the entity that a sensor does not see (the robot that carries it), or -1.
        fov: the fan's width in radians, at most 2 pi; both ends are rays.
        samples: rays per sensor; ray 0 is the rightmost, at heading - fov/2.
        max_range: metres; what is farther is not seen.
        seen: what is left of the scene for these sensors, such as `View.seen`; all unless given.
        rows: (m,) the sensors to cast; all unless given.
        out: arrays to write into, for reuse; rows that are not cast keep their content.

    Returns:
        ranges (n, samples) float64 in metres, `max_range` where nothing is hit, and hits
        (n, samples) int32: the entity that was hit, or -1.
    """
    places = np.ascontiguousarray(origins, np.float64)
    own = np.ascontiguousarray(own_entity, np.int64)
    if out is None:
        shape = (len(places), samples)
        out = np.full(shape, max_range, np.float64), np.full(shape, -1, np.int32)
    if rows is None:
        rows = np.arange(len(places))
    cast_fans(
        scene.arrays if seen is None else seen,
        places,
        own,
        rows,
        *fans_of(float(fov), (samples,)),
        float(fov),
        float(max_range),
        (out,),
    )
    return out
