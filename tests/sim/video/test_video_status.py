"""The status line: its entries stand apart, however long they become."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.video.snapshot import Snapshot
from sim.video.status import GAP, MARGIN, StatusLine, status_entries
from sim.video.text import Lettering

PLAIN = Lettering()


def line(film_speed: float | None = None) -> StatusLine:
    return StatusLine((840, 26), "", 40.0, PLAIN, film_speed)


def snapshot(time: float) -> Snapshot:
    return Snapshot(time=time, poses=np.empty((0, 3)), colors=())


def drawn(time: float) -> NDArray[np.uint8]:
    """The status line (rows, width, 3) of a world without a title."""
    strip = np.zeros((26, 840, 3), np.uint8)
    line(10.0).draw_still(strip)
    line(10.0).draw(strip, snapshot(time), 3)
    return strip


@pytest.mark.parametrize("time", [0.0, 120.0, 9999.9, 123456.7, 12345678.9])
def test_the_time_does_not_run_into_what_stands_beside_it(time: float) -> None:
    strip, still = drawn(time), np.zeros((26, 840, 3), np.uint8)
    line(10.0).draw_still(still)
    end = MARGIN + PLAIN.width(f"{time:.1f} s")
    assert (strip[:, end : end + GAP] == still[:, end : end + GAP]).all()
    assert (strip[:, end + GAP :] != still[:, end + GAP :]).any()  # the next entry is there


def test_a_film_tells_its_own_speed_and_a_picture_tells_none() -> None:
    assert [text for text, _ in status_entries(snapshot(3.0), 2, 2.5)] == [
        "3.0 s", "film: 2.5 x", "2 robots",
    ]  # fmt: skip
    assert [text for text, _ in status_entries(snapshot(3.0), 1)] == ["3.0 s", "1 robot"]
