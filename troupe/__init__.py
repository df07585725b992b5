"""Troupe, a 2D physics simulator for teams of mobile robots: the command line, and `run`."""

from __future__ import annotations

from troupe.interrupts import heed_interrupts, is_the_command

if is_the_command():
    heed_interrupts()  # first of all: what follows takes a moment to load

import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from troupe._packages import claim_names

if TYPE_CHECKING:
    from sim.fleet.functions import Controllers
    from sim.result import Result
    from sim.worldfile import WorldError
    from troupe.log import Log, LogError
    from troupe.simulation import RunError, Simulation
    from troupe.sweep.collect import read_sweep
    from troupe.world import World
    from troupe.world import load_world as load

__version__ = "0.1.0"
__all__ = [
    "Log",
    "LogError",
    "RunError",
    "Simulation",
    "World",
    "WorldError",
    "__version__",
    "load",
    "read_sweep",
    "run",
]

claim_names()

_HOMES = {
    "Log": ("troupe.log", "Log"),
    "LogError": ("sim.log.errors", "LogError"),
    "RunError": ("troupe.simulation", "RunError"),
    "Simulation": ("troupe.simulation", "Simulation"),
    "World": ("troupe.world", "World"),
    "WorldError": ("sim.worldfile.mistakes", "WorldError"),
    "load": ("troupe.world", "load_world"),
    "read_sweep": ("troupe.sweep.collect", "read_sweep"),
}


def __getattr__(name: str) -> Any:
    """What is imported on first use: `import troupe` stays light."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module, known = _HOMES[name]
    return getattr(import_module(module), known)


def __dir__() -> list[str]:
    """What there is to be used, loaded or not yet."""
    return sorted(__all__)


def run(
    world: str | Path | Mapping[str, Any] | World,
    *,
    seed: int | None = None,
    duration: float | None = None,
    set: Mapping[str, Any] | Sequence[str] = (),
    realtime: float | None = None,
    free: bool = False,
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
    log: str | Path | None = None,
    log_sensors: Sequence[str] | None = None,
    report: str | Path | None = None,
    say: Callable[[str], None] | None = None,
    settings: Sequence[str] = (),
    controllers: Controllers = True,
    each_tick: Callable[[Simulation], object] | None = None,
    until: Callable[[Simulation], object] | None = None,
    trajectories: bool = False,
) -> Result:
    """Run a world and give its result, as `troupe run` does, by the names of its options.

    Args:
        world: a world file, the name of a world that comes with Troupe, a mapping, or a World.
        seed: all that is random follows from it; the world file's unless given.
        duration: simulated seconds at most; the world file's unless given.
        set: changes to the world file, such as `{"clock.interval": 0.05}`, or texts as on the
            command line, `["clock.interval=0.05"]`.
        realtime: simulated seconds per wall-clock second; as fast as possible unless given.
        free: nobody waits for Player clients from outside: the world runs on by itself, in real
            time unless `realtime` says otherwise.
        listen: where Player clients can connect, as `"127.0.0.1:6665"` or (host, port).
        patience: wall-clock seconds that a controller may keep the others waiting, and twice
            that until its first request; 0: for ever.
        fail_fast: the first controller that fails ends the run.
        video: an MP4 file to be made, with frames per second, simulated seconds per second of
            video, and width and height in pixels, as `"640x840"` or (640, 840), if they are to be
            other than the defaults.
        video_show: what it shows besides bodies and paint: some of fans, names, trails, speech and
            blobs (all but blobs unless given). It holds for the picture too, as does the size.
        picture: a PNG or SVG file to be made of one moment.
        at: the picture's moment in simulated seconds; the end of the run unless given.
        log: an MCAP file in which the run is kept, see docs/logs.md; the world file's unless given.
        log_sensors: the types of sensors whose readings it keeps as well, or `["all"]`.
        report: an HTML file that is made of what came out, see docs/logs.md.
        say: called with every line meant for people: the controllers' output, and what goes
            wrong with them. Nothing is printed unless given.
        settings: more texts like those of `set`.
        controllers: as for `Simulation`: True for those of the world, False for none, or functions
            by the controllers' names.
        each_tick: called with the simulation after every tick: ask it, command robots.
        until: likewise; the run is completed when it returns something true.
        trajectories: the result gets `times` (ticks,) and `poses` (ticks, n, 3).

    SIGINT (Ctrl-C, a notebook's stop), SIGTERM and SIGHUP end the run in order once it has begun:
    the result so far comes back with the outcome `interrupted`. A controller that fails raises
    nothing: `result.outcome` and `result.robot(name).error` tell.

    A video, picture, log or report that could not be written to its end, for want of room say, is a
    RuntimeWarning: the result is none the worse for it.

    Raises:
        sim.worldfile.WorldError: there is no such world, or it has mistakes; all of them are in it.
        sim.video.errors.VideoError: the video cannot be made.
        sim.log.errors.LogError: the log cannot be written.
        ValueError: an argument is out of range, or no address or size.
        OSError: the address cannot be had, or no process can be made.
        RunError: a hook or a controller function has raised; the error has the result so far.
        KeyboardInterrupt: on Ctrl-C before the run has begun, or on a second one.
    """
    from sim.fleet.functions import FunctionError  # noqa: PLC0415
    from troupe.hooks import Hooks  # noqa: PLC0415
    from troupe.running import run_file  # noqa: PLC0415 - `import troupe` stays light
    from troupe.setting import as_text  # noqa: PLC0415

    hooks = Hooks(each_tick, until, trajectories)
    try:
        done = run_file(
            world,
            seed=seed,
            duration=duration,
            settings=[*as_text(set), *as_text(settings)],
            realtime=realtime,
            free=free,
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
            log=log,
            log_sensors=log_sensors,
            report=report,
            say=say or (lambda line: None),
            controllers=controllers,
            each_tick=hooks.each_tick if hooks.wanted else None,
        )
    except FunctionError as error:
        if error.result is None:
            raise
        from troupe.simulation import RunError  # noqa: PLC0415

        raise RunError(str(error), error.result) from error.__cause__
    hooks.finish(done.result)
    for lacking in (done.video_error, done.log_error, done.report_error):
        if lacking is not None:
            warnings.warn(lacking, RuntimeWarning, stacklevel=2)
    return done.result
