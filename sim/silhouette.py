"""The outline by which a body is drawn: of all its parts together."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from sim.stage.geometry import Floats, counter_clockwise, faces, hull_of, outline

FINE = 600
"""Cells along the longer side of the raster on which parts that overlap are joined."""


@lru_cache(maxsize=1024)
def silhouette(body: Any) -> Floats:
    """Corners (k, 2) of a body of the schema that is no circle, counter-clockwise in its frame.

    Where several parts overlap, to a 600th of the body's length; of parts that do not hang
    together the convex hull.
    """
    if body.shape != "compound":
        return outline(body)
    parts = [face.vertices for face in faces(body)]
    if len(parts) == 1:
        return parts[0]
    import cv2  # noqa: PLC0415 - loaded for pictures alone

    low = np.concatenate(parts).min(axis=0)
    span = float(np.ptp(np.concatenate(parts), axis=0).max())
    cells = np.zeros((FINE + 3, FINE + 3), np.uint8)
    for part in parts:
        corners = np.rint((part - low) * (FINE / span)).astype(np.int32) + 1
        cv2.fillPoly(cells, [corners], 255)
    found, _ = cv2.findContours(cells, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    if len(found) != 1:
        return hull_of(body)
    edge = cv2.approxPolyDP(found[0], 0.8, True)[:, 0, :].astype(np.float64)
    return counter_clockwise((edge - 1.0) * (span / FINE) + low)
