"""Frames drawn off screen and encoded as MP4.

`view` says what a frame shows (numpy only), `recorder` makes the video while a run goes on,
`picture` draws one view. Only the latter two load OpenCV and the encoder, so a run without
`--video` never pays for them.
"""

from sim.video.view import Backdrop, Drawing, FrameView, Scan, Shape, Sighting

__all__ = ["Backdrop", "Drawing", "FrameView", "Scan", "Shape", "Sighting"]
