"""The pictures of a report on a log: how the run began, and how it ended, with the whole ways."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from typing import TYPE_CHECKING

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.showing import backdrop_of, shape_of
from sim.video.picture import Picture
from sim.video.projection import default_size
from sim.video.trails import Ways
from troupe.report.plots import identifiers_apart

if TYPE_CHECKING:
    from sim.log.playback import Playback
    from sim.view.present import Present

LONG_SIDE = 640
"""Pixels of a picture's longer side."""
MOST_VECTORS = 150
"""Robots up to which a picture is SVG; with more the pixels are smaller."""


def pictures(playback: Playback, ways: Sequence[NDArray[np.float64]]) -> tuple[str, str]:
    """The start and the end as parts of an HTML page."""
    begun = picture_of(playback, playback.present(0), (), "start")
    return begun, picture_of(playback, playback.end(), ways, "end")


def picture_of(
    playback: Playback, present: Present, ways: Sequence[NDArray[np.float64]], name: str
) -> str:
    """A moment, with ways in place of trails."""
    backdrop = backdrop_of(playback.loaded)
    size = default_size(backdrop.size, LONG_SIDE)
    show = frozenset({"trails", "names"} if ways else {"fans", "names"})
    picture = Picture(backdrop, size, show=show, axes=True)  # type: ignore[arg-type]
    picture.composer.trails = Ways(picture.projection, ways)
    for robot, model in zip(present.names, present.models, strict=True):
        picture.add_robot(robot, shape_of(model.body))
    if len(present.names) <= MOST_VECTORS:
        return identifiers_apart(picture.svg(present.snapshot()), name)
    done, pixels = cv2.imencode(".png", picture.draw(present.snapshot()))
    assert done
    data = base64.b64encode(pixels.tobytes()).decode()
    width, height = picture.size
    told = "how the run began" if name == "start" else "how the run ended"
    return (
        f'<img width="{width}" height="{height}" alt="{told}" src="data:image/png;base64,{data}">'
    )
