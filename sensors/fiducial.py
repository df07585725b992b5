"""The fiducial finder: ids and relative poses of marked things in sight.

A thing is in sight if its centre (the origin of its own frame) lies within range and fov, and the
straight line there meets nothing else before: neither the robot itself nor the thing seen is in
the way.
"""

import math
from functools import lru_cache
from typing import Self

import numpy as np
import numpy.typing as npt
from pydantic import model_validator

from sensors.compiled import compiled
from sensors.grid import Floats, Ints
from sensors.rays import cast
from sensors.readings import FIDUCIAL, Fiducials
from sensors.registry import sensor
from sensors.settings import Count, Number, SensorSettings, check_min_range, setting
from sensors.view import View

Ids = npt.NDArray[np.int32]


class FiducialSettings(SensorSettings):
    """The defaults are those of Stage."""

    range: Number = setting(8.0, gt=0, unit="m", description="how far it sees")
    min_range: Number = setting(
        0.0, ge=0, unit="m", description="what is nearer than that it does not see"
    )
    id_range: Number | None = setting(
        None,
        gt=0,
        unit="m",
        description="how far it reads ids: beyond, a mark has the id 0; null: as far as it sees",
    )
    fov: Number = setting(180.0, gt=0, le=360, unit="deg", description="how wide it sees")
    ids: tuple[Count, ...] = setting(
        (), unit="ids", description="the ids it looks for; empty: all of them"
    )

    @model_validator(mode="after")
    def _sees_something(self) -> Self:
        check_min_range(self.min_range, self.range)
        return self


def _empty(settings: FiducialSettings, n: int) -> Fiducials:
    return Fiducials.empty(n, math.radians(settings.fov), settings.range)


@lru_cache(maxsize=256)
def _looked_for(ids: tuple[int, ...]) -> Ids:
    return np.array(ids, np.int32)


@sensor("fiducial", kind="fiducials", settings=FiducialSettings, readings=_empty)
def sense_fiducials(settings: FiducialSettings, view: View, readings: Fiducials) -> None:
    """Ids and relative poses of marked things in sight."""
    scene = view.scene
    marked = np.flatnonzero((scene.fiducials != 0) & ~scene.hidden & scene.sees(view.eye, view.z))
    if settings.ids:
        marked = marked[np.isin(scene.fiducials[marked], _looked_for(settings.ids))]
    pairs = np.empty((16 + 4 * len(view.rows), 2), np.int64)
    lines = np.empty((len(pairs), 4))
    while True:
        count = _candidates(
            scene.poses,
            marked,
            view.origins,
            view.entities,
            view.rows,
            readings.fov,
            settings.range,
            pairs,
            lines,
        )
        if count <= len(pairs):
            break
        pairs, lines = np.empty((count, 2), np.int64), np.empty((count, 4))
    rows, targets, distances = pairs[:count, 0], pairs[:count, 1], lines[:count, 3]
    readings.counts[view.rows] = 0
    if count == 0:
        return
    # One ray each, a little longer than the way, so that a thing whose edge is its centre is hit.
    ranges, hits = cast(
        scene,
        lines[:count, :3],
        view.entities[rows],
        0.0,
        1,
        1.01 * settings.range,
        seen=view.seen,
    )
    clear = (hits[:, 0] == targets) | (ranges[:, 0] >= distances)
    clear &= distances >= settings.min_range
    rows, targets, distances = rows[clear], targets[clear], distances[clear]
    if not len(rows):
        return
    order = np.lexsort((targets, distances, rows))
    rows, targets, distances = rows[order], targets[order], distances[order]
    counts = np.bincount(rows, minlength=len(readings.counts))
    readings.reserve(int(counts.max()))
    readings.counts[view.rows] = counts[view.rows]
    begin = np.cumsum(counts) - counts
    found = np.zeros(len(rows), FIDUCIAL)
    origins, poses = view.origins[rows], scene.poses[targets]
    cos, sin = np.cos(origins[:, 2]), np.sin(origins[:, 2])
    dx, dy = (poses - origins)[:, 0], (poses - origins)[:, 1]
    found["id"] = scene.fiducials[targets]
    if settings.id_range is not None:
        found["id"][distances > settings.id_range] = 0
    found["x"], found["y"] = cos * dx + sin * dy, cos * dy - sin * dx
    turn = poses[:, 2] - origins[:, 2]
    found["yaw"] = turn - 2.0 * np.pi * np.floor((turn + np.pi) / (2.0 * np.pi))
    readings.fiducials[rows, np.arange(len(rows)) - begin[rows]] = found


@compiled
def _candidates(
    poses: Floats,
    marked: Ints,
    origins: Floats,
    own: Ints,
    rows: Ints,
    fov: float,
    max_range: float,
    pairs: Ints,
    lines: Floats,
) -> int:
    """Find the pairs of a row and a marked entity within range and fov.

    Writes `pairs` (k, 2) row, entity, and `lines` (k, 4) the lines of sight: the sensor's x and y,
    the heading to the entity and the distance; as many as there is room for. Returns how many
    there are.
    """
    count = 0
    for j in rows:
        x, y, heading = origins[j, 0], origins[j, 1], origins[j, 2]
        for entity in marked:
            if entity == own[j]:
                continue
            dx, dy = poses[entity, 0] - x, poses[entity, 1] - y
            square = dx * dx + dy * dy
            if square > max_range * max_range:
                continue
            toward = math.atan2(dy, dx)
            bearing = toward - heading
            bearing -= 2.0 * math.pi * math.floor((bearing + math.pi) / (2.0 * math.pi))
            if abs(bearing) > 0.5 * fov + 1e-12:  # 1e-12: rounding of the bearing at the very side
                continue
            if count < pairs.shape[0]:
                pairs[count, 0], pairs[count, 1] = j, entity
                lines[count, 0], lines[count, 1] = x, y
                lines[count, 2], lines[count, 3] = toward, math.sqrt(square)
            count += 1
    return count
