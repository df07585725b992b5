"""The painted floor as changes: which cells were painted by whom, and the floor made of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.log.moment import Floor


class FloorMirror:
    """The floor as it was last written, to tell what has changed since."""

    def __init__(self, floor: Floor) -> None:
        self.floor = floor
        self.owner = np.zeros((floor.rows, floor.columns), np.int16)
        self.changed = False  # since somebody set it to False

    def changes(
        self, windows: Sequence[tuple[int, int, NDArray[np.int16]]]
    ) -> dict[str, Any] | None:
        """The values of a Paint message: what windows of a later floor show that is new, if any."""
        cells, owners = [], []
        for row, column, window in windows:
            height, width = window.shape
            known = self.owner[row : row + height, column : column + width]
            rows, columns = np.nonzero(known != window)
            if len(rows):
                cells.append((rows + row) * self.floor.columns + columns + column)
                owners.append(window[rows, columns])
                known[:] = window
        if not cells:
            return None
        self.changed = True
        return {
            "rows": self.floor.rows,
            "columns": self.floor.columns,
            "resolution": self.floor.resolution,
            "cells": np.concatenate(cells),
            "owners": np.concatenate(owners),
        }


def rebuilt(messages: Iterable[Mapping[str, Any]]) -> NDArray[np.int16] | None:
    """The floor (rows, columns) after Paint messages in their order; None where nothing painted."""
    owner: NDArray[np.int16] | None = None
    for one in messages:
        if owner is None:
            owner = np.zeros((one["rows"], one["columns"]), np.int16)
        owner.reshape(-1)[one["cells"]] = one["owners"].astype(np.int16)
    return owner
