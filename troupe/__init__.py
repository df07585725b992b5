"""Troupe, a 2D physics simulator for teams of mobile robots: the command line, and `run`."""

from __future__ import annotations

from troupe.interrupts import heed_interrupts, is_the_command

if is_the_command():
    heed_interrupts()  # first of all: what follows takes a moment to load

import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from troupe._packages import claim_names

if TYPE_CHECKING:
    from sim.result import Result
    from troupe.sweep.collect import read_sweep

__version__ = "0.1.0"
__all__ = ["__version__", "read_sweep", "run"]

claim_names()


def run(
    world: str | Path,
    *,
    seed: int | None = None,
    duration: float | None = None,
    set: Mapping[str, Any] | Sequence[str] = (),
    realtime: float | None = None,
    listen: str | tuple[str, int] | None = None,
    patience: float = 60.0,
    fail_fast: bool = False,
    video: str | Path | None = None,
    video_fps: float | None = None,
    video_speed: float | None = None,
    video_size: str | tuple[int, int] | None = None,
    video_show: Iterable[str] | None = None,
    picture: str | Path | None = None,
    at: float | None = None,
    say: Callable[[str], None] | None = None,
    settings: Sequence[str] = (),
) -> Result:
    """Run a world and give its result, as `troupe run` does, by the names of its options.

    Args:
        world: a world file, or the name of a world that comes with Troupe.
        seed: all that is random follows from it; the world file's unless given.
        duration: simulated seconds at most; the world file's unless given.
        set: changes to the world file, such as `{"clock.interval": 0.05}`, or texts as on the
            command line, `["clock.interval=0.05"]`.
        realtime: simulated seconds per wall-clock second; as fast as possible unless given.
        listen: where Player clients can connect, as `"127.0.0.1:6665"` or (host, port).
        patience: wall-clock seconds that a controller may keep the others waiting, and twice
            that until its first request; 0: for ever.
        fail_fast: the first controller that fails ends the run.
        video: an MP4 file to be made, with frames per second, simulated seconds per second of
            video, and width and height in pixels, as `"640x840"` or (640, 840), if they are to be
            other than the defaults.
        video_show: what it shows besides bodies and paint: some of fans, names, trails, speech and
            blobs (all but blobs unless given). It holds for the picture too, as does the size.
        picture: a PNG or SVG file to be made of one moment: `at` so many simulated seconds, or at
            the end of the run.
        say: called with every line meant for people: the controllers' output, and what goes
            wrong with them. Nothing is printed unless given.
        settings: more texts like those of `set`.

    SIGINT (Ctrl-C, a notebook's stop), SIGTERM and SIGHUP end the run in order once it has begun:
    the result so far comes back with the outcome `interrupted`. A controller that fails raises
    nothing: `result.outcome` and `result.robot(name).error` tell.

    A video or picture that could not be written to its end, for want of room say, is a
    RuntimeWarning: the result is none the worse for it.

    Raises:
        sim.worldfile.WorldError: there is no such world, or it has mistakes; all of them are in it.
        sim.video.errors.VideoError: the video cannot be made.
        ValueError: an argument is out of range, or no address or size.
        OSError: the address cannot be had, or no process can be made.
        KeyboardInterrupt: on Ctrl-C before the run has begun, or on a second one.
    """
    from troupe.running import as_text, run_file  # noqa: PLC0415 - `import troupe` stays light

    done = run_file(
        world,
        seed=seed,
        duration=duration,
        settings=[*as_text(set), *as_text(settings)],
        realtime=realtime,
        listen=listen,
        patience=patience,
        fail_fast=fail_fast,
        video=video,
        video_fps=video_fps,
        video_speed=video_speed,
        video_size=video_size,
        video_show=video_show,
        picture=picture,
        at=at,
        say=say or (lambda line: None),
    )
    if done.video_error is not None:
        warnings.warn(done.video_error, RuntimeWarning, stacklevel=2)
    return done.result


def __getattr__(name: str) -> object:
    """`troupe.read_sweep`, loaded when it is first asked for."""
    if name == "read_sweep":
        from troupe.sweep.collect import read_sweep  # noqa: PLC0415 - `import troupe` stays light

        return read_sweep
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
