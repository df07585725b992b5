"""A configuration that a laser cannot have is refused, and its client goes on with what it had."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator

import pytest

from tests.sim.serving import Serving, write_world
from troupe.testing.wire import ACK, LASER, NACK, RANGER, RawClient, pulling

WORLD = """\
size: [20, 20]
models:
  rover:
    body: {shape: circle, radius: 0.3}
    sensors: [{type: laser, range: 8, fov: 180, samples: 181}]
robots: [{name: one, model: rover, pose: [10, 10, 0], controller: hand}]
controllers: {hand: {external: true}}
"""

DEGREE = math.pi / 180
OWN = {"min": -math.pi / 2, "max": math.pi / 2, "resolution": DEGREE, "range": 8.0, "apart": 0.02}
RUBBISH = 3.1e-41  # what stood in memory where libplayerc sends the range
SLACK = 1e-5  # of a degree in radians, and far below a step


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RawClient]:
    with (
        Serving(write_world(tmp_path_factory.mktemp("laser"), WORLD)) as run,
        pulling(run.port("one"), (LASER, 0)) as one,
    ):
        yield one


def configure(client: RawClient, **asked: float) -> int:
    values = OWN | asked
    config = [values[name] for name in ("min", "max", "resolution", "range", "apart")]
    return client.request(LASER, 0, 2, struct.pack(">5fIf", *config, 0, 10.0)).type


def rays(client: RawClient) -> tuple[int, ...]:
    return struct.unpack(">I", client.round()[LASER, 0, 1].payload[16:20])


@pytest.mark.parametrize(
    "asked",
    [
        {"range": RUBBISH},
        {"range": 0.0},
        {"range": -1.0},
        {"range": 8.1},
        {"range": math.inf},
        {"range": math.nan},
        {"range": 0.5, "apart": 1.0},  # not as far as it can tell apart
        {"apart": math.nan},
        {"min": -math.pi / 2 - DEGREE},
        {"max": math.pi / 2 + DEGREE},
        {"min": -math.inf},
        {"max": math.nan},
        {"min": 0.5, "max": -0.5},
        {"min": 0.2, "max": 0.2 + 0.5 * DEGREE},  # one ray at the most
        {"min": 0.1 * DEGREE, "max": 0.9 * DEGREE},  # between two rays
        {"resolution": 100.0},  # in hundredths of a degree, as programs of Player's have it
        {"resolution": 1.5 * math.pi},  # the first ray, and no other
        {"resolution": 0.5 * DEGREE},
        {"resolution": 0.0},
        {"resolution": -DEGREE},
        {"resolution": math.nan},
    ],
    ids=str,
)
def test_what_the_laser_cannot_have_is_refused_and_nothing_has_changed(
    client: RawClient, asked: dict[str, float]
) -> None:
    before = client.request(LASER, 0, 3).payload
    assert configure(client, **asked) == NACK
    assert client.request(LASER, 0, 3).payload == before
    assert rays(client) == (181,)


@pytest.mark.parametrize(
    ("asked", "left"),
    [
        ({}, 181),
        ({"min": -math.pi / 2 - SLACK, "max": math.pi / 2 + SLACK}, 181),
        ({"resolution": math.pi / 181}, 181),  # Stage's: the angle by the rays
        ({"resolution": math.pi}, 2),
        ({"min": 0.0, "max": DEGREE}, 2),
        ({"min": -0.4 * DEGREE, "max": 1.4 * DEGREE}, 2),
        ({"resolution": 2 * DEGREE, "range": 4.0}, 91),
    ],
    ids=str,
)
def test_a_part_of_what_it_has_is_granted(
    client: RawClient, asked: dict[str, float], left: int
) -> None:
    assert configure(client, **asked) == ACK
    assert rays(client) == (left,)
    assert configure(client) == ACK


def test_what_it_says_it_is_can_be_asked_for(client: RawClient) -> None:
    assert client.request(LASER, 0, 2, client.request(LASER, 0, 3).payload).type == ACK
    assert rays(client) == (181,)


def test_a_ranger_takes_no_configuration_at_all(client: RawClient) -> None:
    own = client.request(RANGER, 0, 5).payload
    assert client.request(RANGER, 0, 4, own).type == NACK
    assert client.request(RANGER, 0, 5).payload == own
