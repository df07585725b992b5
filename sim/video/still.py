"""The picture of one moment of a run, with the trails that led there."""

from __future__ import annotations

import math
from pathlib import Path

from sim.video.errors import VideoError
from sim.video.layers import SHOWN, Layer
from sim.video.picture import ENDINGS, Picture, save_picture
from sim.video.projection import default_size
from sim.video.snapshot import Backdrop, Shape, Snapshot
from sim.video.target import check_target

LONG_SIDE = 1200
"""Pixels of a picture's longer side where no size is asked for: for paper rather than a screen."""
PACE = 0.4
"""Simulated seconds between the points of a trail, as in a video at its default speed."""


class Still:
    """Takes one picture: of the first snapshot at or after `at` seconds, or of the run's end."""

    def __init__(
        self,
        path: Path | str,
        backdrop: Backdrop,
        *,
        at: float | None = None,
        size: tuple[int, int] | None = None,
        show: frozenset[Layer] = SHOWN,
    ) -> None:
        """Raises VideoError for a path, moment or size that cannot be."""
        if at is not None and not (math.isfinite(at) and at >= 0):
            raise VideoError(f"picture at {at:g}: must be 0 or more simulated seconds")
        check_target(path, endings=ENDINGS, what="picture")
        self._at = math.inf if at is None else at
        size = default_size(backdrop.size, LONG_SIDE) if size is None else size
        self.path = Path(path)
        self.picture = Picture(backdrop, size, show=show, axes=True)
        self._marks = 0
        self.taken = False
        """Whether there is nothing more to be done."""
        self.error: str | None = None
        """Why there is no picture, None while all is well."""
        self.time: float | None = None
        """The simulated seconds that the picture shows, None before it is taken."""

    def add_robot(self, name: str, shape: Shape) -> int:
        """Adds a robot by its outline (k, 2) m in its own frame, or its radius; its index."""
        return self.picture.add_robot(name, shape)

    def wants(self, time: float) -> bool:
        """Whether a snapshot of this simulated time (s) is of use."""
        due = time >= self._at - 1e-9 or time >= self._marks * PACE - 1e-9
        return due and not self.taken

    def take(self, snapshot: Snapshot, *, last: bool = False) -> None:
        """Keeps where the robots are, and takes the picture if the moment has come, or the last."""
        if self.taken:
            return
        if snapshot.time < self._at - 1e-9 and not last:
            self._marks = math.floor(snapshot.time / PACE + 1e-6) + 1
            self.picture.composer.mark(snapshot.time, snapshot.poses)
            return
        self.taken = True
        try:
            save_picture(self.path, self.picture, snapshot)
            self.time = snapshot.time
        except VideoError as error:
            self.error = str(error)
