"""Frames drawn off screen and encoded as MP4.

`snapshot` says what a frame shows (numpy only), `recorder` makes the video while a run goes on,
`picture` draws one snapshot. Only the latter two load OpenCV and the encoder, so a run without
`--video` never pays for them.
"""

from sim.video.snapshot import Backdrop, Drawing, Scan, Shape, Sighting, Snapshot

__all__ = ["Backdrop", "Drawing", "Scan", "Shape", "Sighting", "Snapshot"]
