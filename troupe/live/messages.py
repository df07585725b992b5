"""What pages are sent, as bytes that are made once for all that know the same."""

from __future__ import annotations

from sim.view.frames import Frame, encode_moment, encode_scene
from sim.view.moment import Moment, Scene
from troupe.live.viewer import Viewer


class Messages:
    """The messages of the latest scene and the latest moment. `read_only`: as the scene tells."""

    def __init__(self, read_only: bool) -> None:
        self._about = {"read_only": read_only}
        self._scene: tuple[Scene | None, bytes] = (None, b"")
        self._frame: Frame | None = None
        self._number = -1
        self._made: dict[tuple[int, tuple[int, ...]], bytes] = {}

    def scene(self, scene: Scene) -> bytes:
        """The scene's message: the same for all."""
        if self._scene[0] is not scene:
            told = Scene({**scene.about, **self._about}, scene.solids)
            self._scene = scene, encode_scene(told)
        return self._scene[1]

    def moment(self, number: int, moment: Moment, viewer: Viewer) -> bytes:
        """The message of the `number`-th moment to a viewer, which takes note of it."""
        if self._frame is None or self._number != number:
            self._frame, self._number, self._made = Frame(moment), number, {}
        known = (viewer.moments, viewer.selected)  # by which its message is what it is
        if known not in self._made:
            self._made[known] = encode_moment(self._frame, viewer.frame, viewer.selected)
        viewer.frame, viewer.moments = self._frame, number
        return self._made[known]
