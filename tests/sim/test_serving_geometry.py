"""What clients are told of sizes and places: of the body, and of a laser's housing."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator

import pytest

from tests.sim.serving import Serving, write_world
from troupe.testing.wire import ACK, LASER, POSITION2D, RANGER, RawClient, pulling

# a pioneer's box, the middle of which is 4 cm behind its axle
WORLD = """\
size: [20, 20]
models:
  pioneer:
    body: {shape: polygon, points: [[-0.26, -0.19], [0.18, -0.19], [0.18, 0.19], [-0.26, 0.19]]}
    sensors:
      - {type: laser, pose: [0.03, 0, 0], housing: [0.156, 0.155]}
      - {type: laser}
      - {type: ranger, housing: [0.1, 0.2]}
robots: [{name: one, model: pioneer, pose: [10, 10, 0], controller: hand}]
controllers: {hand: {external: true}}
"""


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RawClient]:
    folder = tmp_path_factory.mktemp("geometry")
    with Serving(write_world(folder, WORLD)) as run, pulling(run.port("one")) as one:
        yield one


def geometry(client: RawClient, interface: int, index: int) -> tuple[float, ...]:
    """x, y and yaw of the pose, then length and width."""
    x, y, *_, yaw, width, length, _ = struct.unpack(
        ">9d", client.request(interface, index, 1).payload[:72]
    )
    return (x, y, yaw, length, width)


def test_the_drive_tells_where_the_bodys_middle_is(client: RawClient) -> None:
    told = geometry(client, POSITION2D, 0)
    assert told == pytest.approx((-0.04, 0.0, 0.0, 0.44, 0.38), abs=1e-9)


@pytest.mark.parametrize(
    ("interface", "index", "told"),
    [
        (LASER, 0, (0.03, 0, 0, 0.156, 0.155)),
        (LASER, 1, (0, 0, 0, 0.02, 0.02)),
        (RANGER, 0, (0, 0, 0, 0.1, 0.2)),
        (RANGER, 1, (0.03, 0, 0, 0.156, 0.155)),  # the first laser's twin
    ],
)
def test_a_range_finder_tells_its_mount_and_its_housing(
    client: RawClient, interface: int, index: int, told: tuple[float, ...]
) -> None:
    assert geometry(client, interface, index) == pytest.approx(told, abs=1e-9)


def test_odometry_that_is_set_to_half_a_turn_reads_half_a_turn(client: RawClient) -> None:
    for told in (math.pi, -math.pi):
        assert client.request(POSITION2D, 0, 5, struct.pack(">3d", 1, 2, told)).type == ACK
        for _ in range(2):
            got = client.round()[POSITION2D, 0, 1].unpack("6dI")[:3]
            assert got == pytest.approx((1, 2, math.pi), abs=1e-9)
