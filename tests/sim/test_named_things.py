"""Obstacles have names, by which clients with full access find them and put them elsewhere."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from pathlib import Path

import pytest

from sim.build import load
from sim.worldfile import WorldError
from tests.sim.serving import Serving, write_world
from troupe.testing.wire import ACK, NACK, SIMULATION, RawClient, pulling, text

WORLD = """\
size: [20, 20]
obstacles:
  - {shape: box, size: [1, 1], pose: [2, 2, 0]}
  - {shape: circle, radius: 0.2, pose: [6, 6, 0], movable: true, mass: 1}
  - {shape: box, size: [2, 1], pose: [15, 5, 90], name: shelf, z: 0.25}
  - {shape: circle, radius: 0.2, pose: [10, 12, 45], movable: true, name: puck, mass: 1}
models:
  rover: {body: {shape: circle, radius: 0.3}, simulation: full}
  shy: {body: {shape: circle, radius: 0.3}}
robots:
  - {name: one, model: rover, pose: [10, 10, 0], controller: hand}
  - {name: two, model: shy, pose: [17, 10, 0], controller: hand}
controllers: {hand: {external: true}}
"""


@pytest.fixture
def run(tmp_path: Path) -> Iterator[Serving]:
    with Serving(write_world(tmp_path, WORLD)) as serving:
        yield serving


def where(client: RawClient, name: str) -> tuple[float, ...] | None:
    got = client.request(SIMULATION, 0, 1, text(name) + bytes(24))
    return struct.unpack(">3d", got.payload[-24:]) if got.type == ACK else None


def put(client: RawClient, name: str, x: float, y: float, yaw: float = 0.0) -> int:
    return client.request(SIMULATION, 0, 2, text(name) + struct.pack(">3d", x, y, yaw)).type


def test_every_obstacle_with_a_name_is_found_by_it(run: Serving) -> None:
    with pulling(run.port("one")) as client:
        assert where(client, "shelf") == pytest.approx((15, 5, math.pi / 2))
        assert where(client, "puck") == pytest.approx((10, 12, math.pi / 4))
        assert where(client, "one") == pytest.approx((10, 10, 0))
        assert where(client, "wall") is None
        pose3d = client.request(SIMULATION, 0, 3, text("puck") + bytes(56))
        assert struct.unpack(">7d", pose3d.payload[-56:]) == pytest.approx(
            (10, 12, 0, 0, 0, math.pi / 4, 0)
        )
        pose3d = client.request(SIMULATION, 0, 3, text("shelf") + bytes(56))
        assert struct.unpack(">7d", pose3d.payload[-56:])[2] == 0.25


def test_who_may_not_see_robots_poses_may_not_see_things(run: Serving) -> None:
    with pulling(run.port("two")) as client:
        assert where(client, "puck") is None
        assert put(client, "puck", 3, 3) == NACK


def one_round(run: Serving, one: RawClient) -> None:
    with pulling(run.port("two")) as two:
        two.ask()
        one.round()


def test_what_can_be_pushed_is_put_where_there_is_room_at_the_next_tick(run: Serving) -> None:
    with pulling(run.port("one")) as client:
        assert put(client, "puck", 4, 3, 1.0) == ACK
        assert where(client, "puck") == pytest.approx((4, 3, 1.0))  # who asked finds it there
        assert run.engine.scenery.stage.movable_poses[1, :2] == pytest.approx((10, 12))
        one_round(run, client)
        assert run.engine.scenery.stage.movable_poses[1] == pytest.approx((4, 3, 1.0), abs=1e-6)
        assert where(client, "puck") == pytest.approx((4, 3, 1.0), abs=1e-6)
        for x, y in ((2, 2), (10, 10), (6, 6), (25, 5), (math.nan, 1)):
            assert put(client, "puck", x, y) == NACK
        # where one thing makes room another may be put, all before the same tick
        assert put(client, "one", 12, 15) == ACK
        assert where(client, "one") == pytest.approx((12, 15, 0))
        assert put(client, "puck", 10, 10) == ACK
        one_round(run, client)
        assert run.pose(0)[:2] == pytest.approx((12, 15))
        assert where(client, "puck") == pytest.approx((10, 10, 0), abs=1e-6)


def test_what_stands_is_put_elsewhere_too_and_back_at_a_reset(run: Serving) -> None:
    with pulling(run.port("one")) as client:
        for x, y in ((10, 10), (6, 6), (25, 5), (math.nan, 1)):
            assert put(client, "shelf", x, y) == NACK  # robots, pucks, the outside
        assert put(client, "shelf", 2, 2.2) == ACK  # what stands may overlap
        assert put(client, "shelf", 4, 4, 0.5) == ACK
        assert where(client, "shelf") == pytest.approx((4, 4, 0.5))
        one_round(run, client)
        assert run.engine.scenery.stage.layout.fixtures[0].pose == pytest.approx((4, 4, 0.5))
        assert where(client, "shelf") == pytest.approx((4, 4, 0.5))
        assert put(client, "one", 4, 4) == NACK
        assert put(client, "one", 15, 5) == ACK
        one_round(run, client)
        assert run.pose(0)[:2] == pytest.approx((15, 5))
        client.command(SIMULATION, 0, 2, b"")
        one_round(run, client)
        assert where(client, "shelf") == pytest.approx((15, 5, math.pi / 2))
        assert run.pose(0)[:2] == pytest.approx((10, 10))


@pytest.mark.parametrize(
    ("second", "more", "says"),
    [
        ("shelf", "", "obstacles.0 has this name"),
        ("one", "", "robots.0 has a robot of this name"),
        ("s2", "s", "a robot from doors.0 may be called so"),
    ],
)
def test_a_name_that_somebody_has_already_is_a_mistake(
    tmp_path: Path, second: str, more: str, says: str
) -> None:
    door = "doors: [{name: s, at: [5.5, 5.5], model: rover, period: 1}]\n" * bool(more)
    path = write_world(
        tmp_path,
        f"""\
size: [20, 20]
obstacles:
  - {{shape: circle, radius: 0.2, pose: [3, 3, 0], name: shelf}}
  - {{shape: circle, radius: 0.2, pose: [9, 3, 0], name: {second}}}
models: {{rover: {{body: {{shape: circle, radius: 0.3}}}}}}
robots: [{{name: one, model: rover, pose: [10, 10, 0]}}]
{door}""",
    )
    with pytest.raises(WorldError) as caught:
        load(path)
    assert [mistake.where for mistake in caught.value.mistakes] == [("obstacles", 1, "name")]
    assert says in str(caught.value)
