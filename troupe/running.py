"""From a world's name and options to a run: what `troupe run` and `troupe.run` share."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from sim.fleet.fleet import Fleet
from sim.interrupts import Interrupts
from troupe.address import Address, parse_address
from troupe.filmed import Filmed, Size
from troupe.given import checked_controllers, checked_patience, checked_seconds, checked_seed
from troupe.setting import Setting, as_text
from troupe.usage import UsageError
from troupe.usage import told as told_error

if TYPE_CHECKING:
    from sim.build import LoadedWorld
    from sim.engine import Engine, Settings
    from sim.fleet.functions import Controllers
    from sim.log.recorder import Recorder
    from sim.result import Result
    from troupe.live.opening import LiveView
    from troupe.world import World

EachTick = Callable[["Engine"], None]


@dataclass(frozen=True)
class Run:
    """What came out of a run. An error says why what was asked for is not whole, if so."""

    result: Result
    video_error: str | None
    log_error: str | None = None
    log: Path | None = None
    report_error: str | None = None

    @property
    def broken(self) -> bool:
        """Whether something that was asked for besides the result is not whole."""
        errors = (self.video_error, self.log_error, self.report_error)
        return any(error is not None for error in errors)


def run_file(
    world: str | Path | Mapping[str, Any] | World,
    *,
    seed: int | None = None,
    duration: float | None = None,
    settings: Setting = (),
    controllers: Controllers = True,
    realtime: float | None = None,
    free: bool = False,
    listen: Address | None = None,
    patience: float = 60.0,
    fail_fast: bool = False,
    video: str | Path | None = None,
    video_fps: float | None = None,
    video_speed: float | None = None,
    video_size: Size | None = None,
    video_show: str | Iterable[str] | None = None,
    picture: str | Path | None = None,
    at: float | None = None,
    say: Callable[[str], None],
    warn: Callable[[str], None] | None = None,
    log: str | Path | None = None,
    log_sensors: Sequence[str] | None = None,
    report: str | Path | None = None,
    each_tick: EachTick | None = None,
    while_waiting: EachTick | None = None,
    interrupts: Interrupts | None = None,
    view: Callable[[bool], LiveView] | None = None,
) -> Run:
    """Run a world file; see `troupe.run`.

    `view(again)` makes what shows the run to browsers; `again`: whether it may be begun again. Then
    the result is that of the last run.

    `each_tick(engine)` is called after every tick, `while_waiting(engine)` now and then while the
    world waits for controllers, and `warn(line)`, or else `say`, with what is not to be overlooked.
    `interrupts` are held from when there is something to lose, and then until the caller, who has
    still to do something with the result, releases them.

    Raises UsageError for an argument that cannot be.
    """
    seed = None if seed is None else checked_seed(seed)
    duration = None if duration is None else checked_seconds("duration", duration)
    realtime = None if realtime is None else checked_seconds("realtime", realtime)
    patience = checked_patience(patience)
    address = None if listen is None else parse_address("listen", listen)
    filmed = Filmed(video, video_fps, video_speed, video_size, video_show, picture, at)
    interrupts, own = interrupts or Interrupts(), interrupts is None
    begun = False
    keep: list[Callable[[str], None]] = []  # the log, once it is open, is told what people are

    def tell(line: str) -> None:
        say(line)
        for one in keep:
            one(line)

    def alarm(line: str) -> None:
        (warn or say)(line)
        for one in keep:
            one(line)

    if isinstance(world, str | Path):
        from troupe.worlds import find_world  # noqa: PLC0415

        world = find_world(str(world))
    fleet = Fleet(show=tell)  # first: it gets ready while we load the rest
    with contextlib.ExitStack() as ending:
        ending.push(lambda kind, *_: fleet.close() if kind and not begun else None)
        from sim.engine import Settings  # noqa: PLC0415
        from sim.ports import try_address, try_ports  # noqa: PLC0415
        from sim.rehearsal import is_served, rehearse  # noqa: PLC0415
        from sim.run import run_world  # noqa: PLC0415
        from troupe.compiling import Compiling  # noqa: PLC0415
        from troupe.warm import warm_once  # noqa: PLC0415
        from troupe.world import loaded_world  # noqa: PLC0415

        warm_once(say)
        compiling = ending.enter_context(Compiling(say))
        loaded = loaded_world(world, as_text(settings))
        controllers = checked_controllers(controllers, loaded)
        told = Settings(
            seed=loaded.world.seed if seed is None else seed,
            duration=loaded.world.duration if duration is None else duration,
            realtime=realtime,
            free=free,
            listen=address,
            patience=patience,
            fail_fast=fail_fast,
        )
        if is_served(loaded, address, controllers):
            rehearse(loaded, told.seed)
        interrupts.hold()
        if own:
            ending.callback(interrupts.release)
        check_log(loaded, log, log_sensors)
        if report is not None:
            from troupe.report.log import check_page  # noqa: PLC0415

            check_page(Path(report))
            if not is_logged(loaded, log):  # a report is made of a log
                folder = ending.enter_context(TemporaryDirectory(prefix="troupe-report-"))
                log = Path(folder) / "run.mcap"
        window = None if view is None else view(not filmed.wanted and not is_logged(loaded, log))
        if window is not None:
            try_address(window.host, window.port)
        try_ports(loaded.world.player, address, len(loaded.robots))
        film = filmed.open(loaded, ending, say, lambda: begun)
        recorder = open_log_of(loaded, told, log, log_sensors, as_text(settings))
        if recorder is not None:
            keep.append(recorder.line)
            recorder.complain = warn or say

        def after_tick(engine: Engine) -> None:
            if compiling.spans:  # once in a machine's life, and no part of a run's speed
                engine.began += compiling.after(engine.began)
            if window is not None:
                window.each_tick(engine)
            if each_tick is not None:
                each_tick(engine)

        if window is not None:
            ending.enter_context(window)

        def meanwhile(engine: Engine) -> None:
            if window is not None:
                window.while_waiting(engine)
            if while_waiting is not None:
                while_waiting(engine)

        begun = True  # the run ends its fleet itself
        while True:
            result = run_world(
                loaded,
                told,
                fleet=fleet,
                film=film,
                log=recorder,
                each_tick=after_tick,
                while_waiting=meanwhile if window else while_waiting,
                say=tell,
                warn=alarm,
                interrupts=interrupts,
                controllers=controllers,
            )
            if window is None:
                break
            seed = window.next_seed(result.outcome, lambda: not interrupts.noted)
            if seed is None:
                break
            told = replace(told, seed=seed)
            fleet = Fleet(show=say)
        report_error = None if report is None else reported(recorder, Path(report))
    short = filmed.shortfall(film)
    if short is not None:
        say(short)
    return Run(
        result,
        None if film is None else film.error,
        None if recorder is None else recorder.writer.error,
        None if recorder is None else recorder.writer.path,
        report_error,
    )


def reported(recorder: Recorder | None, path: Path) -> str | None:
    """Write the report of the run that has been kept; why there is none, if so."""
    from sim.log.errors import LogError  # noqa: PLC0415
    from troupe.log import Log  # noqa: PLC0415
    from troupe.report.log import write_report  # noqa: PLC0415

    assert recorder is not None
    try:
        write_report(Log(recorder.writer.path), path)
    except OSError as error:
        return f"{path}: there is no report: {told_error(error)}"
    except LogError as error:
        return f"{path}: there is no report: {error}"
    return None


def open_log_of(
    loaded: LoadedWorld,
    told: Settings,
    path: str | Path | None,
    sensors: Sequence[str] | None,
    settings: Sequence[str],
) -> Recorder | None:
    """The log that was asked for here or in the world file, if any; raises LogError."""
    path, sensors = log_of(loaded, path, sensors)
    if path is None:
        return None
    from sim.engine import label  # noqa: PLC0415
    from sim.log.recorder import open_log  # noqa: PLC0415
    from troupe.about import machine, versions  # noqa: PLC0415

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
    return open_log(path, loaded, sensors, about)


def check_log(loaded: LoadedWorld, path: str | Path | None, sensors: Sequence[str] | None) -> None:
    """Raises LogError or UsageError for a log that cannot be, before any file is touched."""
    found, names = log_of(loaded, path, sensors)
    if found is not None:
        from sim.log.recorder import check_request  # noqa: PLC0415

        check_request(found, loaded, names)
    elif names:
        raise UsageError("log sensors: there is no log to be written; name its file: run.mcap")


def is_logged(loaded: LoadedWorld, path: str | Path | None) -> bool:
    """Whether a log is written of a run."""
    return log_of(loaded, path, None)[0] is not None


def log_of(
    loaded: LoadedWorld, path: str | Path | None, sensors: Sequence[str] | None
) -> tuple[Path | None, Sequence[str]]:
    """The log's file and sensors: as told, else as the world has it; None for no log."""
    asked = loaded.world.log
    if asked is not None:
        path = asked.file if path is None else path
        sensors = asked.sensors if sensors is None else sensors
    return None if path is None else Path(path), sensors or ()
