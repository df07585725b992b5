"""Stages for tests, and the tests' own geometry: overlaps by clipping, not by separating axes."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from sim.stage.layout import Layout, build_layout
from sim.stage.stage import Stage
from sim.worldfile.schema import World


def world(**keys: Any) -> World:
    """A world of 10 x 10 m unless told otherwise; lists stand for the schema's tuples."""

    def tuples(value: Any) -> Any:
        if isinstance(value, list | tuple):
            return tuple(tuples(item) for item in value)
        if isinstance(value, dict):
            return {key: tuples(item) for key, item in value.items()}
        return value

    return World.model_validate(tuples({"size": (10.0, 10.0), **keys}))


def robot(shape: str = "box", drive: dict[str, Any] | None = None, **body: Any) -> dict[str, Any]:
    """A model: a body of half a metre and a drive."""
    size = {
        "box": {"size": (0.5, 0.4)},
        "circle": {"radius": 0.25},
        "polygon": {"points": ((0.3, 0.0), (-0.2, 0.25), (-0.2, -0.25))},
    }[shape]
    made: dict[str, Any] = {"body": {"shape": shape, **size, **body}}
    made["drive"] = {"kind": "differential", **(drive or {})}
    return made


def set_up(**keys: Any) -> tuple[Layout, Stage]:
    """A layout, and a stage without robots."""
    made = world(**keys)
    layout = build_layout(made, Path())
    return layout, Stage(layout, made.models, made.clock)


def corners(body: Any, pose: Any) -> np.ndarray:
    """Corners (k, 2) of a body at a pose; a circle as 48 points on it.

    The chords lie within the circle by less than 0.6 mm for a radius of 0.25 m.
    """
    if body.shape == "circle":
        turn = np.arange(48) * math.tau / 48
        own = body.radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    elif body.shape == "box":
        a, b = body.size[0] / 2, body.size[1] / 2
        own = np.array([[-a, -b], [a, -b], [a, b], [-a, b]])
    else:
        own = np.array(body.points)
    z = (own[:, 0] + 1j * own[:, 1]) * np.exp(1j * pose[2]) + complex(pose[0], pose[1])
    return np.stack([z.real, z.imag], axis=1)


def clipped(subject: np.ndarray, clip: np.ndarray) -> np.ndarray:
    """The common part of two convex counter-clockwise polygons (Sutherland and Hodgman 1974)."""
    points = [tuple(point) for point in subject]
    for (ax, ay), (bx, by) in zip(clip, np.roll(clip, -1, axis=0), strict=True):
        kept: list[tuple[float, float]] = []
        sides = [(bx - ax) * (y - ay) - (by - ay) * (x - ax) for x, y in points]
        for i, point in enumerate(points):
            before, side = points[i - 1], sides[i]
            if (sides[i - 1] > 0) != (side > 0):
                part = sides[i - 1] / (sides[i - 1] - side)
                kept.append(
                    (
                        before[0] + part * (point[0] - before[0]),
                        before[1] + part * (point[1] - before[1]),
                    )
                )
            if side > 0:
                kept.append(point)
        points = kept
        if not points:
            break
    return np.array(points).reshape(-1, 2)


def overlap(one: np.ndarray, two: np.ndarray) -> float:
    """How far two convex polygons overlap: the least width of their common part, 0 if none.

    The least shift that parts two bodies is at least the width of what they share, and equal to
    it for a face against a face or a corner in a face, which is how bodies touch.
    """
    common = clipped(one, two)
    if len(common) < 3:
        return 0.0
    edges = np.concatenate([one - np.roll(one, 1, axis=0), two - np.roll(two, 1, axis=0)])
    normals = np.stack([edges[:, 1], -edges[:, 0]], axis=1)
    normals /= np.hypot(normals[:, 0], normals[:, 1])[:, None]
    return float(np.ptp(common @ normals.T, axis=0).min())


def deepest(stage: Stage, bodies: list[Any]) -> float:
    """The largest overlap between any two robots, and between robots and what stands."""
    poses = np.concatenate([stage.poses, stage.movable_poses])
    outlines = [corners(body, pose) for body, pose in zip(bodies, poses, strict=True)]
    lows = np.array([outline.min(axis=0) for outline in outlines])
    highs = np.array([outline.max(axis=0) for outline in outlines])
    solids = [solid.vertices for solid in stage.layout.solids]
    worst = 0.0
    for i, outline in enumerate(outlines):
        near = np.nonzero(np.all((lows[:i] <= highs[i]) & (highs[:i] >= lows[i]), axis=1))[0]
        others = [outlines[j] for j in near.tolist()] + [
            vertices
            for vertices in solids
            if np.all(vertices.min(axis=0) <= highs[i]) and np.all(vertices.max(axis=0) >= lows[i])
        ]
        worst = max([worst, *(overlap(outline, other) for other in others)])
    return worst
