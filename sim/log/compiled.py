"""The log's kernels are compiled by numba; code that is older than its sources is dropped."""

from __future__ import annotations

from pathlib import Path

from sensors.compiled import compiled, forget_stale_code, quick

__all__ = ["compiled", "quick"]

forget_stale_code(Path(__file__).parent)
