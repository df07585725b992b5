"""Pages that look on, many, stopped or slow: the run is the same, and what is kept is little."""

from __future__ import annotations

import contextlib
import socket
import threading
from pathlib import Path

import pytest
from watching import Deaf, Viewer, stepped, watched
from websockets.exceptions import ConnectionClosed

import troupe
from sim.view.frames import MOMENT, STATUS


class Draws(threading.Thread):
    """A viewer that takes every moment that it gets."""

    def __init__(self, address: str) -> None:
        super().__init__(daemon=True)
        self.viewer, self.seen = Viewer(address), 0
        self.viewer.ask(do="select", robots=[0, 3])

    def run(self) -> None:
        with contextlib.suppress(ConnectionClosed):
            while True:
                self.viewer.message()
                self.seen += 1


class Slow(threading.Thread):
    """A viewer at the end of a slow line: bite by bite, each when somebody else has seen more."""

    def __init__(self, address: str, other: Draws) -> None:
        super().__init__(daemon=True)
        self.line, self.other, self.taken = Deaf(address), other, 0

    def run(self) -> None:
        seen = 0
        while bite := self.line.bite(100):
            self.taken += len(bite)
            while self.other.is_alive() and self.other.seen == seen:
                self.other.join(0.001)
            seen = self.other.seen


@pytest.fixture(scope="module")
def alone() -> str:
    """The digest of a run that nobody watches."""
    return troupe.run("wander", duration=6.0).digest


@pytest.mark.parametrize("viewers", [0, 1, 5])
def test_however_many_watch_the_digest_is_the_same(viewers: int, alone: str) -> None:
    with watched("wander", duration=6.0, paused=bool(viewers)) as run:
        them = [Draws(run.address) for _ in range(viewers)]
        for viewer in them:
            viewer.start()
        if viewers:
            them[0].viewer.ask(do="go")
        result = run.result()
    assert result.digest == alone
    assert all(viewer.seen > 1 for viewer in them)


def test_stopped_pages_and_slow_lines_change_nothing_either(alone: str) -> None:
    with watched("wander", duration=6.0, paused=True) as run:
        draws = Draws(run.address)
        slow, deaf, stopped = Slow(run.address, draws), Deaf(run.address), Viewer(run.address)
        stopped.message()  # the scene; then it stands, as in a debugger
        draws.start()
        slow.start()
        deaf.ask(do="select", robots=[1, 2])
        draws.viewer.ask(do="go")
        result = run.result()
    assert result.digest == alone
    assert slow.taken > 1000
    assert draws.seen > 1


def test_the_end_of_a_run_waits_for_no_page_that_stands(
    still: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("troupe.live.server.LAST_WORDS", 1e9)  # for a page that draws
    monkeypatch.setattr("troupe.live.viewer.PROMPT", 0.05)
    with watched(still, paused=True, duration=0.5) as run:
        stopped, viewer = Deaf(run.address), Viewer(run.address)
        viewer.until(lambda m: m.kind == MOMENT)
        viewer.ask(do="go")
        with contextlib.suppress(ConnectionClosed):  # on a busy machine it is no prompt page either
            viewer.until(lambda m: STATUS in m.sections and m.json(STATUS)["outcome"] is not None)
        assert run.result().outcome == "completed"
        stopped.close()


def test_what_is_kept_for_a_page_that_takes_nothing_is_bounded(still: Path) -> None:
    with watched(still, paused=True) as run:
        deaf, viewer = Deaf(run.address), Viewer(run.address)
        viewer.until(lambda m: m.kind == MOMENT)
        assert run.view is not None
        lines = [one.line.transport for one in run.view.server.viewers]
        for line in lines:
            line.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 2048)
        sizes = []
        for turn in range(100):
            viewer.ask(do="select", robots=[turn % 2])
            deaf.ask(do="seen")  # it says that it takes them
            wanted = str(turn % 2)
            found = viewer.until(lambda m, wanted=wanted: 17 in m.sections and wanted in m.json(17))
            sizes.append(sum(map(len, found.sections.values())))
        waiting = [line.get_write_buffer_size() for line in lines]
        assert stepped(viewer)
    assert sum(sizes) > 2 * (1 << 16)
    assert 0 < max(waiting) < (1 << 16) + 2 * max(sizes)
