"""What a run tells about its sensors' ends, cameras and marks, as our own proxies read it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from player import (
    BlobfinderProxy,
    DeviceAddr,
    FiducialProxy,
    Interface,
    LaserProxy,
    PlayerClient,
    PlayerRefused,
    Position2dProxy,
    RangerProxy,
    SimulationProxy,
)
from tests.sim.served_world import ONE, TWO, WORLD, placed
from tests.sim.serving import Serving, write_world

Robot = Callable[..., PlayerClient]
"""What the fixture `robot` gives: a client of robot `one` in a run of that world."""


@pytest.fixture
def robot(tmp_path: Path) -> Iterator[Robot]:
    open_: list[tuple[Serving, PlayerClient]] = []

    def client_of(world: str) -> PlayerClient:
        serving = Serving(write_world(tmp_path, world))
        client = PlayerClient("127.0.0.1", serving.port("one"), timeout=600.0, environ={})
        open_.append((serving, client))
        return client

    yield client_of
    for serving, client in open_:
        client.close()
        serving.stop()


def facing_a_wall(distance: float, sensor: str) -> str:
    """A robot whose sensor looks at the boundary from that distance."""
    return f"""\
size: [20, 20]
models:
  seer: {{body: {{shape: circle, radius: 0.2}}, sensors: [{{{sensor}}}]}}
robots: [{{name: one, model: seer, pose: [{20 - distance!r}, 10, 0], controller: hand}}]
controllers: {{hand: {{external: true}}}}
"""


def test_a_program_started_by_hand_reports_of_the_robot_whose_port_it_is_at(robot: Robot) -> None:
    client = robot(facing_a_wall(5.0, "type: laser"))
    base, simulation = Position2dProxy(client), SimulationProxy(client)
    simulation.report("rank", 3)
    assert simulation.get_property("", "rank") == simulation.get_property("one", "rank") == b"3"
    assert client.read()
    assert client.read()
    assert base.valid
    assert simulation.get_property("one", "rank") == b"3"
    with pytest.raises(PlayerRefused):
        simulation.set_property("nobody", "rank", b"3")
    with pytest.raises(PlayerRefused):
        simulation.get_pose2d("")


NEAR_THE_END = 5.0 - 1e-8
"""Metres: as a float32 that is 5.0, the sensors' range in the tests below."""


@pytest.mark.parametrize(("distance", "hit"), [(NEAR_THE_END, True), (5.01, False)])
def test_a_hit_at_the_end_of_the_range_is_told_from_nothing(
    robot: Robot, distance: float, hit: bool
) -> None:
    client = robot(facing_a_wall(distance, "type: laser, range: 5, fov: 2, samples: 3"))
    Position2dProxy(client)
    laser, twin = LaserProxy(client), RangerProxy(client)
    for _ in range(2):
        assert client.read()
        assert laser.ranges == pytest.approx([5.0] * 3, abs=1e-2)  # 1 degree aside: 0.8 mm more
        assert laser.hits.tolist() == twin.hits.tolist() == [False, hit, False]
        # the same where a client has configured the scan
        laser.configure(laser.request_configuration()._replace(intensity=True))


def test_a_scan_cut_short_hits_what_is_at_its_new_end(robot: Robot) -> None:
    client = robot(facing_a_wall(NEAR_THE_END, "type: laser, range: 8, fov: 2, samples: 3"))
    Position2dProxy(client)
    laser = LaserProxy(client)
    whole = laser.request_configuration()
    laser.configure(whole._replace(max_range=5.0, intensity=True))
    assert client.read()
    assert laser.max_range == 5.0
    assert laser.hits.tolist() == [False, True, False]
    assert (laser.intensity != 0).tolist() == laser.hits.tolist()


