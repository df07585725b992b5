"""One world drawn moment by moment: all layers of a frame, from the ground up."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.video.bodies import Bodies, colors_of
from sim.video.drawings import draw_drawings
from sim.video.errors import VideoError
from sim.video.ground import draw_ground, solid_pixels
from sim.video.paint import PaintLayer
from sim.video.projection import check_size, default_size, project
from sim.video.scans import draw_scans
from sim.video.speech import Speech
from sim.video.status import StatusLine
from sim.video.text import draw_label, printable
from sim.video.trails import Trails
from sim.video.view import MOST_SCANS, Backdrop, FrameView, Scan, Shape

MOST_NAMES = 64
"""Robots up to which names are written."""
SMALLEST_NAMED = 5.0
"""Pixels: smaller bodies are not named, except alone in a small company."""
SMALL_COMPANY = 12


class Picture:
    """Draws views of one world. What it shows depends on the views alone, in their order."""

    def __init__(
        self,
        backdrop: Backdrop,
        size: tuple[int, int] | None = None,
        *,
        speech_time: float = 30.0,
    ) -> None:
        """`size` in pixels, None: the world's aspect; what is said shows `speech_time` s."""
        self.size = default_size(backdrop.size) if size is None else check_size(size)
        self.projection = project(
            backdrop.size, [vertices for vertices, _ in backdrop.solids], self.size
        )
        ground = draw_ground(backdrop, self.projection)
        strip = ground[self.projection.field_height :]
        self._status = StatusLine(strip, backdrop.title, self.projection.scale)
        self._paint = PaintLayer(ground, solid_pixels(backdrop, self.projection), self.projection)
        self._bodies = Bodies(self.projection)
        self._movables = Bodies(self.projection)
        self._trails = Trails(self.projection)
        self._speech = Speech(speech_time)
        self._names: list[str] = []
        self._scratch = np.zeros_like(ground)
        self._drawn_until = -np.inf

    def add_robot(self, name: str, shape: Shape) -> int:
        """Adds a robot by its outline (k, 2) m in its own frame, or its radius; its index."""
        self._names.append(printable(name, 24))
        return self._bodies.add(shape)

    def draw(self, view: FrameView, out: NDArray[np.uint8] | None = None) -> NDArray[np.uint8]:
        """The frame of a view as (height, width, 3) BGR, in `out` where one is given."""
        image = np.empty_like(self._paint.image) if out is None else out
        poses = np.asarray(view.poses, dtype=float).reshape(-1, 3)
        if len(poses) != len(self._bodies):
            raise ValueError(f"{len(self._bodies)} robots were added, but {len(poses)} poses given")
        colors = colors_of(view.colors, len(poses))
        if view.floor is not None:
            self._paint.update(view.floor, view.resolution)
        if view.time > self._drawn_until:
            self._trails.mark(poses)
            self._drawn_until = view.time

        np.copyto(image, self._paint.image)
        field = image[: self.projection.field_height]
        scans = [Scan(*scan) for scan in view.scans[:MOST_SCANS]]
        draw_scans(field, self._scratch[: len(field)], scans, self.projection)
        self._trails.draw(field)
        self._draw_movables(field, view)
        self._bodies.draw(field, poses, colors)
        draw_drawings(field, view.drawings, self.projection)
        self._draw_names(field, poses)
        self._speech.draw(field, view, self.projection.edges(poses[:, :2]), self._bodies.radii)
        self._status.draw(image[len(field) :], view, len(poses))
        return image

    def _draw_movables(self, image: NDArray[np.uint8], view: FrameView) -> None:
        for shape, _ in view.movables[len(self._movables) :]:
            self._movables.add(shape, heading=False)
        if not view.movables:
            return
        colors = colors_of([color for _, color in view.movables], len(view.movable_poses))
        poses = np.asarray(view.movable_poses, dtype=float)
        self._movables.draw(image, poses, colors)

    def _draw_names(self, image: NDArray[np.uint8], poses: NDArray[np.float64]) -> None:
        count = len(self._names)
        if count > MOST_NAMES:
            return
        centres = self.projection.edges(poses[:, :2])
        for name, centre, radius in zip(self._names, centres, self._bodies.radii, strict=True):
            if radius >= SMALLEST_NAMED or count <= SMALL_COMPANY:
                below = centre[1] + radius + 8
                fits = below + 8 < len(image)
                draw_label(image, name, (centre[0], below if fits else centre[1] - radius - 8))


def save_picture(path: Path | str, picture: Picture, view: FrameView) -> Path:
    """Draws a view and writes it as PNG; raises VideoError where that cannot be done."""
    path = Path(path)
    if path.suffix.lower() != ".png":
        raise VideoError(f"{path}: a picture's name must end in .png")
    done, data = cv2.imencode(".png", picture.draw(view))
    if not done:
        raise VideoError(f"{path}: OpenCV could not encode the picture")
    try:
        path.write_bytes(data.tobytes())
    except OSError as error:
        raise VideoError(f"{path}: cannot be written ({error.strerror})") from error
    return path
