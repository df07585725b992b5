"""From a world's name and options to a run: what `troupe run` and `troupe.run` share."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from sim.fleet.fleet import Fleet

if TYPE_CHECKING:
    from sim.result import Result

EachTick = Callable[[object], None]


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
    each_tick: EachTick | None = None,
) -> Result:
    """Run a world file; see `troupe.run`. `each_tick(engine)` is called after every tick."""
    for name, value in (("duration", duration), ("realtime", realtime), ("patience", patience)):
        if value is not None and not (math.isfinite(value) and value > 0):
            raise ValueError(f"{name}: must be above 0 (given: {value:g})")
    if seed is not None and not 0 <= seed < 1 << 63:
        raise ValueError(f"seed: must be from 0 to {(1 << 63) - 1} (given: {seed})")
    fleet = Fleet(show=say)  # first: it gets ready while we load the rest
    try:
        from sim.engine import Settings  # noqa: PLC0415
        from sim.filming import Film, open_recorder  # noqa: PLC0415
        from sim.run import run_world  # noqa: PLC0415
        from sim.worldfile import load  # noqa: PLC0415
        from troupe.worlds import find_world  # noqa: PLC0415

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
            recorder = open_recorder(
                Path(video), loaded, fps=video_fps, speed=video_speed, size=video_size
            )
            film = Film(recorder)
            if recorder.notice:
                say(recorder.notice)
    except BaseException:
        fleet.close()
        raise
    result = run_world(loaded, told, fleet=fleet, film=film, each_tick=each_tick, say=say)
    if film is not None and film.recorder.error:
        say(film.recorder.error)
    return result
