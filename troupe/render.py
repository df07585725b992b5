"""From a log to a video or a picture: what the run itself would have made of it."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from functools import partial
from pathlib import Path

from sim.interrupts import Interrupts
from troupe.filmed import Filmed
from troupe.usage import UsageError, check_apart


def render(
    log: Path,
    filmed: Filmed,
    *,
    say: Callable[[str], None] = lambda line: None,
    progress: Callable[[float, float], None] = lambda time, until: None,
    interrupts: Interrupts | None = None,
) -> str | None:
    """Make what is wanted of the run of a log; why it is not whole, if so.

    `progress` is told of each tick its simulated second, and until which one it goes.
    `interrupts` are held from when there is something to lose, and then until the caller releases
    them; a video that is interrupted ends there. Raises LogError, VideoError and UsageError for
    what cannot be, before any file is touched.
    """
    from sim.log.playback import Playback  # noqa: PLC0415 - loads the simulator
    from sim.log.reader import LogReader  # noqa: PLC0415
    from troupe.warm import warm_once  # noqa: PLC0415

    if filmed.video is None and filmed.picture is None:
        raise UsageError("there is nothing to be made: say --video FILE.mp4 or --picture FILE.png")
    for target in (filmed.video, filmed.picture):
        if target is not None:
            check_apart(Path(target), log)
    interrupts = interrupts or Interrupts()
    playback = Playback(LogReader(log))
    warm_once(say)
    begun = False
    with contextlib.ExitStack() as ending:
        film = filmed.open(playback.loaded, ending, say, lambda: begun)
        assert film is not None
        interrupts.hold()
        begun = True

        def going_on() -> bool:
            return not interrupts.noted

        last = None
        times = playback.states.times.tolist()
        until: float = times[-1]
        if filmed.video is None and filmed.at is not None:
            until = min(until, filmed.at)
        try:
            for k, time in enumerate(times):
                if film.done or not going_on():
                    break
                progress(time, until)
                film.shoot(time, partial(playback.present, k), going_on)
            else:
                last = playback.end()
        finally:
            film.end(last)  # whatever has come so far can be looked at
    short = filmed.shortfall(film)
    if short is not None:
        say(short)
    return film.error
