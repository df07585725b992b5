"""The walls around a world: outside of its size, or outside of its region's edges."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.stage.geometry import rectangle
from sim.stage.raster import Raster

Floats = NDArray[np.float64]


SHARPEST = 3.0
"""Thicknesses that a mitre may reach out. At a corner that would need more (sharper than 39
degrees) the walls taper towards it instead of running away."""


def walls_outside(polygon: Floats, thickness: float) -> list[Floats]:
    """A wall (4, 2) per edge of a convex counter-clockwise polygon (k, 2), all outside of it.

    Each wall is a convex quadrilateral between an edge and the same edge of the polygon grown
    by `thickness`. The corners are mitred, so that walls meet without a gap or an overlap.
    """
    edges = np.roll(polygon, -1, axis=0) - polygon
    along = edges / np.hypot(edges[:, 0], edges[:, 1])[:, None]
    outwards = np.stack([along[:, 1], -along[:, 0]], axis=1)
    both = outwards + np.roll(outwards, 1, axis=0)  # at the start of each edge, along the mitre
    size = np.hypot(both[:, 0], both[:, 1])
    length = np.minimum(2.0 * thickness / np.maximum(size, 1e-300), SHARPEST * thickness)
    outer = polygon + both * (length / np.maximum(size, 1e-300))[:, None]
    return [
        np.array([polygon[edge], outer[edge], outer[after], polygon[after]])
        for edge, after in enumerate([*range(1, len(polygon)), 0])
    ]


def inner_faces(polygon: Floats, overlap: float) -> Floats:
    """The edges of the polygon as segments (k, 4), each longer by `overlap` at both ends.

    The overlap lies behind the neighbouring wall, where nobody sees it; it keeps a ray that
    points exactly into a corner from slipping between two segments.
    """
    after = np.roll(polygon, -1, axis=0)
    edges = after - polygon
    along = edges / np.hypot(edges[:, 0], edges[:, 1])[:, None]
    return np.concatenate([polygon - overlap * along, after + overlap * along], axis=1)


def touchable(raster: Raster, size: tuple[float, float], thickness: float) -> list[Floats]:
    """The pieces (k of (4, 2)) of the walls around `size` that no wall of the map stands along.

    They are what a robot could meet, and so what a picture shows; a piece that begins or ends in
    a corner reaches around it.
    """
    width, height = size
    half, t, low = raster.cell / 2, thickness, np.array(raster.low)
    pieces: list[Floats] = []
    for upright, level, near, far in (
        (False, half, -t, 0.0),  # below
        (True, width - half, width, width + t),  # to the right
        (False, height - half, height, height + t),  # above
        (True, half, -t, 0.0),  # to the left
    ):
        length = height if upright else width
        along = np.arange(half, length, raster.cell)
        across = np.full(len(along), level)
        places = np.stack([across, along] if upright else [along, across], axis=1)
        ends = np.flatnonzero(np.diff(~raster.is_wall(places + low), prepend=False, append=False))
        for first, after in ends.reshape(-1, 2).tolist():
            start = first * raster.cell if first else -t
            end = after * raster.cell if after < len(along) else length + t
            corners = (near, start, far, end) if upright else (start, near, end, far)
            pieces.append(rectangle(*corners) + low)
    return pieces
