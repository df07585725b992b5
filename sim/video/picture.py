"""One world drawn moment by moment: all layers of a frame, from the ground up."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.video.axes import draw_axes
from sim.video.bodies import draw_bodies
from sim.video.compose import Composer, Moment
from sim.video.drawings import draw_drawings
from sim.video.errors import VideoError
from sim.video.ground import draw_ground, solid_pixels
from sim.video.layers import SHOWN, Layer
from sim.video.paint import PaintLayer
from sim.video.palette import INK, OUTSIDE, PAPER, mix, tint
from sim.video.scans import draw_scans, draw_sightings
from sim.video.status import StatusLine
from sim.video.svg import svg_of
from sim.video.trails import draw_trails
from sim.video.view import Backdrop, FrameView, Shape

ENDINGS = (".png", ".svg")


class Picture:
    """Draws views of one world. What it shows depends on the views alone, in their order."""

    def __init__(
        self,
        backdrop: Backdrop,
        size: tuple[int, int] | None = None,
        *,
        speech_time: float = 30.0,
        show: frozenset[Layer] = SHOWN,
        film_speed: float | None = None,
        axes: bool = False,
    ) -> None:
        """`size` in pixels, None: the world's aspect; what is said shows `speech_time` s.

        `film_speed`: simulated seconds per second of the video that this is a frame of. `axes`:
        in metres, in place of the scale bar.
        """
        self.composer = Composer(backdrop, size, show=show, speech_time=speech_time, axes=axes)
        self.size, self.projection = self.composer.size, self.composer.projection
        p, lettering = self.projection, self.composer.lettering
        self.status = StatusLine(
            (p.width, p.height - p.field_height),
            backdrop.title,
            None if axes else p.scale,
            lettering,
            film_speed,
        )
        ground = draw_ground(backdrop, p, outside=PAPER if axes else OUTSIDE)
        if axes:
            draw_axes(ground[: p.field_height], backdrop.size, p, lettering)
        self.status.draw_still(ground[p.field_height :])
        self._paint = PaintLayer(ground, solid_pixels(backdrop, p), p)
        self._scratch = np.zeros_like(ground)

    def add_robot(self, name: str, shape: Shape) -> int:
        """Adds a robot by its outline (k, 2) m in its own frame, or its radius; its index."""
        return self.composer.add_robot(name, shape)

    def draw(self, view: FrameView, out: NDArray[np.uint8] | None = None) -> NDArray[np.uint8]:
        """The frame of a view as (height, width, 3) BGR, in `out` where one is given."""
        moment = self.composer.compose(view)
        image = np.empty_like(self._paint.image) if out is None else out
        if view.floor is not None:
            self._paint.update(view.floor, view.resolution)
        np.copyto(image, self._paint.image)
        field = image[: self.projection.field_height]
        line = self.projection.units(1)
        self._draw_scans(field, moment)
        if moment.trails:
            draw_trails(field, self.composer.trails, line)
        draw_bodies(field, moment.movables, moment.movable_colors, robots=False, line=line)
        draw_bodies(field, moment.robots, moment.colors, moment.settled, line=line)
        draw_sightings(field, moment.sightings, self.composer.bodies.radii, self.projection)
        draw_drawings(field, view.drawings, self.projection)
        self._draw_callouts(field, moment)
        self.status.draw(image[len(field) :], view, len(moment.colors))
        return image

    def svg(self, view: FrameView) -> str:
        """The same as an SVG document."""
        return svg_of(self.composer, self.composer.compose(view), self.status)

    def _draw_scans(self, field: NDArray[np.uint8], moment: Moment) -> None:
        """Fans lie on bare ground: paint is what is to be seen."""
        if not moment.scans:
            return
        rows = len(field)
        scratch = self._scratch[:rows]
        filled = moment.fans == "filled"
        draw_scans(field, scratch, moment.scans, self.projection, filled=filled)
        if self._paint.any:
            cv2.copyTo(self._paint.image[:rows], self._paint.mask[:rows], field)

    def _draw_callouts(self, field: NDArray[np.uint8], moment: Moment) -> None:
        lettering = self.composer.lettering
        for callout in moment.callouts:
            if callout.kind == "name":
                lettering.label(field, callout.text, callout.box)
            else:
                edge = mix(tint(callout.robot), INK, 0.35)
                lettering.balloon(field, callout.text, callout.tip, callout.box, edge)


def save_picture(path: Path | str, picture: Picture, view: FrameView) -> Path:
    """Draws a view and writes it as PNG or SVG; raises VideoError where that cannot be done."""
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in ENDINGS:
        raise VideoError(f"{path}: a picture's name must end in .png or .svg")
    if ending == ".svg":
        data = picture.svg(view).encode()
    else:
        done, pixels = cv2.imencode(".png", picture.draw(view), [cv2.IMWRITE_PNG_COMPRESSION, 9])
        if not done:
            raise VideoError(f"{path}: OpenCV could not encode the picture")
        data = pixels.tobytes()
    try:
        path.write_bytes(data)
    except OSError as error:
        raise VideoError(f"{path}: cannot be written ({error.strerror})") from error
    return path