@pytest.mark.parametrize(
    "sensor",
    [
        "type: laser, range: 5, noise: 0.5, fov: 2, samples: 9",
        "type: ranger, range: 5, noise: 0.5, elements: [[0, 0, 0], [0, 0, 1], [0, 0, -1]]",
        "type: ranger, range: 5, noise: 0.5, fov: 2, samples: 9",
    ],
)
def test_noise_never_turns_a_hit_into_nothing(robot: Robot, sensor: str) -> None:
    client = robot(facing_a_wall(4.9, sensor))
    Position2dProxy(client)
    proxy = LaserProxy(client) if "laser" in sensor else RangerProxy(client)
    most = 0.0
    for _ in range(20):
        assert client.read()
        assert proxy.hits.all()
        most = max(most, float(proxy.ranges.max()))
    # of at least 60 readings four in ten reach the end: that none did has a chance of 1e-14
    assert most == pytest.approx(5.0, abs=1e-6)


@pytest.mark.parametrize(
    ("distance", "reads"), [(0.5, 0.5), (0.3001, 0.3001), (0.2999, 0.0), (0.21, 0.0)]
)
@pytest.mark.parametrize(
    "sensor",
    [
        "type: laser, range: 5, min_range: 0.3, fov: 2, samples: 3",
        "type: ranger, range: 5, min_range: 0.3, fov: 2, samples: 3",
        "type: ranger, range: 5, min_range: 0.3, fov: 2",
    ],
)
def test_what_is_nearer_than_the_least_range_reads_0(
    robot: Robot, sensor: str, distance: float, reads: float
) -> None:
    client = robot(facing_a_wall(distance, sensor))
    Position2dProxy(client)
    ranger = RangerProxy(client)
    assert client.read()
    middle = ranger.count // 2
    assert ranger.ranges[middle] == pytest.approx(reads, abs=1e-9)
    assert ranger.hits.all()
    assert ranger.config is not None
    assert (ranger.config.min_range, ranger.config.max_range) == (0.3, 5.0)
    if "laser" in sensor:
        laser = LaserProxy(client)
        assert client.read()
        assert laser.ranges[middle] == np.float32(ranger.ranges[middle])


def test_a_blobs_bearing_is_where_the_thing_is(robot: Robot) -> None:
    client = robot(WORLD.replace("pose: [6.5, 5.5, -100], controller: hand", "pose: [6.5, 5.5, 0]"))
    Position2dProxy(client)
    camera = BlobfinderProxy(client)
    assert client.read()
    assert camera.fov == math.pi
    [two] = [blob for blob in camera.blobs if blob.color == 0x0000FF]
    seen_from = placed(ONE, 0.0, 0.0)
    truth = math.atan2(TWO[1] - seen_from[1], TWO[0] - seen_from[0]) - ONE[2]
    column = math.pi / 159
    # each end of the blob is a column at most from where the thing's edge is: so is the middle
    assert two.bearing == pytest.approx(truth, abs=column)


def test_no_other_property_of_a_camera_is_told(robot: Robot) -> None:
    client = robot(WORLD.replace(", controller: hand}\nobs", "}\nobs"))
    Position2dProxy(client)
    camera = DeviceAddr(Interface.BLOBFINDER, 0)
    with pytest.raises(PlayerRefused):
        client.request(camera, 252, {"key": "zoom", "value": 0.0})
    with pytest.raises(PlayerRefused):
        client.request(camera, 251, {"key": "fov", "value": 1.0})
    assert client.request(camera, 252, {"key": "fov", "value": 0.0})["value"] == math.pi


def test_a_robot_without_a_finder_sees_no_marks_from_its_first_reading_on(robot: Robot) -> None:
    client = robot(
        "size: [9, 9]\n"
        "models: {marked: {body: {shape: circle, radius: 0.3}, fiducial: 5}}\n"
        "robots: [{name: one, model: marked, pose: [4, 4, 0], controller: hand}]\n"
        "controllers: {hand: {external: true}}\n"
    )
    Position2dProxy(client)
    finder = FiducialProxy(client)
    assert client.read()
    assert finder.fiducials == []
    assert finder.request_id() == 5
