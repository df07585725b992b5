"""The kernels of messages are compiled by numba; code that is older than its sources is dropped."""

from __future__ import annotations

from pathlib import Path

from sensors.compiled import compiled, forget_stale_code
from sim.stage import intrinsics

__all__ = ["compiled"]

forget_stale_code(Path(__file__).parent, Path(intrinsics.__file__).parent)
