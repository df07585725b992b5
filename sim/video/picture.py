"""One world drawn moment by moment: all layers of a frame, from the ground up."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.video.axes import draw_axes
from sim.video.bodies import draw_bodies
from sim.video.compose import Composer, Composition
from sim.video.drawings import draw_drawings
from sim.video.errors import VideoError
from sim.video.ground import draw_ground, solid_pixels
from sim.video.layers import SHOWN, Layer
from sim.video.paint import PaintLayer
from sim.video.palette import INK, OUTSIDE, PAPER, mix, tint
from sim.video.scans import draw_scans, draw_sightings
from sim.video.snapshot import Backdrop, Shape, Snapshot
from sim.video.status import StatusLine
from sim.video.svg import svg_of
from sim.video.trails import draw_trails

ENDINGS = (".png", ".svg")


class Picture:
    """Draws snapshots of one world. What it shows depends on them alone, in their order."""

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
        self._stand(backdrop)
        self._scratch = np.zeros_like(self._paint.image)

    def _stand(self, backdrop: Backdrop) -> None:
        """Draw what stands, and all paint anew."""
        self._backdrop, p, axes = backdrop, self.projection, self.composer.axes
        ground = draw_ground(backdrop, p, outside=PAPER if axes else OUTSIDE)
        if axes:
            draw_axes(ground[: p.field_height], backdrop.size, p, self.composer.lettering)
        self.status.draw_still(ground[p.field_height :])
        self._paint = PaintLayer(ground, solid_pixels(backdrop, p), p)

    def add_robot(self, name: str, shape: Shape) -> int:
        """Adds a robot by its outline (k, 2) m in its own frame, or its radius; its index."""
        return self.composer.add_robot(name, shape)

    def draw(self, snapshot: Snapshot, out: NDArray[np.uint8] | None = None) -> NDArray[np.uint8]:
        """The frame of a snapshot as (height, width, 3) BGR, in `out` where one is given."""
        composed = self.composer.compose(snapshot)
        if self.composer.backdrop is not self._backdrop:
            self._stand(self.composer.backdrop)
        image = np.empty_like(self._paint.image) if out is None else out
        if snapshot.floor is not None:
            self._paint.update(snapshot.floor, snapshot.resolution)
        np.copyto(image, self._paint.image)
        field = image[: self.projection.field_height]
        line = self.projection.units(1)
        self._draw_scans(field, composed)
        if composed.trails:
            draw_trails(field, self.composer.trails, line)
        draw_bodies(field, composed.movables, composed.movable_colors, robots=False, line=line)
        draw_bodies(field, composed.robots, composed.colors, composed.settled, line=line)
        draw_sightings(field, composed.sightings, self.composer.bodies.radii, self.projection)
        draw_drawings(field, snapshot.drawings, self.projection)
        self._draw_callouts(field, composed)
        self.status.draw(image[len(field) :], snapshot, len(composed.colors))
        return image

    def svg(self, snapshot: Snapshot) -> str:
        """The same as an SVG document."""
        return svg_of(self.composer, self.composer.compose(snapshot), self.status)

    def _draw_scans(self, field: NDArray[np.uint8], composed: Composition) -> None:
        """Fans lie on bare ground: paint is what is to be seen."""
        if not composed.scans:
            return
        rows = len(field)
        scratch = self._scratch[:rows]
        filled = composed.fans == "filled"
        draw_scans(field, scratch, composed.scans, self.projection, filled=filled)
        if self._paint.any:
            cv2.copyTo(self._paint.image[:rows], self._paint.mask[:rows], field)

    def _draw_callouts(self, field: NDArray[np.uint8], composed: Composition) -> None:
        lettering = self.composer.lettering
        for callout in composed.callouts:
            if callout.kind == "name":
                lettering.label(field, callout.text, callout.box)
            else:
                edge = mix(tint(callout.robot), INK, 0.35)
                lettering.balloon(field, callout.text, callout.tip, callout.box, edge)


def save_picture(path: Path | str, picture: Picture, snapshot: Snapshot) -> Path:
    """Draws a snapshot and writes it as PNG or SVG; raises VideoError where that cannot be done."""
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in ENDINGS:
        raise VideoError(f"{path}: a picture's name must end in .png or .svg")
    if ending == ".svg":
        data = picture.svg(snapshot).encode()
    else:
        done, pixels = cv2.imencode(
            ".png", picture.draw(snapshot), [cv2.IMWRITE_PNG_COMPRESSION, 9]
        )
        if not done:
            raise VideoError(f"{path}: OpenCV could not encode the picture")
        data = pixels.tobytes()
    try:
        path.write_bytes(data)
    except OSError as error:
        raise VideoError(f"{path}: cannot be written ({error.strerror})") from error
    return path
