"""Who waits for a compiler is told so, and a run's speed does not count it."""

from __future__ import annotations

import numba

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
