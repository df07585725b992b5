"""Boxes that are sorted into cells are found as when all of them are looked at."""

import numpy as np
import pytest

from sim.stage.boxes import FEW, Boxes


@pytest.mark.parametrize("count", [FEW, FEW + 1, 6 * FEW])
def test_the_same_boxes_are_near_as_when_all_are_looked_at(count: int) -> None:
    random, boxes = np.random.default_rng(count), Boxes()
    low = random.uniform(-50.0, 50.0, (count, 2))
    high = low + random.uniform(0.0, 2.0, (count, 2))
    low[::40] -= 60.0  # some are large
    for k in range(count):
        boxes.add(low[k], high[k])
    for _ in range(50):
        at = random.uniform(-60.0, 60.0, 2)
        to = at + random.uniform(0.0, 9.0, 2)
        inside = ((low <= to) & (high >= at)).all(axis=1)
        assert boxes.near(at, to) == np.flatnonzero(inside).tolist()


def test_boxes_that_were_taken_back_are_not_found() -> None:
    boxes, spot = Boxes(), np.array([0.0, 0.0])
    for _ in range(3 * FEW):
        boxes.add(spot - 1.0, spot + 1.0)
    for kept in (2 * FEW, 5):
        boxes.back_to(kept)
        assert boxes.near(spot, spot) == list(range(kept))
    boxes.add(spot, spot)
    assert boxes.near(spot, spot) == [0, 1, 2, 3, 4, 5]
