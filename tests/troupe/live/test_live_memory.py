"""What waits for pages is bounded: one moment each, and so many wishes."""

from __future__ import annotations

import numpy as np

from sim.view.moment import Moment
from troupe.live.asks import Ask
from troupe.live.entrance import page_files
from troupe.live.exchange import MOST_ASKED, Exchange


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
    assert not exchange.due  # for 50,000 seconds


def test_the_page_is_in_the_package() -> None:
    found = page_files()
    assert {"index.html", "style.css", "main.js", "frames.js"} <= set(found)
    assert all(b"http://" not in body and b"https://" not in body for body in found.values())
