"""`troupe render`: videos and pictures of a run that was kept."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from player.printable import printable_lines
from sim.interrupts import Interrupts
from troupe import film_options as options
from troupe.filmed import Filmed
from troupe.interrupts import EXIT_CODE, leave
from troupe.show import Screen
from troupe.usage import UsageError, told


def render(
    log: Annotated[
        Path, typer.Argument(metavar="LOG.mcap", help="A log that `troupe run --log` wrote.")
    ],
    video: options.Video = None,
    video_fps: options.VideoFps = None,
    video_speed: options.VideoSpeed = None,
    video_size: options.VideoSize = None,
    video_show: options.VideoShow = None,
    picture: options.Picture = None,
    at: options.At = None,
) -> None:
    """Make a video, or a picture of one moment, of a run that was kept.

    They are what the run itself would have made, frame by frame. Exit code 0: made; 1: not to its
    end, as the disk is full, say; 2: bad usage, or no log; 130: interrupted.
    """
    from sim.log.errors import LogError  # noqa: PLC0415 - `troupe --help` stays quick
    from sim.video.errors import VideoError  # noqa: PLC0415
    from troupe.render import render as made_of  # noqa: PLC0415

    interrupts = Interrupts(again=leave)
    code = 0
    try:
        with Screen(quiet=False) as screen:
            filmed = Filmed(video, video_fps, video_speed, video_size, video_show, picture, at)
            error = made_of(
                log, filmed, say=screen.say, progress=screen.rendered, interrupts=interrupts
            )
        if error is not None:
            tell(error)
            code = 1
        elif not interrupts.noted:
            for name, file in (("video", video), ("picture", picture)):
                if file is not None:
                    print(printable_lines(f"{name}: {file}"))
    except (UsageError, VideoError, LogError) as error:
        tell(str(error))
        code = 2
    except OSError as error:
        tell(told(error))
        code = 2
    interrupts.release()
    raise typer.Exit(EXIT_CODE if interrupts.noted else code)


def tell(line: str) -> None:
    """A line for people."""
    print(printable_lines(line), file=sys.stderr)
