"""The options of videos and pictures, which `troupe run` and `troupe render` share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

Video = Annotated[
    Path | None,
    typer.Option(metavar="FILE.mp4", help="Make a video of the run.", show_default="none is made"),
]
VideoFps = Annotated[
    float | None, typer.Option(help="Frames per second of video.", show_default="25")
]
VideoSpeed = Annotated[
    float | None,
    typer.Option(help="Simulated seconds per second of video.", show_default="10"),
]
VideoSize = Annotated[
    str | None,
    typer.Option(metavar="WxH", help="Pixels.", show_default="the world's shape, 840 at the most"),
]
VideoShow = Annotated[
    str | None,
    typer.Option(
        metavar="LAYERS",
        help="Some of fans,names,trails,speech,blobs, or none; for --picture too.",
        show_default="all but blobs",
    ),
]
Picture = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE.png|.svg",
        help="Draw one moment, with axes in metres.",
        show_default="none is made",
    ),
]
At = Annotated[
    float | None,
    typer.Option(
        metavar="T", help="The picture's moment in simulated seconds.", show_default="the end"
    ),
]
