"""What a table says of many runs: medians, and how sure they are."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

RESAMPLES = 2000
CONFIDENCE = 0.95
AT_ONCE = 4_000_000
"""Numbers that are drawn at once: 32 MB."""


@dataclass(frozen=True)
class Middle:
    """A median with its interval; NaN where there are no values."""

    median: float
    low: float
    high: float
    number: int


def middle(values: NDArray[np.float64], name: str) -> Middle:
    """The median of values (n,), and its 95 % interval by the percentile bootstrap.

    2000 resamples, drawn from a seed that follows from `name` alone: the same values give the same
    interval. (Efron and Tibshirani, An Introduction to the Bootstrap, 1993, section 13.3.)
    """
    number = len(values)
    if number == 0:
        return Middle(np.nan, np.nan, np.nan, 0)
    seed = int.from_bytes(hashlib.sha256(name.encode()).digest()[:8], "little")
    random = np.random.default_rng(seed)
    ordered = np.sort(values)
    medians: list[NDArray[np.float64]] = []
    rows = max(1, AT_ONCE // number)
    left = RESAMPLES
    while left > 0:
        # values are in order, so ranks are compared in place of them: they are smaller
        ranks = random.integers(number, size=(min(rows, left), number), dtype=np.int32)
        upper = number // 2
        lower = (number - 1) // 2
        ranks.partition((lower, upper) if lower != upper else lower, axis=1)
        medians.append((ordered[ranks[:, lower]] + ordered[ranks[:, upper]]) / 2)
        left -= rows
    tail = (1 - CONFIDENCE) / 2
    low, high = np.quantile(np.concatenate(medians), (tail, 1 - tail))
    return Middle(float(np.median(ordered)), float(low), float(high), number)
