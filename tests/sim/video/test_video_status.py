"""The status line: its entries stand apart, however long they become."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.video.status import GAP, MARGIN, StatusLine
from sim.video.text import text_width
from sim.video.view import FrameView


def drawn(time: float, speed: float | None) -> NDArray[np.uint8]:
    """The status line (rows, width, 3) of a world without a title."""
    strip = np.zeros((26, 840, 3), np.uint8)
    line = StatusLine(strip, "", 40.0)
    line.draw(strip, FrameView(time=time, poses=np.empty((0, 3)), colors=(), speed=speed), 3)
    return strip


@pytest.mark.parametrize("time", [0.0, 120.0, 9999.9, 123456.7, 12345678.9])
def test_the_time_does_not_run_into_what_stands_beside_it(time: float) -> None:
    strip, still = drawn(time, 250.0), np.zeros((26, 840, 3), np.uint8)
    StatusLine(still, "", 40.0)
    end = MARGIN + text_width(f"{time:.1f} s")
    assert (strip[:, end : end + GAP] == still[:, end : end + GAP]).all()
    assert (strip[:, end + GAP :] != still[:, end + GAP :]).any()  # the next entry is there
