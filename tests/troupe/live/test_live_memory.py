"""What waits for pages is bounded, and how often a moment is due."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from unittest.mock import MagicMock

import numpy as np
import pytest

from sim.build import load
from sim.engine import Engine, Settings
from sim.fleet.fleet import Fleet
from sim.view.frames import CARDS, COLORS, POSES, STATES, decode
from sim.view.moment import Moment
from troupe.live.asks import Ask
from troupe.live.entrance import page_files
from troupe.live.exchange import MOST_ASKED, Exchange
from troupe.live.messages import Messages
from troupe.live.viewer import Viewer
from troupe.live.watch import Watch


def moment(tick: int) -> Moment:
    return Moment(
        0.1 * tick,
        tick,
        np.zeros((1, 3), np.float32),
        np.zeros(1, np.uint32),
        np.zeros(1, np.uint8),
    )


def test_only_the_latest_moment_is_kept() -> None:
    exchange = Exchange()
    for tick in range(100):
        exchange.offer(moment(tick))
    assert exchange.moment is not None
    assert exchange.moment.tick == 99


def test_a_later_wish_takes_the_place_of_an_earlier_one_of_its_kind() -> None:
    exchange = Exchange()
    for k in range(10_000):
        exchange.ask(Ask("put", k % 3, (float(k), 0.0, 0.0)))
    assert [ask.numbers[0] for ask in exchange.take()] == [9997.0, 9998.0, 9999.0]


def test_wishes_do_not_pile_up() -> None:
    exchange = Exchange()
    for robot in range(10_000):
        exchange.ask(Ask("put", robot, (0.0, 0.0, 0.0)))
    assert len(exchange.take()) == MOST_ASKED
    assert exchange.take() == []


def test_nothing_is_due_where_nobody_watches() -> None:
    exchange = Exchange()
    assert not exchange.due
    exchange.hungry = True
    assert exchange.due
    exchange.offer(moment(1))
    assert not exchange.due


def test_moments_that_cost_much_come_seldom() -> None:
    exchange = Exchange()
    exchange.offer(moment(1), cost=1000.0)
    exchange.hungry = True
    assert not exchange.due  # for 100,000 seconds


def test_what_the_server_does_for_viewers_makes_moments_seldom_too() -> None:
    exchange = Exchange()
    exchange.spend(1000.0)
    exchange.offer(moment(1))
    exchange.hungry = True
    assert not exchange.due


def test_a_run_that_has_time_to_spare_shows_all_that_it_can(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("troupe.live.exchange.PACED", 0.0)
    exchange = Exchange()
    exchange.offer(moment(1), cost=1000.0, idle=True)
    exchange.hungry = True
    assert exchange.due


@pytest.mark.parametrize(("pace", "idle"), [(None, False), (1e-6, True), (1e9, False)])
def test_a_run_has_time_to_spare_where_it_is_ahead_of_its_pace(
    pace: float | None, idle: bool, still: Path
) -> None:
    told = []

    class Noted(Exchange):
        def offer(self, moment: Moment, cost: float = 0.0, *, idle: bool = False) -> None:
            told.append(idle)

    engine = Engine(load(still), Settings(1, 10.0, realtime=pace), Fleet(), lambda line: None)
    engine.begin()
    engine.tick()
    watch = Watch(Noted())
    watch.each_tick(engine)
    watch.finish("interrupted")
    engine.crew.dismiss()
    assert told[0] is idle


def test_pages_that_know_the_same_are_sent_the_same_bytes() -> None:
    messages = Messages(read_only=False)
    one, two, late, chosen = (Viewer(MagicMock()) for _ in range(4))
    chosen.selected = (0,)
    first, second = moment(1), replace(moment(2), cards={0: {"name": "anna"}})
    assert messages.moment(1, first, one) is messages.moment(1, first, two)
    again = messages.moment(2, second, one)
    assert messages.moment(2, second, two) is again
    assert set(decode(again).sections) == {POSES}
    assert {POSES, COLORS, STATES} < set(decode(messages.moment(2, second, late)).sections)
    assert decode(messages.moment(2, second, chosen)).json(CARDS) == {"0": {"name": "anna"}}


def test_the_page_is_in_the_package() -> None:
    found = page_files()
    assert {"index.html", "style.css", "main.js", "frames.js"} <= set(found)
    assert all(b"http://" not in body and b"https://" not in body for body in found.values())
