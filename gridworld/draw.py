"""Pictures and videos of a run on the grid, as the paper's figures 5 and 6 draw it.

Walls are blue blocks, active robots arrows in their primary direction (dots, while they have not
moved), settled ones diamonds; a door has a red frame.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from gridworld.grid import NO_LIMIT, GridRun

Image = NDArray[np.uint8]
"""(height, width, 3), red, green, blue."""

WALL_COLOR = (58, 92, 168)
FLOOR_COLOR = (255, 255, 255)
GRID_COLOR = (222, 222, 222)
ACTIVE_COLOR = (196, 60, 30)
SETTLED_COLOR = (60, 140, 80)
DOOR_COLOR = (225, 30, 40)

_LARGEST = 960  # pixels of the longer side, if a cell then is at least one pixel
_FRAMES_PER_SECOND = 30
_MOST_FRAMES = 3600  # two minutes; of a longer run every second step is shown, or third, ...

_WALL, _EMPTY, _ARROW, _DOT, _DIAMOND = 0, 1, 2, 6, 7
_DOOR = 8  # added to the others


class DrawError(Exception):
    """A picture or video that cannot be written."""


def record(
    run: GridRun,
    *,
    max_steps: int | None = None,
    picture: str | Path | None = None,
    at: int | None = None,
    film: str | Path | None = None,
) -> None:
    """Do a run's steps to its end, or to step `max_steps`, and draw on the way.

    `picture` is a PNG of the end of step `at` (or of the last step, if the run is shorter), `film`
    an MP4 of all steps. Raises DrawError.
    """
    limit = NO_LIMIT if max_steps is None else max_steps
    pause = limit if at is None else min(at, limit)
    if film is None:
        run.advance(pause - run.steps)
        if picture is not None:
            write_picture(picture, Painter(run).draw(run))
        run.advance(limit - run.steps)
        return
    painter = Painter(run)
    image = painter.draw(run)
    stride = -(-2 * run.region.cells // _MOST_FRAMES)
    with video(film, (image.shape[1], image.shape[0])) as writer:
        writer.write(image)
        for end in (pause, limit):
            while run.steps < end and run.advance(min(stride, end - run.steps)):
                writer.write(painter.draw(run))
            image = painter.draw(run)
            if picture is not None and end == pause:
                write_picture(picture, image)
        writer.write(image)


class Painter:
    """Draws the states of runs in one region at one scale."""

    def __init__(self, run: GridRun, pixels: int | None = None) -> None:
        """`pixels` per cell: by default as many as make a handy picture."""
        rows, columns = run.region.rows + 2, run.region.columns + 2  # with a frame of walls
        self.pixels = pixels or max(1, min(32, _LARGEST // max(rows, columns)))
        self._shape = (rows, columns)
        self._tiles = _tiles(self.pixels)
        background = np.zeros((rows, columns), np.uint8)
        background[1:-1, 1:-1] = np.where(run.region.free, _EMPTY, _WALL)
        self._background = background.ravel()

    def draw(self, run: GridRun) -> Image:
        """The state of `run` now."""
        kinds = self._background.copy()
        robots = np.arange(run.emitted)
        active = run.at_work
        kinds[run.position[robots]] = _DIAMOND
        headings = (run.state[active] >> 3) & 3
        kinds[run.position[active]] = np.where(run.moves[active] > 0, _ARROW + headings, _DOT)
        kinds[run.doors] += _DOOR
        tiles = self._tiles[kinds.reshape(self._shape)]
        height, width = (side * self.pixels for side in self._shape)
        return np.ascontiguousarray(tiles.transpose(0, 2, 1, 3, 4)).reshape(height, width, 3)


def write_picture(path: str | Path, image: Image) -> None:
    """Write a PNG. Raises DrawError."""
    cv2 = _opencv()
    done, data = cv2.imencode(".png", image[:, :, ::-1], [cv2.IMWRITE_PNG_COMPRESSION, 9])
    if not done:
        raise DrawError(f"{path}: the picture cannot be encoded")
    try:
        Path(path).write_bytes(data.tobytes())
    except OSError as error:
        raise DrawError(f"{path}: the picture cannot be written: {error.strerror}") from None


class VideoWriter(Protocol):
    """Takes the frames of a video one after the other."""

    def write(self, image: Image) -> None:
        """Add a frame."""


@contextmanager
def video(path: str | Path, size: tuple[int, int]) -> Iterator[VideoWriter]:
    """An MP4 of frames with `size` = (width, height), closed on leaving. Raises DrawError.

    H.264 by PyAV; where that cannot be imported, OpenCV's MPEG-4, which browsers do not play.
    """
    width, height = (side + side % 2 for side in size)  # H.264's colour planes are halved
    writer: _H264 | _Mpeg4
    try:
        import av  # noqa: PLC0415 - loaded only where a video is made
    except ImportError:
        writer = _Mpeg4(str(path), width, height)
    else:
        try:
            writer = _H264(av, str(path), width, height)
        except (OSError, ValueError) as error:
            raise DrawError(f"{path}: the video cannot be written: {error}") from None
    try:
        yield writer
    finally:
        writer.close()


class _H264:
    def __init__(self, av: Any, path: str, width: int, height: int) -> None:
        self._av = av
        self._container = av.open(path, "w", format="mp4")
        self._stream = self._container.add_stream("libx264", rate=Fraction(_FRAMES_PER_SECOND))
        self._stream.width, self._stream.height = width, height
        self._stream.pix_fmt = "yuv420p"
        self._stream.options = {"preset": "veryfast", "crf": "20"}

    def write(self, image: Image) -> None:
        frame = self._av.VideoFrame.from_ndarray(
            _padded(image, self._stream.width, self._stream.height), format="rgb24"
        )
        self._container.mux(self._stream.encode(frame))

    def close(self) -> None:
        self._container.mux(self._stream.encode(None))
        self._container.close()


class _Mpeg4:
    def __init__(self, path: str, width: int, height: int) -> None:
        cv2 = _opencv()
        self._size = (width, height)
        code = cv2.VideoWriter_fourcc(*"mp4v")
        self._writer = cv2.VideoWriter(path, code, _FRAMES_PER_SECOND, self._size)
        if not self._writer.isOpened():
            raise DrawError(f"{path}: the video cannot be written")

    def write(self, image: Image) -> None:
        self._writer.write(np.ascontiguousarray(_padded(image, *self._size)[:, :, ::-1]))

    def close(self) -> None:
        self._writer.release()


def _padded(image: Image, width: int, height: int) -> Image:
    extra = ((0, height - image.shape[0]), (0, width - image.shape[1]), (0, 0))
    return np.ascontiguousarray(np.pad(image, extra, mode="edge"))


def _opencv() -> Any:
    try:
        import cv2  # noqa: PLC0415 - loaded only where a picture is made
    except ImportError as error:
        raise DrawError(f"pictures need OpenCV (opencv-python-headless): {error}") from None
    return cv2


def _tiles(pixels: int) -> NDArray[np.uint8]:
    """(16, pixels, pixels, 3): a picture of one cell for each kind."""
    cv2 = _opencv()
    scale = 8  # drawn larger, then reduced: smooth edges
    size = pixels * scale
    tiles = np.empty((16, pixels, pixels, 3), np.uint8)
    arrow = np.array([[0, -0.42], [0.34, 0.04], [0.12, 0.04], [0.12, 0.4]])
    arrow = np.concatenate([arrow, arrow[::-1] * [-1, 1]])
    diamond = np.array([[0, -0.38], [0.38, 0], [0, 0.38], [-0.38, 0]])
    for kind in range(16):
        what = kind % _DOOR
        large = np.empty((size, size, 3), np.uint8)
        large[:] = WALL_COLOR if what == _WALL else FLOOR_COLOR
        if what != _WALL and pixels >= 6:
            line = scale * max(1, pixels // 24)
            cv2.rectangle(large, (0, 0), (size - 1, size - 1), GRID_COLOR, line)
        color = SETTLED_COLOR if what == _DIAMOND else ACTIVE_COLOR
        if what >= _ARROW and pixels < 4:
            large[:] = color
        elif what == _DOT:
            cv2.circle(large, (size // 2, size // 2), size * 3 // 10, color, -1)
        elif what >= _ARROW:
            shape = diamond
            if what < _DOT:
                shape = arrow
                for _ in range(what - _ARROW):  # a quarter turn clockwise, y downwards
                    shape = shape[:, ::-1] * [-1, 1]
            cv2.fillPoly(large, [np.rint((shape + 0.5) * size).astype(np.int32)], color)
        if kind >= _DOOR:
            line = 2 * scale * max(1, pixels // 12)
            cv2.rectangle(large, (0, 0), (size - 1, size - 1), DOOR_COLOR, line)
        tiles[kind] = cv2.resize(large, (pixels, pixels), interpolation=cv2.INTER_AREA)
    return tiles
