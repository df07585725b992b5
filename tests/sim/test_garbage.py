"""Garbage is looked for as Python has been told to, also where a crowd is made meanwhile."""

from __future__ import annotations

import gc
from collections.abc import Iterator

import pytest

from sim import garbage


@pytest.fixture
def passes() -> Iterator[list[int]]:
    """The generations that Python has looked through."""
    seen: list[int] = []

    def look(phase: str, about: dict[str, int]) -> None:
        if phase == "start":
            seen.append(about["generation"])

    gc.callbacks.append(look)
    yield seen
    gc.callbacks.remove(look)


def make(number: int) -> list[list[int]]:
    """So many objects, all of which are looked through."""
    return [[] for _ in range(number)]


def test_a_crowd_is_looked_through_once_when_it_is_there(passes: list[int]) -> None:
    with garbage.kept_objects(garbage.CROWD):
        crowd = make(20 * garbage.CROWD)
        assert not passes
    assert passes == [2]
    del crowd


def test_for_a_few_nobody_looks_through_everything(passes: list[int]) -> None:
    with garbage.kept_objects(4):
        few = make(20)
        assert not passes
    assert 2 not in passes
    del few


def test_where_nobody_was_to_look_nobody_does(passes: list[int]) -> None:
    gc.disable()
    try:
        with garbage.kept_objects(garbage.CROWD):
            crowd = make(20 * garbage.CROWD)
        assert not gc.isenabled()
    finally:
        gc.enable()
    assert 2 not in passes
    del crowd


def test_an_error_meanwhile_leaves_all_as_it_was() -> None:
    with pytest.raises(ValueError, match="no room"), garbage.kept_objects(garbage.CROWD):
        raise ValueError("no room")
    assert gc.isenabled()
