"""The video of a run: frames at even steps of simulated time, encoded while the run goes on."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Self

from sim.video.encode import open_encoder
from sim.video.errors import VideoError
from sim.video.layers import SHOWN, Layer
from sim.video.picture import Picture
from sim.video.snapshot import Backdrop, Shape, Snapshot
from sim.video.target import check_target
from sim.video.writer import FrameWriter

FPS = 25.0
SPEED = 10.0
"""Simulated seconds per second of video: a Paint run of 150 s makes 15 s."""
SLOWEST, FASTEST = 0.01, 1e6
"""Simulated seconds per second of video. Slower, and a tick of 0.1 s would stand still for ten
seconds of video; faster, and a run of ten days would be one frame."""
SPEECH_SECONDS = 3.0
"""Seconds of video that a balloon stays."""


class Recorder:
    """Makes one video. Frame k shows the first snapshot at or after k * speed / fps.

    A snapshot that comes late, with several frames due, shows in all of them, so a second of
    video is always `speed` simulated seconds. After an error (a full disk) the run can go on
    as before: `frame` then does nothing, and `error` says what happened.
    """

    def __init__(
        self,
        path: Path | str,
        backdrop: Backdrop,
        *,
        fps: float = FPS,
        speed: float = SPEED,
        size: tuple[int, int] | None = None,
        show: frozenset[Layer] = SHOWN,
    ) -> None:
        """Opens the file; raises VideoError for a path, rate, speed or size that cannot be."""
        if not (math.isfinite(fps) and 1 <= fps <= 240):
            raise VideoError(f"video fps {fps:g}: must be 1 to 240 frames a second")
        if not (math.isfinite(speed) and SLOWEST <= speed <= FASTEST):
            allowed = f"{SLOWEST:g} to {FASTEST:g} simulated seconds a second"
            raise VideoError(f"video speed {speed:g}: must be {allowed}")
        self.path = Path(path)
        self.fps = float(fps)
        self.speed = float(speed)
        self.picture = Picture(
            backdrop, size, speech_time=SPEECH_SECONDS * speed, show=show, film_speed=self.speed
        )
        target = check_target(self.path)
        width, height = self.picture.size
        encoder, self.notice = open_encoder(target, (width, height), self.fps, backdrop.title)
        """`notice`: a line for the user, None where there is nothing to say."""
        self._writer = FrameWriter(encoder, (height, width, 3))
        self._frames = 0
        self._last_time = -math.inf
        self._closed = False

    @property
    def frames(self) -> int:
        """Frames of video so far."""
        return self._frames

    @property
    def error(self) -> str | None:
        """Why the video is incomplete, None while all is well."""
        error = self._writer.error
        if error is None:
            return None
        reason = getattr(error, "strerror", None) or str(error)
        return f"{self.path}: the video ends early: {reason}"

    def add_robot(self, name: str, shape: Shape) -> int:
        """Adds a robot by its outline (k, 2) m in its own frame, or its radius; its index."""
        return self.picture.add_robot(name, shape)

    def wants(self, time: float) -> bool:
        """Whether a frame is due at this simulated time (s)."""
        return self._due(time) > self._frames and self._writer.error is None

    def frame(
        self,
        snapshot: Snapshot,
        *,
        last: bool = False,
        going_on: Callable[[], bool] = lambda: True,
    ) -> None:
        """Draws the snapshot into all frames due by its time; does nothing where none is.

        `last`: draws it even if none is due, unless it was drawn already, so that the video
        ends where the run ended. A slow film shows one snapshot in many frames, which may take long
        to encode: as soon as `going_on()` says no, those that do not wait yet are left out.
        """
        unseen = last and snapshot.time > self._last_time
        times = max(self._due(snapshot.time) - self._frames, int(unseen))
        if times <= 0 or self._closed or self._writer.error is not None:
            return
        image = self._writer.buffer()
        self.picture.draw(snapshot, out=image)
        self._frames += self._writer.put(image, times, going_on)
        self._last_time = snapshot.time

    def close(self) -> Path:
        """Completes the file and returns its path; a second call changes nothing."""
        if not self._closed:
            self._closed = True
            self._writer.close()
        return self.path

    def _due(self, time: float) -> int:
        """Frames that a video has when this simulated time is reached."""
        # Ticks are sums of floats: a millionth of a frame early counts as due.
        return math.floor(time * self.fps / self.speed + 1e-6) + 1

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
