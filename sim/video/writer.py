"""A thread of its own that encodes frames while the run goes on.

Nobody else touches the encoder: signals reach the main thread only, and what their handlers raise
must never come out of the midst of a muxer.
"""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sim.video.encode import Encoder

WAITING = 8
"""Images that may wait for the encoder; the run waits when there are more (13 MB at 640x840)."""
REPEATS = 10
"""Frames of one image that wait as one: what must be encoded before anybody is listened to."""


class FrameWriter:
    """Takes frames and hands them to an encoder on another thread, in order.

    Frames come from a pool: ask for `buffer`, fill it, `put` it back. The first error stops
    the encoding, not the run: later frames are taken and dropped.
    """

    def __init__(self, encoder: Encoder, shape: tuple[int, int, int]) -> None:
        """`shape`: (height, width, 3) of the frames."""
        self._encoder = encoder
        self._shape = shape
        self._full: queue.Queue[tuple[NDArray[np.uint8], int, bool] | None] = queue.Queue(WAITING)
        self._free: queue.SimpleQueue[NDArray[np.uint8]] = queue.SimpleQueue()
        self._thread: threading.Thread | None = None
        self.error: Exception | None = None
        """What went wrong, None while all is well."""

    def buffer(self) -> NDArray[np.uint8]:
        """An image to draw in, with anything in it."""
        try:
            return self._free.get_nowait()
        except queue.Empty:
            return np.empty(self._shape, np.uint8)

    def put(
        self,
        image: NDArray[np.uint8],
        times: int = 1,
        going_on: Callable[[], bool] = lambda: True,
    ) -> int:
        """Queues a frame that shows `times` times; `image` is the writer's from now on.

        Asks `going_on()` between repeats and leaves out the rest where it says no. Returns how
        often the image is shown, at least once.
        """
        self._start()
        queued = 0
        while queued < times and (queued == 0 or (going_on() and self.error is None)):
            some = min(times - queued, REPEATS)
            queued += some
            self._full.put((image, some, queued >= times))
        return queued

    def close(self) -> None:
        """Encodes what waits and completes the file; afterwards `error` is final."""
        thread = self._start()
        self._full.put(None)
        thread.join()
        self._thread = None

    def _start(self) -> threading.Thread:
        if self._thread is None:
            # A daemon: a run that dies without closing the video must not hang on it.
            self._thread = threading.Thread(target=self._run, name="video", daemon=True)
            self._thread.start()
        return self._thread

    def _run(self) -> None:
        while (item := self._full.get()) is not None:
            image, times, done = item
            if self.error is None:
                try:
                    self._encoder.write(image, times)
                except Exception as error:
                    self.error = error
            if done:
                self._free.put(image)
        try:
            self._encoder.close()
        except Exception as error:
            self.error = self.error or error
