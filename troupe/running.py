"""From a world's name and options to a run: what `troupe run` and `troupe.run` share."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sim.fleet.fleet import Fleet
from troupe.usage import UsageError

if TYPE_CHECKING:
    from sim.engine import Engine, Settings
    from sim.log.recorder import Recorder
    from sim.result import Result
    from sim.worldfile import LoadedWorld

EachTick = Callable[["Engine"], None]


@dataclass(frozen=True)
class Run:
    """What came out of a run. Errors say why there is no whole video or log, where one was due."""

    result: Result
    video_error: str | None
    log_error: str | None = None
    log: Path | None = None


def run_file(
    world: str | Path,
    *,
    seed: int | None,
    duration: float | None,
    settings: Sequence[str],
    realtime: float | None,
    listen: tuple[str, int] | None,
    patience: float,
    video: str | Path | None,
    video_fps: float | None,
    video_speed: float | None,
    video_size: tuple[int, int] | None,
    say: Callable[[str], None],
    log: str | Path | None = None,
    log_sensors: Sequence[str] | None = None,
    each_tick: EachTick | None = None,
) -> Run:
    """Run a world file; see `troupe.run`. `each_tick(engine)` is called after every tick.

    Raises UsageError for an argument that cannot be.
    """
    for name, value in (("duration", duration), ("realtime", realtime), ("patience", patience)):
        if value is not None and not (math.isfinite(value) and value > 0):
            raise UsageError(f"{name}: must be above 0 (given: {value:g})")
    if seed is not None and not 0 <= seed < 1 << 63:
        raise UsageError(f"seed: must be from 0 to {(1 << 63) - 1} (given: {seed})")
    shaped = {"video fps": video_fps, "video speed": video_speed, "video size": video_size}
    for name, given in shaped.items():
        if given is not None and video is None:
            raise UsageError(f"{name}: there is no video to be made; name its file, as run.mp4")
    keep: list[Callable[[str], None]] = []  # the log, once it is open, is told what people are

    def tell(line: str) -> None:
        say(line)
        for one in keep:
            one(line)

    fleet = Fleet(show=tell)  # first: it gets ready while we load the rest
    try:
        from sim.engine import Settings  # noqa: PLC0415
        from sim.filming import Film, open_recorder  # noqa: PLC0415
        from sim.run import run_world  # noqa: PLC0415
        from sim.worldfile import load  # noqa: PLC0415
        from troupe.compiling import Compiling  # noqa: PLC0415
        from troupe.worlds import find_world  # noqa: PLC0415

        compiling = Compiling(say)
        with compiling:
            loaded = load(find_world(str(world)), settings=settings)
        told = Settings(
            seed=loaded.world.seed if seed is None else seed,
            duration=loaded.world.duration if duration is None else duration,
            realtime=realtime,
            listen=listen,
            patience=patience,
        )
        film = None
        if video is not None:
            video_recorder = open_recorder(
                Path(video), loaded, fps=video_fps, speed=video_speed, size=video_size
            )
            film = Film(video_recorder)
            if video_recorder.notice:
                say(video_recorder.notice)
        recorder = open_log_of(loaded, told, log, log_sensors, settings)
        if recorder is not None:
            keep.append(recorder.line)
            recorder.complain = say
    except BaseException:
        fleet.close()
        raise

    def after_tick(engine: Engine) -> None:
        if compiling.spans:  # once in a machine's life, and no part of a run's speed
            engine.began += compiling.after(engine.began)
        if each_tick is not None:
            each_tick(engine)

    with compiling:
        result = run_world(
            loaded, told, fleet=fleet, film=film, log=recorder, each_tick=after_tick, say=tell
        )
    return Run(
        result,
        None if film is None else film.recorder.error,
        None if recorder is None else recorder.writer.error,
        None if recorder is None else recorder.writer.path,
    )


def open_log_of(
    loaded: LoadedWorld,
    told: Settings,
    path: str | Path | None,
    sensors: Sequence[str] | None,
    settings: Sequence[str],
) -> Recorder | None:
    """The log that was asked for here or in the world file, if any; raises LogError, UsageError."""
    asked = loaded.world.log
    if path is None and asked is None:
        if sensors:
            raise UsageError("log sensors: there is no log to be written; name its file: run.mcap")
        return None
    from sim.engine import label  # noqa: PLC0415
    from sim.log.recorder import open_log  # noqa: PLC0415
    from troupe.about import machine, versions  # noqa: PLC0415

    if sensors is None:
        sensors = () if asked is None else asked.sensors
    about = {
        "world": label(loaded.path),
        "title": loaded.world.name or loaded.path.stem,
        "seed": str(told.seed),
        "duration": repr(told.duration),
        "interval": repr(loaded.world.clock.interval),
        "settings": json.dumps(list(settings)),
        "sensors": ",".join(sensors),
        "machine": machine(),
        **versions(),
    }
    if path is None:
        assert asked is not None
        path = asked.file
    return open_log(Path(path), loaded, sensors, about)
