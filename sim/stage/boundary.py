"""The walls around a world: outside of its size, or outside of its region's edges."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def walls_outside(polygon: Floats, thickness: float) -> list[Floats]:
    """A wall (4, 2) per edge of a convex counter-clockwise polygon (k, 2), all outside of it.

    Each wall is a convex quadrilateral between an edge and the same edge of the polygon grown
    by `thickness`, with the corners mitred, so that walls meet without a gap or an overlap.
    Where a corner is so sharp that its mitre would run away (beyond twice the thickness), the
    walls end square there instead, and overlap nothing inside.
    """
    edges = np.roll(polygon, -1, axis=0) - polygon
    along = edges / np.hypot(edges[:, 0], edges[:, 1])[:, None]
    outwards = np.stack([along[:, 1], -along[:, 0]], axis=1)
    walls = []
    for edge in range(len(polygon)):
        before, after = edge - 1, (edge + 1) % len(polygon)
        start = _shift(outwards[edge], outwards[before], -along[edge], thickness)
        end = _shift(outwards[edge], outwards[after], along[edge], thickness)
        corners = [polygon[edge], polygon[edge] + start, polygon[after] + end, polygon[after]]
        walls.append(np.array(corners))
    return walls


def _shift(outwards: Floats, neighbour: Floats, away: Floats, thickness: float) -> Floats:
    """From a corner of the polygon to the outer corner of a wall that ends there.

    outwards: the normal of the wall's own edge; neighbour: that of the edge beyond the corner;
    away: along the own edge, out of it.
    """
    both = outwards + neighbour
    square = float(both @ both)
    # The mitre's length is 2 thickness / |both|.
    if square < 1.0:
        shift: Floats = thickness * (outwards + away)
        return shift
    mitre: Floats = 2.0 * thickness / square * both
    return mitre


def inner_faces(polygon: Floats, overlap: float) -> Floats:
    """The edges of the polygon as segments (k, 4), each longer by `overlap` at both ends.

    The overlap lies behind the neighbouring wall, where nobody sees it; it keeps a ray that
    points exactly into a corner from slipping between two segments.
    """
    after = np.roll(polygon, -1, axis=0)
    edges = after - polygon
    along = edges / np.hypot(edges[:, 0], edges[:, 1])[:, None]
    return np.concatenate([polygon - overlap * along, after + overlap * along], axis=1)
