"""The blobfinder: what a camera that tells colours apart sees, as runs of one colour.

Blobs are made as Stage makes them: one ray per column of the image; a run of columns in which the
same colour is seen is a blob; its range is the mean of its columns'; it reaches as many rows above
and below the middle as half its height spans, at the same angle per pixel as the columns'. Unlike
in Stage the height is that of what is seen (the mean over the columns), and a run begins right
where the last one ended.
"""

import math
from functools import lru_cache
from typing import Annotated

import numpy as np
import numpy.typing as npt
from pydantic import Field

from sensors.compiled import compiled
from sensors.grid import Floats, Ints
from sensors.picture import Hits
from sensors.readings import Blobs, Fan
from sensors.registry import sensor
from sensors.scene import Colors
from sensors.settings import Color, Count, Number, SensorSettings, setting
from sensors.view import View

Pixels = Annotated[Count, Field(ge=1, le=10_000)]


class BlobfinderSettings(SensorSettings):
    """The defaults are those of the paper's robots."""

    range: Number = setting(20.0, gt=0, unit="m", description="how far it sees")
    fov: Number = setting(
        180.0, gt=0, le=360, unit="deg", description="the image's width as an angle"
    )
    image: tuple[Pixels, Pixels] = setting(
        (160, 120), unit="pixels", description="columns and rows of the image"
    )
    colors: tuple[Color, ...] = setting(
        (), unit="colours", description="the colours it tells apart; empty: all of them"
    )


def _empty(settings: BlobfinderSettings, n: int) -> Blobs:
    return Blobs.empty(n, *settings.image)


@lru_cache(maxsize=256)
def _channels(colors: tuple[int, ...]) -> Colors:
    return np.array(colors, np.uint32)


def _fan(settings: BlobfinderSettings, blobs: Blobs) -> Fan:
    assert blobs.columns is not None
    assert blobs.hits is not None
    return Fan(math.radians(settings.fov), settings.range, blobs.columns, blobs.hits)


@sensor(
    "blobfinder",
    kind="blobs",
    settings=BlobfinderSettings,
    readings=_empty,
    fan=_fan,
    threads=True,
)
def sense_blobs(settings: BlobfinderSettings, view: View, blobs: Blobs) -> None:
    """Runs of one colour in a camera's image, with their range."""
    scene, columns, hits = view.scene, blobs.columns, blobs.hits
    assert columns is not None
    assert hits is not None
    find_blobs(
        columns,
        hits,
        view.rows,
        scene.colors,
        scene.heights,
        _channels(settings.colors),
        math.radians(settings.fov),
        blobs.height,
        blobs.blobs.T,
        blobs.counts,
    )


@compiled
def find_blobs(
    columns: Floats,
    hits: Hits,
    rows: Ints,
    colors: Colors,
    heights: Floats,
    channels: Colors,
    fov: float,
    image_height: int,
    blobs: npt.NDArray[np.void],
    counts: Ints,
) -> None:
    """Write the runs of one colour in `columns` (n, width) into `blobs` (width, n) and `counts`.

    Columns come from the right, blobs are counted from the image's left. `channels` are the
    colours that are told apart, all if there are none; a blob's id is its colour's place in it.
    """
    width = columns.shape[1]
    angle_per_row = fov / image_height
    middle = image_height // 2
    for j in rows:
        count = 0
        i = 0
        while i < width:
            if hits[j, i] < 0:
                i += 1
                continue
            color = colors[hits[j, i]]
            right = i
            distance = 0.0
            tall = 0.0
            while i < width and hits[j, i] >= 0 and colors[hits[j, i]] == color:
                distance += columns[j, i]
                tall += heights[hits[j, i]]
                i += 1
            channel = 0 if channels.shape[0] == 0 else -1
            for c in range(channels.shape[0]):
                if channels[c] == color:
                    channel = c
                    break
            if channel < 0:
                continue
            distance /= i - right
            tall /= i - right
            half = int(math.atan2(0.5 * tall, distance) / angle_per_row)
            left_pixel, right_pixel = width - i, width - 1 - right
            top, bottom = max(middle - half, 0), min(middle + half, image_height)
            blob = blobs[count, j]
            blob.id = channel
            blob.color = color
            blob.left, blob.right = left_pixel, right_pixel
            blob.top, blob.bottom = top, bottom
            blob.x, blob.y = (left_pixel + right_pixel) // 2, (top + bottom) // 2
            blob.area = (right_pixel - left_pixel) * (bottom - top)
            blob.range = distance
            count += 1
        counts[j] = count
