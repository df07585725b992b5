"""Who waits for a compiler is told so, and a run's speed does not count it."""

from __future__ import annotations

from pathlib import Path

import numba
import pytest

import troupe
from sim.engine import Engine
from troupe.compiling import NOTICE, Compiling
from troupe.running import run_file


def fresh_kernel() -> object:
    """A kernel that nobody has compiled yet."""
    return numba.njit(lambda x: x + 1)


def test_the_first_kernel_is_told_and_no_other() -> None:
    lines: list[str] = []
    with Compiling(lines.append) as compiling:
        inner = numba.njit(lambda x: x + 1)
        outer = numba.njit(lambda x: inner(x) * 2)
        assert outer(3) == 8
        assert fresh_kernel()(1.0) == 2.0  # type: ignore[operator]
        assert outer(4) == 10
    assert lines == [NOTICE]
    assert len(compiling.spans) == 2  # one within another counts once
    assert fresh_kernel()(1) == 2  # type: ignore[operator]
    assert len(compiling.spans) == 2  # nobody listens any more
    assert compiling.after(compiling.spans[1][0]) > 0
    assert compiling.after(0.0) == 0.0


def test_the_speed_of_a_run_does_not_count_what_is_compiled_in_it() -> None:
    began: list[float] = []
    lines: list[str] = []

    def each_tick(engine: Engine) -> None:
        began.append(engine.began)
        if engine.ticks == 3:
            fresh_kernel()(1)  # type: ignore[operator]

    run_file(
        "wander", seed=1, duration=1.0, settings=(), realtime=None, listen=None, patience=60.0,
        video=None, video_fps=None, video_speed=None, video_size=None, say=lines.append,
        each_tick=each_tick,
    )  # fmt: skip
    assert len(began) == 10
    assert began[1] == began[2]
    assert began[3] > began[2]
    assert began[4:] == [began[3]] * 6
    assert lines.count(NOTICE) == 1


def test_who_opens_a_run_from_python_is_told_that_kernels_are_compiled_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    compiled: list[bool] = []
    monkeypatch.setattr("troupe.warm.looked", [])
    monkeypatch.setattr("troupe.kernel_cache.cache_folder", lambda: tmp_path)
    monkeypatch.setattr("troupe.warm.compile_all", lambda: compiled.append(True))
    for _ in range(2):
        with troupe.Simulation("wander", controllers=False):
            pass
    assert compiled == [True]
    assert capsys.readouterr().err.count("compiling the kernels for this machine, only once") == 1
    monkeypatch.setattr("troupe.warm.looked", [])
    for mark in tmp_path.glob("*.warm"):
        mark.unlink()
    lines: list[str] = []
    with troupe.Simulation("wander", controllers=False, say=lines.append):
        pass
    assert len([line for line in lines if "compiling the kernels" in line]) == 1
    assert capsys.readouterr().err == ""
