"""The kinds of sensor by which a thing may be seen or not."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

Eye = Literal["laser", "ranger", "blobfinder", "fiducial", "bumper"]

EYES: dict[Eye, int] = {"laser": 1, "ranger": 2, "blobfinder": 4, "fiducial": 8, "bumper": 16}
"""Each kind of sensor's bit."""

EVERY_EYE = sum(EYES.values())

EYE_OF_KIND = {
    "scan": EYES["laser"],
    "elements": EYES["ranger"],
    "intensities": EYES["ranger"],
    "blobs": EYES["blobfinder"],
    "fiducials": EYES["fiducial"],
    "bits": EYES["bumper"],
    "scalars": 0,
}
"""With which eye sensors of each kind of readings look; 0: they see everything."""


def eyes(names: Iterable[Eye] | None) -> int:
    """The bits of some kinds of sensor; None stands for all of them."""
    return EVERY_EYE if names is None else sum({EYES[name] for name in names})
