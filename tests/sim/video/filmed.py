"""A film of two robots that drive, and what is in a file of it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import av
import numpy as np
from video_arenas import SQUARE

from sim.video import Backdrop, Snapshot
from sim.video.recorder import Recorder

GREEN, BLUE = 0x00FF00, 0x0000FF
SIZE = (320, 416)


def drive(time: float) -> np.ndarray:
    """Poses of two robots: one drives to the right, one upwards."""
    return np.array([[2 + 0.5 * time, 4.0, 0.0], [12.0, 3 + 0.5 * time, np.pi / 2]])


def film(path: Path, backdrop: Backdrop, seconds: float = 20.0, **options: object) -> Recorder:
    """A video of that many simulated seconds, with a snapshot every 0.1 s as in a run."""
    with Recorder(path, backdrop, **({"size": SIZE} | options)) as recorder:  # type: ignore[arg-type]
        recorder.add_robot("r1", SQUARE)
        recorder.add_robot("r2", 0.5)
        for tick in range(round(seconds * 10) + 1):
            time = tick * 0.1
            if recorder.wants(time):
                recorder.frame(Snapshot(time, drive(time), [GREEN, BLUE], 0.25))
    return recorder


def decoded(path: Path) -> Iterator[np.ndarray]:
    with av.open(str(path)) as container:
        for frame in container.decode(video=0):
            yield frame.to_ndarray(format="bgr24")


def place_of(recorder: Recorder, image: np.ndarray, channel: int) -> np.ndarray:
    """The middle, in metres, of the pixels in which one colour channel stands out."""
    others = [c for c in range(3) if c != channel]
    strong = image[..., channel].astype(int) - image[..., others].max(axis=2) > 60
    rows, columns = np.nonzero(strong)
    p = recorder.picture.projection
    left, right = columns.min(), columns.max() + 1
    top, bottom = rows.min(), rows.max() + 1
    return np.array([((left + right) / 2 - p.left), p.bottom - (top + bottom) / 2]) / p.scale
