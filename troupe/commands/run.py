"""`troupe run`: run a world, show progress, print the result."""

from __future__ import annotations

import contextlib
import socket
import sys
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from player.printable import printable_lines
from sim.interrupts import Interrupts
from troupe import film_options as options
from troupe import run_options as common
from troupe.address import parse_address
from troupe.interrupts import EXIT_CODE, leave
from troupe.show import Screen
from troupe.streams import OutputLost, ReaderGone
from troupe.usage import UsageError, told

if TYPE_CHECKING:
    from troupe.live.opening import LiveView, LogView
    from troupe.log import Log
    from troupe.running import Run


def run(
    world: Annotated[
        str, typer.Argument(metavar="WORLD", help="A world file, or the name of one of Troupe's.")
    ],
    seed: common.Seed = None,
    duration: common.Duration = None,
    set_: common.Changes = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the result as one JSON object.")
    ] = False,
    quiet: Annotated[
        bool,
        typer.Option(
            "--quiet",
            help="No progress, no controllers' output; the result only (and a warning where others "
            "can reach the robots).",
        ),
    ] = False,
    video: options.Video = None,
    video_fps: options.VideoFps = None,
    video_speed: options.VideoSpeed = None,
    video_size: options.VideoSize = None,
    video_show: options.VideoShow = None,
    picture: options.Picture = None,
    at: options.At = None,
    log: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.mcap",
            help="Keep the run: all that moves, is said, is painted.",
            show_default="where the world says so",
        ),
    ] = None,
    log_sensors: Annotated[
        str | None,
        typer.Option(
            metavar="[NAMES]",
            help="Keep readings in the log as well: all of them, or those named: "
            "laser,blobfinder,odometry,...",
            show_default="as the world says, or none",
        ),
    ] = None,
    report: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.html",
            help="Make a page of what came out: pictures, plots, what happened.",
            show_default="none is made",
        ),
    ] = None,
    realtime: Annotated[
        float | None,
        typer.Option(
            metavar="[FACTOR]",
            help="Hold the run to the wall clock: to real time, or to a multiple of it.",
            show_default="as fast as possible",
        ),
    ] = None,
    free: Annotated[
        bool,
        typer.Option(
            "--free",
            help="Wait for no Player client from outside: the world runs on by itself, in real "
            "time unless --realtime says otherwise, for programs that sleep.",
        ),
    ] = False,
    listen: common.Listen = None,
    view: Annotated[
        str | None,
        typer.Option(
            metavar="[HOST:PORT]",
            help="Show the run live in a browser, at a free port of this machine unless told.",
            show_default="it is not shown",
        ),
    ] = None,
    no_open: Annotated[
        bool, typer.Option("--no-open", help="Tell the view's address, but open no browser.")
    ] = False,
    read_only: common.ReadOnly = False,
    patience: common.Patience = 60.0,
    fail_fast: Annotated[
        bool,
        typer.Option("--fail-fast", help="End the run when the first controller has failed."),
    ] = False,
) -> None:
    """Run a world to its end and print what came out of it.

    Exit code 0: completed; 1: ended short (time limit, a controller failed, hung or was lost);
    2: bad usage or a bad world file; 130: interrupted.
    """
    for option, given in (("--no-open", no_open), ("--read-only", read_only)):
        if given and view is None:
            raise typer.BadParameter("there is no page without --view", param_hint=option)
    run_and_show(
        world,
        as_json=as_json,
        quiet=quiet,
        watched=None if view is None else Watched(view or None, not no_open, read_only),
        seed=seed,
        duration=duration,
        settings=set_ or [],
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
        log_sensors=None if log_sensors is None else parse_names(log_sensors),
        report=report,
    )


@dataclass(frozen=True)
class Watched:
    """How a run is to be shown in a browser: see `troupe.live.opening.LiveView`."""

    address: str | None
    browser: bool
    read_only: bool
    paused: bool = False
    stays: bool = False
    option: str = "view"
    """What the address is given with."""

    def open(self, screen: Screen, again: bool) -> LiveView:
        """The view, not yet entered."""
        from troupe.live.opening import LiveView  # noqa: PLC0415 - loaded for those who watch

        return LiveView(
            *self.place,
            browser=self.browser,
            read_only=self.read_only,
            paused=self.paused,
            stays=self.stays,
            again=again,
            say=screen.say,
            warn=screen.warn,
        )

    def of_log(self, screen: Screen, log: Log, start: float) -> LogView:
        """The view of a log from a second of it on, not yet entered."""
        from troupe.live.opening import LogView  # noqa: PLC0415 - loaded for those who watch

        return LogView(
            log,
            *self.place,
            start=start,
            browser=self.browser,
            read_only=self.read_only,
            warn=screen.warn,
        )

    @property
    def place(self) -> tuple[str, int]:
        """Host and port; raises UsageError for what is none."""
        if self.address is None:
            return "127.0.0.1", 0
        return parse_address(self.option, self.address)


def run_and_show(
    world: str,
    *,
    as_json: bool,
    quiet: bool,
    watched: Watched | None,
    video: Path | None = None,
    picture: Path | None = None,
    listen: str | None = None,
    **options: Any,
) -> NoReturn:
    """Run a world to its end, print its result and exit; `options` are those of `run_file`."""
    from troupe.running import run_file  # noqa: PLC0415 - `troupe --help` stays quick

    interrupts = Interrupts(again=leave)
    try:
        with Screen(quiet) as screen:
            done = run_file(
                world,
                video=video,
                picture=picture,
                listen=listen,
                say=screen.say,
                warn=screen.warn,
                each_tick=screen.progress,
                while_waiting=screen.waiting,
                interrupts=interrupts,
                view=None if watched is None else partial(watched.open, screen),
                **options,
            )
        show(done, as_json, video, picture)
        code = done.result.exit_code or int(done.broken)
    except told_errors() as error:
        print(error, file=sys.stderr)
        code = 2
    except OSError as error:  # an address that cannot be had, no process to be made
        named = f"--listen {listen}" if listen is not None else "player.host"
        print(f"{named}: " * isinstance(error, socket.gaierror) + told(error), file=sys.stderr)
        code = 2
    except OutputLost:
        if not interrupts.noted:
            raise
        code = 1
    interrupts.release()
    raise typer.Exit(EXIT_CODE if interrupts.noted else code)


def told_errors() -> tuple[type[Exception], ...]:
    """What a run raises for people to read; loaded where there is something to be told."""
    from sim.log.errors import LogError  # noqa: PLC0415
    from sim.video.errors import VideoError  # noqa: PLC0415
    from sim.worldfile.mistakes import WorldError  # noqa: PLC0415

    return (UsageError, VideoError, WorldError, LogError)


def show(done: Run, as_json: bool, video: Path | None, picture: Path | None) -> None:
    """Print the result, to the last byte; whoever reads it may have enough before."""
    for error in (done.video_error, done.report_error):
        if error is not None:
            print(printable_lines(error), file=sys.stderr)
    with contextlib.suppress(ReaderGone):
        if as_json:
            from sim.strictjson import dumps  # noqa: PLC0415

            print(dumps(done.result.as_json()))
        else:
            from troupe.summary import summary  # noqa: PLC0415

            made = (video, picture) if done.video_error is None else (None, None)
            print(summary(done.result, *made))
        sys.stdout.flush()


def parse_names(text: str) -> list[str]:
    """Names between commas."""
    return [name.strip() for name in text.split(",") if name.strip()]
