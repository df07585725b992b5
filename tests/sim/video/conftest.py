"""An arena of 16 x 21 m: what most tests of the video look at."""

from __future__ import annotations

import pytest
from video_arenas import walled

from sim.video import Backdrop


@pytest.fixture
def arena() -> Backdrop:
    return walled(16, 21)
