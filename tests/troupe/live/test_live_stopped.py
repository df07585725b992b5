"""A real browser that stands, by a signal or in its debugger: the run goes on and is the same."""

from __future__ import annotations

import contextlib
import os
import signal
import uuid
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from time import monotonic
from typing import Any

import browsing
import pytest
from browsing import Page, chromium
from watching import Viewer, watched

import troupe
from sim.view.frames import MOMENT
from tests.patience import PATIENCE
from tests.processes import marked
from troupe.live.viewer import UNDER_WAY

pytestmark = browsing.NEEDED
MARK = uuid.uuid4().hex
STEPS = 10


@pytest.fixture(scope="module")
def page() -> Iterator[Any]:
    """An empty page of a headless Chromium, whose processes have the mark."""
    with chromium(env={**os.environ, "TROUPE_TEST": MARK}) as browser:
        yield browser.new_page()


@contextlib.contextmanager
def stopped(page: Any) -> Iterator[None]:
    """No process of the browser goes on."""
    known = marked(MARK)  # those that draw have no environment to be seen
    processes = {*known, *(child for one in known for child in one.children(recursive=True))}
    assert processes
    for process in processes:
        process.send_signal(signal.SIGSTOP)
    try:
        yield
    finally:
        for process in processes:
            process.send_signal(signal.SIGCONT)


@contextlib.contextmanager
def debugged(page: Any) -> Iterator[None]:
    """The page's scripts stand, and the browser takes what comes."""
    stands: list[Any] = []
    debugger = page.context.new_cdp_session(page)

    def note(where: Any) -> None:
        stands.append(where)

    debugger.on("Debugger.paused", note)
    debugger.send("Debugger.enable")
    debugger.send("Debugger.pause")
    until = monotonic() + PATIENCE
    while not stands and monotonic() < until:
        page.wait_for_timeout(10)  # hears what the debugger tells
    assert stands
    try:
        yield
    finally:
        debugger.send("Debugger.resume")


@pytest.fixture(scope="module")
def alone() -> str:
    """The digest of a run that nobody watches."""
    return troupe.run("wander", duration=6.0).digest


@pytest.mark.parametrize("stand", [stopped, debugged])
def test_a_run_goes_on_while_a_browser_stands_and_sends_it_two_moments(
    stand: Callable[[Any], AbstractContextManager[None]], page: Any, alone: str
) -> None:
    with watched("wander", duration=6.0, paused=True) as run:
        Page(page, run.address)
        assert run.view is not None
        (standing,) = run.view.server.viewers
        with stand(page):
            other = Viewer(run.address)
            for tick in range(1, STEPS + 1):
                other.ask(do="step")
                other.until(lambda m, tick=tick: m.kind == MOMENT and m.tick >= tick)
            assert standing.under_way == UNDER_WAY
            other.ask(do="go")
            result = run.result()  # while the browser stands
        assert result.digest == alone
        assert standing.under_way == UNDER_WAY + 1  # and what the run ended with
    assert page.evaluate("() => 1 + 1") == 2
