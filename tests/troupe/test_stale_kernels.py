"""A compiled kernel follows the sources that it draws upon, not only its own."""

from __future__ import annotations

from pathlib import Path

from tests import started

KERNEL = """\
import sys
sys.dont_write_bytecode = True
import constants
import numba
from gridworld.compiled import keyed


def price(x):
    return x * constants.FACTOR


price = numba.njit(numba.int64(numba.int64), cache=True)(keyed(price, constants))
print(price(7), sum(price.stats.cache_hits.values()))
"""


def test_a_kernel_is_compiled_anew_when_a_constant_of_another_file_has_changed(
    tmp_path: Path,
) -> None:
    (tmp_path / "kernel.py").write_text(KERNEL)
    found = []
    for factor in (2, 2, 3):
        (tmp_path / "constants.py").write_text(f"FACTOR = {factor}\n")
        done = started.troupe(program=tmp_path / "kernel.py")
        assert done.returncode == 0, done.stderr
        found.append(done.stdout.split())
    assert found == [["14", "0"], ["14", "1"], ["21", "0"]]  # the result, and hits of the cache


def test_the_grids_step_goes_by_the_vocabulary_and_by_chance() -> None:
    from controllers.dispersal import chance, vocabulary  # noqa: PLC0415
    from gridworld import compiled, step  # noqa: PLC0415

    name = step.advance.py_func.__qualname__
    assert name == compiled.keyed(lambda: None, chance, compiled, vocabulary).__qualname__.replace(
        "<lambda>", "_advance"
    )
