"""Pictures and videos of a run on the grid: its steps, drawn on the way."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import cv2

from gridworld.draw import cells_of, entries_of, limit_of, stride_of
from gridworld.grid import GridRun
from sim.video.cells import CellPicture
from sim.video.encode import Encoder, open_encoder
from sim.video.errors import VideoError
from sim.video.target import check_target

FRAMES_PER_SECOND = 30


def record(
    run: GridRun,
    *,
    max_steps: int | None = None,
    picture: str | Path | None = None,
    at: int | None = None,
    film: str | Path | None = None,
    rule: str = "",
) -> None:
    """Do a run's steps to its end, or to step `max_steps`, and draw on the way.

    `picture` is a PNG or SVG of the end of step `at` (or of the last step, if the run is shorter),
    `film` an MP4 of all steps; `rule` is named in both. Raises VideoError.
    """
    limit = limit_of(max_steps)
    pause = limit if at is None else min(at, limit)
    if picture is None and film is None:
        run.advance(limit - run.steps)
        return
    shows = picture_of(run, rule)
    if film is None:
        run.advance(pause - run.steps)
        if picture is not None:
            write_picture(picture, shows, run)
        run.advance(limit - run.steps)
        return
    target, title = check_target(film), run.region.source or ""
    encoder, _ = open_encoder(target, shows.size, FRAMES_PER_SECOND, title)
    try:
        _film(run, shows, encoder, pause, limit, picture)
    except OSError as error:
        with suppress(VideoError, OSError):
            encoder.close()
        raise VideoError(f"{film}: the video ends early: {error.strerror or error}") from None
    except BaseException:
        encoder.close()
        raise
    encoder.close()


def picture_of(run: GridRun, rule: str = "", pixels: int | None = None) -> CellPicture:
    """A picture that the moments of a run can be drawn in; `pixels` per cell."""
    name = Path(run.region.source).stem if run.region.source else ""
    return CellPicture(cells_of(run).shape, rule, name, pixels)


def write_picture(path: str | Path, picture: CellPicture, run: GridRun) -> None:
    """Write the moment that a run is at as PNG or SVG. Raises VideoError."""
    path, cells, entries = Path(path), cells_of(run), entries_of(run)
    if path.suffix.lower() == ".svg":
        data = picture.svg(cells, entries).encode()
    else:
        image = picture.draw(cells, entries)
        done, pixels = cv2.imencode(".png", image, [cv2.IMWRITE_PNG_COMPRESSION, 9])
        if not done:
            raise VideoError(f"{path}: the picture cannot be encoded")
        data = pixels.tobytes()
    try:
        path.write_bytes(data)
    except OSError as error:
        raise VideoError(f"{path}: the picture cannot be written: {error.strerror}") from None


def _film(
    run: GridRun,
    shows: CellPicture,
    encoder: Encoder,
    pause: int,
    limit: int,
    picture: str | Path | None,
) -> None:
    """Write a frame of the beginning, of every step or every second one, ..., and of the end."""

    def frame() -> None:
        encoder.write(shows.draw(cells_of(run), entries_of(run)), 1)

    frame()
    stride = stride_of(run)
    for end in (pause, limit):
        while run.steps < end and run.advance(min(stride, end - run.steps)):
            frame()
        if picture is not None and end == pause:
            write_picture(picture, shows, run)
    frame()
