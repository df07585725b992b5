"""Troupe, a 2D physics simulator for teams of mobile robots: the command line, and `run`."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from troupe._packages import claim_names

if TYPE_CHECKING:
    from sim.result import Result
    from troupe.log import Log

__version__ = "0.1.0"
__all__ = ["Log", "__version__", "run"]

claim_names()


def run(
    world: str | Path,
    *,
    seed: int | None = None,
    duration: float | None = None,
    settings: Sequence[str] = (),
    realtime: float | None = None,
    listen: tuple[str, int] | None = None,
    patience: float = 60.0,
    video: str | Path | None = None,
    video_fps: float | None = None,
    video_speed: float | None = None,
    video_size: tuple[int, int] | None = None,
    log: str | Path | None = None,
    log_sensors: Sequence[str] | None = None,
    say: Callable[[str], None] | None = None,
) -> Result:
    """Run a world and give its result, as `troupe run` does.

    Args:
        world: a world file, or the name of a world that comes with Troupe.
        seed: all that is random follows from it; the world file's unless given.
        duration: simulated seconds at most; the world file's unless given.
        settings: changes to the world file, such as `["clock.interval=0.05"]`.
        realtime: simulated seconds per wall-clock second; as fast as possible unless given.
        listen: (host, port) where Player clients can connect.
        patience: wall-clock seconds that a controller may keep the others waiting.
        video: an MP4 file to be made, with frames per second, simulated seconds per second of
            video, and width and height in pixels if they are to be other than the defaults.
        log: an MCAP file in which the run is kept, see docs/logs.md; the world file's unless given.
        log_sensors: the types of sensors whose readings it keeps as well, or `["all"]`.
        say: called with every line meant for people: the controllers' output, and what goes
            wrong with them. Nothing is printed unless given.

    A video or log that could not be written to its end, for want of room say, is a RuntimeWarning:
    the result is none the worse for it.

    Raises:
        sim.worldfile.WorldError: the world file has mistakes; all of them are in it.
        FileNotFoundError: there is no such world.
        sim.video.errors.VideoError: the video cannot be made.
        sim.log.errors.LogError: the log cannot be written.
        ValueError: a number is out of range.
    """
    from troupe.running import run_file  # noqa: PLC0415 - `import troupe` stays light

    done = run_file(
        world,
        seed=seed,
        duration=duration,
        settings=settings,
        realtime=realtime,
        listen=listen,
        patience=patience,
        video=video,
        video_fps=video_fps,
        video_speed=video_speed,
        video_size=video_size,
        log=log,
        log_sensors=log_sensors,
        say=say or (lambda line: None),
    )
    if done.video_error is not None:
        warnings.warn(done.video_error, RuntimeWarning, stacklevel=2)
    if done.log_error is not None:
        warnings.warn(done.log_error, RuntimeWarning, stacklevel=2)
    return done.result


def __getattr__(name: str) -> object:
    """`troupe.Log`, loaded when it is first asked for."""
    if name == "Log":
        from troupe.log import Log  # noqa: PLC0415 - `import troupe` stays light

        return Log
    raise AttributeError(f"module 'troupe' has no attribute {name!r}")
