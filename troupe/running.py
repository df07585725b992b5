"""From a world's name and options to a run: what `troupe run` and `troupe.run` share."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sim.fleet.fleet import Fleet
from troupe.usage import UsageError

if TYPE_CHECKING:
    from sim.engine import Engine
    from sim.result import Result

EachTick = Callable[["Engine"], None]


@dataclass(frozen=True)
class Run:
    """What came out of a run; `video_error` says why a video or picture is not whole, if so."""

    result: Result
    video_error: str | None


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
    video_show: Iterable[str] | None = None,
    picture: str | Path | None = None,
    at: float | None = None,
    say: Callable[[str], None],
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
    shaped = {"video fps": video_fps, "video speed": video_speed}
    for name, given in shaped.items():
        if given is not None and video is None:
            raise UsageError(f"{name}: there is no video to be made; name its file, as run.mp4")
    for name, told_anyhow in {"video size": video_size, "video show": video_show}.items():
        if told_anyhow is not None and video is None and picture is None:
            raise UsageError(f"{name}: there is no video to be made; name its file, as run.mp4")
    if at is not None and picture is None:
        raise UsageError("at: there is no picture to be made; name its file, as run.png")
    fleet = Fleet(show=say)  # first: it gets ready while we load the rest
    try:
        from sim.engine import Settings  # noqa: PLC0415
        from sim.filming import Film, open_recorder, open_still  # noqa: PLC0415
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
        if picture is not None:
            still = open_still(Path(picture), loaded, at=at, size=video_size, show=video_show)
            film = Film(still=still)
        if video is not None:
            recorder = open_recorder(
                Path(video),
                loaded,
                fps=video_fps,
                speed=video_speed,
                size=video_size,
                show=video_show,
            )
            film = Film(recorder, None if film is None else film.still)
            if recorder.notice:
                say(recorder.notice)
    except BaseException:
        fleet.close()
        raise

    def after_tick(engine: Engine) -> None:
        if compiling.spans:  # once in a machine's life, and no part of a run's speed
            engine.began += compiling.after(engine.began)
        if each_tick is not None:
            each_tick(engine)

    with compiling:
        result = run_world(loaded, told, fleet=fleet, film=film, each_tick=after_tick, say=say)
    taken = None if film is None or film.still is None else film.still.time
    if taken is not None and at is not None and taken < at - 1e-9:
        say(f"{picture}: the run ended at {taken:g} s, and that is what the picture shows")
    return Run(result, None if film is None else film.error)
