"""`troupe run`: run a world, show progress, print the result."""

from __future__ import annotations

import signal
import socket
import sys
from pathlib import Path
from typing import Annotated

import typer

from troupe.interrupts import interrupt
from troupe.show import Screen
from troupe.usage import UsageError, told


def run(
    world: Annotated[
        str, typer.Argument(metavar="WORLD", help="A world file, or the name of one of Troupe's.")
    ],
    seed: Annotated[
        int | None, typer.Option(help="All that is random follows from it.", show_default=False)
    ] = None,
    duration: Annotated[
        float | None, typer.Option(help="Simulated seconds at most.", show_default=False)
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Change the world, as in models.rover.drive.max_speed=0.3. May be repeated.",
        ),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the result as one JSON object.")
    ] = False,
    quiet: Annotated[
        bool, typer.Option("--quiet", help="No progress, no controllers' output; the result only.")
    ] = False,
    video: Annotated[
        Path | None, typer.Option(metavar="FILE.mp4", help="Make a video of the run.")
    ] = None,
    video_fps: Annotated[
        float | None, typer.Option(help="Frames per second of video. [default: 25]")
    ] = None,
    video_speed: Annotated[
        float | None, typer.Option(help="Simulated seconds per second of video. [default: 10]")
    ] = None,
    video_size: Annotated[
        str | None,
        typer.Option(metavar="WxH", help="Pixels. [default: the world's shape, 840 at the most]"),
    ] = None,
    log: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.mcap", help="Keep the run: all that moves, is said, is painted."
        ),
    ] = None,
    log_sensors: Annotated[
        str | None,
        typer.Option(
            metavar="all|NAMES",
            help="Keep readings in the log as well: all, or laser,blobfinder,odometry,...",
        ),
    ] = None,
    realtime: Annotated[
        float | None,
        typer.Option(
            metavar="FACTOR", help="Hold the run to the wall clock: 1 is real time. [default: no]"
        ),
    ] = None,
    listen: Annotated[
        str | None,
        typer.Option(metavar="HOST:PORT", help="Let Player clients connect over TCP."),
    ] = None,
    patience: Annotated[
        float, typer.Option(help="Wall-clock seconds that a controller may hold up the others.")
    ] = 60.0,
) -> None:
    """Run a world to its end and print what came out of it.

    Exit code 0: completed; 1: ended short (time limit, a controller failed, hung or was lost);
    2: bad usage or a bad world file; 130: interrupted.
    """
    signal.signal(signal.SIGTERM, interrupt)
    try:
        code = run_and_print(
            world, seed, duration, set_ or [], as_json, quiet, video, video_fps, video_speed,
            video_size, log, log_sensors, realtime, listen, patience,
        )  # fmt: skip
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        code = 130
    raise typer.Exit(code)


def run_and_print(
    world: str,
    seed: int | None,
    duration: float | None,
    settings: list[str],
    as_json: bool,
    quiet: bool,
    video: Path | None,
    video_fps: float | None,
    video_speed: float | None,
    video_size: str | None,
    log: Path | None,
    log_sensors: str | None,
    realtime: float | None,
    listen: str | None,
    patience: float,
) -> int:
    """The exit code of a run; mistakes are told on standard error."""
    from sim.log.errors import LogError  # noqa: PLC0415 - `troupe --help` stays quick
    from sim.video.errors import VideoError  # noqa: PLC0415
    from sim.video.projection import parse_size  # noqa: PLC0415
    from sim.worldfile.mistakes import WorldError  # noqa: PLC0415
    from troupe.running import run_file  # noqa: PLC0415

    screen = Screen(quiet)
    try:
        with screen:
            done = run_file(
                world,
                seed=seed,
                duration=duration,
                settings=settings,
                realtime=realtime,
                listen=None if listen is None else parse_listen(listen),
                patience=patience,
                video=video,
                video_fps=video_fps,
                video_speed=video_speed,
                video_size=None if video_size is None else parse_size(video_size),
                log=log,
                log_sensors=None if log_sensors is None else parse_names(log_sensors),
                say=screen.say,
                each_tick=screen.progress,
            )
    except (UsageError, VideoError, WorldError, LogError) as error:
        print(error, file=sys.stderr)
        return 2
    except OSError as error:  # an address that cannot be had, no process to be made
        named = f"--listen {listen}" if listen is not None else "player.host"
        print(f"{named}: " * isinstance(error, socket.gaierror) + told(error), file=sys.stderr)
        return 2
    result = done.result
    if done.video_error is not None:
        print(done.video_error, file=sys.stderr)
    if as_json:
        from sim.strictjson import dumps  # noqa: PLC0415

        print(dumps(result.as_json()))
    else:
        from troupe.summary import summary  # noqa: PLC0415

        print(summary(result, video if done.video_error is None else None))
    return result.exit_code or int(done.video_error is not None or done.log_error is not None)


def parse_listen(text: str) -> tuple[str, int]:
    """`HOST:PORT`, or a port alone, as (host, port); raises UsageError."""
    host, _, port = text.rpartition(":")
    if not port.isdecimal() or not 0 <= int(port) <= 65535:
        raise UsageError(f"--listen {text}: must be HOST:PORT, such as 127.0.0.1:6665")
    return host.strip("[]") or "127.0.0.1", int(port)


def parse_names(text: str) -> list[str]:
    """Names between commas."""
    return [name.strip() for name in text.split(",") if name.strip()]
