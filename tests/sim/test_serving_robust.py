"""Whatever a client sends or leaves undone: it loses its connection, and nobody else notices."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.sim.attacks import (
    ATTACKS,
    ONE_DRIVES,
    ROUNDS,
    Attack,
    commands_that_make_no_sense,
    drive,
)
from tests.sim.serving import Serving, write_world
from troupe.testing.wire import HEADER, REQ, SIMULATION, RawClient


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_world(tmp_path_factory.mktemp("robust"), ONE_DRIVES)


@pytest.fixture
def run(path: Path) -> Iterator[Serving]:
    with Serving(path) as serving:
        yield serving


@pytest.fixture(scope="module")
def undisturbed(path: Path) -> str:
    """The digest of the run that is left alone."""
    with Serving(path) as serving:
        return drive(serving)


@pytest.mark.parametrize("attack", ATTACKS)
def test_an_attack_costs_its_client_the_connection_and_changes_nothing(
    run: Serving, undisturbed: str, attack: Attack
) -> None:
    assert drive(run, attack) == undisturbed


def test_commands_that_make_no_sense_are_followed_by_those_that_do(
    run: Serving, undisturbed: str
) -> None:
    assert drive(run, commands_that_make_no_sense) == undisturbed
    assert sum("which is no number" in line for line in run.lines) == ROUNDS  # a line per client


def test_a_message_that_never_ends_is_waited_for_without_harm(
    run: Serving, undisturbed: str
) -> None:
    client = RawClient(run.port("one"))
    client.send(HEADER.pack(0, 0, SIMULATION, 0, REQ, 6, 0.0, 0, 1 << 20))

    def trickle(run: Serving, k: int) -> None:
        client.send(b"\0" * 1000)

    assert drive(run, trickle) == undisturbed
    client.close()
