"""What Stage's own test of its Player plugin (lsp_test, 15 cases) asks for, asked by our client.

Four of the cases cannot hold here; these say what holds instead, and docs/player.md says why. Their
numbers are those of the Pioneer and the SICK laser that its world is made of.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from types import SimpleNamespace

import pytest

from player import (
    BlobfinderProxy,
    FiducialProxy,
    LaserProxy,
    PlayerClient,
    PlayerRefused,
    Position2dProxy,
    SimulationProxy,
    SpeechProxy,
)
from tests.patience import PATIENCE
from tests.sim.serving import Serving, write_world
from troupe.testing.wire import ACK, SONAR, pulling

CLOSE_TO = 0.01

WORLD = """\
size: [16, 16]
boundary: {color: gray}
models:
  pioneer: &pioneer
    body: &body
      shape: polygon
      points: [[-0.26, -0.19], [0.18, -0.19], [0.18, 0.19], [-0.26, 0.19]]
      color: red
    simulation: full
    fiducial: 1
    sensors:
      - type: ranger
        range: 5
        elements:
          - [0.075, 0.130, 90]
          - [0.115, 0.115, 50]
          - [0.150, 0.080, 30]
          - [0.170, 0.025, 10]
          - [0.170, -0.025, -10]
          - [0.150, -0.080, -30]
          - [0.115, -0.115, -50]
          - [0.075, -0.130, -90]
          - [-0.155, -0.130, -90]
          - [-0.195, -0.115, -130]
          - [-0.230, -0.080, -150]
          - [-0.250, -0.025, -170]
          - [-0.250, 0.025, 170]
          - [-0.230, 0.080, 150]
          - [-0.195, 0.115, 130]
          - [-0.155, 0.130, 90]
      - {type: laser, pose: [0.03, 0, 0], range: 8, samples: 361, housing: [0.156, 0.155]}
      - {type: fiducial, pose: [-0.15, 0, 0], range: 8, fov: 180}
      - {type: blobfinder, image: [80, 60], fov: 120, range: 20, colors: [red, gray]}
  other: {body: *body, fiducial: 2}
robots:
  - {name: r0, model: pioneer, pose: [0.51, 0.51, 45], controller: test}
  - {name: r1, model: other, pose: [2.915, 0.807, 135]}
controllers: {test: {external: true}}
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Serving]:
    with Serving(write_world(tmp_path_factory.mktemp("plugin"), WORLD)) as serving:
        yield serving


@pytest.fixture(scope="module")
def robot(run: Serving) -> Iterator[SimpleNamespace]:
    """One client with a proxy of each; the cases begin and end with r0 where it starts."""
    with PlayerClient("127.0.0.1", run.port("r0"), timeout=PATIENCE, environ={}) as client:
        proxies = {
            "base": Position2dProxy(client),
            "laser": LaserProxy(client),
            "finder": FiducialProxy(client),
            "blobs": BlobfinderProxy(client),
            "speech": SpeechProxy(client),
            "simulation": SimulationProxy(client),
        }
        client.read()
        yield SimpleNamespace(client=client, **proxies)


def velocity(robot: SimpleNamespace) -> tuple[float, float, float]:
    return robot.base.vx, robot.base.vy, robot.base.vyaw


# -- position2d ---------------------------------------------------------------------------------


def test_position2d_geometry(robot: SimpleNamespace) -> None:
    told = robot.base.request_geometry()
    assert (told.pose.x, told.pose.y, told.pose.yaw) == pytest.approx((-0.04, 0, 0), abs=CLOSE_TO)
    assert (told.size.length, told.size.width) == pytest.approx((0.44, 0.38), abs=CLOSE_TO)


def test_position2d_data(robot: SimpleNamespace) -> None:
    robot.client.read()
    assert robot.base.fresh
    assert robot.base.time > 0
    now = (robot.base.x, robot.base.y, robot.base.yaw, *velocity(robot))
    assert now == pytest.approx([0] * 6, abs=CLOSE_TO)
    assert not robot.base.stall


def rounds(robot: SimpleNamespace, seconds: float) -> None:
    for _ in range(round(seconds / 0.1)):
        robot.client.read()


def test_position2d_move_but_for_the_velocity_at_a_wall(robot: SimpleNamespace) -> None:
    """The original wants to read -3 m/s, as commanded, of a robot that stands at a wall.

    Stage itself bounds what is commanded to 1 m/s.
    """
    base = robot.base
    base.set_speed(-3.0, 0.0)
    rounds(robot, 2.0)
    assert base.x < 0
    assert (base.y, base.yaw) == pytest.approx((0, 0), abs=CLOSE_TO)
    assert base.stall
    assert base.vx == pytest.approx(0, abs=CLOSE_TO)  # it stands
    base.set_speed(0.0, math.pi / 2)
    rounds(robot, 0.5)
    base.set_speed(0.0, 0.0)
    rounds(robot, 1.0)
    assert base.x < 0
    assert not base.stall
    assert velocity(robot) == pytest.approx((0, 0, 0), abs=CLOSE_TO)
    x, yaw = base.x, base.yaw
    base.go_to(0.0, 0.0, 0.0)
    rounds(robot, 5.0)
    base.set_speed(0.0, 0.0)
    rounds(robot, 0.5)
    assert base.x > x
    assert base.yaw < yaw
    assert velocity(robot) == pytest.approx((0, 0, 0), abs=0.1)
    base.set_odometry(0.0, 0.0, 0.0)
    rounds(robot, 0.5)
    assert (base.x, base.y, base.yaw) == pytest.approx((0, 0, 0), abs=CLOSE_TO)
    robot.simulation.set_pose2d("r0", (0.51, 0.51, math.radians(45)))
    robot.client.read()


# -- laser, sonar -------------------------------------------------------------------------------


def test_laser_configuration_is_refused_with_the_range_that_the_library_sends(
    robot: SimpleNamespace,
) -> None:
    """The original's library leaves the range unset; one that sets it is granted."""
    own = robot.laser.request_configuration()
    resolution = math.pi / 361
    with pytest.raises(PlayerRefused):
        robot.laser.configure(own._replace(resolution=resolution, max_range=3e-41))
    asked = own._replace(
        min_angle=-math.pi / 2, max_angle=math.pi / 2, resolution=resolution, intensity=True
    )
    told = robot.laser.configure(asked)
    assert told == robot.laser.request_configuration()
    assert told[:3] == pytest.approx(asked[:3], abs=CLOSE_TO)
    assert told.scanning_frequency == pytest.approx(10.0, abs=CLOSE_TO)
    assert told.intensity


def test_laser_geometry(robot: SimpleNamespace) -> None:
    told = robot.laser.request_geometry()
    assert (told.pose.x, told.pose.y, told.pose.yaw) == pytest.approx((0.03, 0, 0), abs=CLOSE_TO)
    assert (told.size.length, told.size.width) == pytest.approx((0.156, 0.155), abs=CLOSE_TO)


def test_laser_data(robot: SimpleNamespace) -> None:
    robot.client.read()
    laser = robot.laser
    assert laser.fresh
    assert laser.count == 361
    ends = (laser.bearings[0], laser.bearings[-1])
    assert ends == pytest.approx((-math.pi / 2, math.pi / 2), abs=CLOSE_TO)
    assert (laser.ranges <= laser.max_range).all()
    assert (laser.ranges >= 0).all()


@pytest.fixture(scope="module")
def sonar(run: Serving, robot: SimpleNamespace) -> Iterator[tuple[bytes, bytes]]:
    """The geometry and the data of the sonar, for which Python has no proxy."""
    with pulling(run.port("r0"), (SONAR, 0)) as client:
        geometry = client.request(SONAR, 0, 1)
        assert geometry.type == ACK
        client.ask()
        robot.client.read()
        yield geometry.payload, client.answer()[SONAR, 0, 1].payload


def test_sonar_geometry(sonar: tuple[bytes, bytes]) -> None:
    count, again, x, y, z, _, _, yaw = struct.unpack(">2I6d", sonar[0][:56])
    assert (count, again) == (16, 16)
    assert (x, y, z, yaw) == pytest.approx((0.075, 0.130, 0, math.pi / 2), abs=CLOSE_TO)


def test_sonar_data(sonar: tuple[bytes, bytes]) -> None:
    count, _, *ranges = struct.unpack(">2I16f", sonar[1])
    assert count == 16
    assert min(ranges) >= 0


# -- fiducial, blobfinder, speech ---------------------------------------------------------------


def test_fiducial_geometry(robot: SimpleNamespace) -> None:
    assert robot.finder.request_geometry().pose == pytest.approx(
        (-0.15, 0, 0, 0, 0, 0), abs=CLOSE_TO
    )


def test_fiducial_data(robot: SimpleNamespace) -> None:
    robot.client.read()
    assert robot.finder.fresh
    assert [one.id for one in robot.finder.fiducials] == [2]


def test_blobfinder_data_but_for_the_opacity_in_the_colour(robot: SimpleNamespace) -> None:
    """The original wants 0xFFFF0000 for red; Player's documents, and Stage 4.3, 0x00RRGGBB."""
    robot.client.read()
    blobs = sorted(robot.blobs.blobs, key=lambda blob: blob.x)
    assert robot.blobs.fresh
    assert (robot.blobs.width, robot.blobs.height) == (80, 60)
    (at,) = (k for k, blob in enumerate(blobs) if blob.color == 0xFF0000)
    wall, red, other = blobs[at - 1 : at + 2]  # a wall, the robot, a wall
    assert wall.color == other.color == 0xBEBEBE
    assert min(red.range, red.area, red.y) > 0
    assert red.left < red.right
    assert red.top < red.bottom
    assert wall.range > red.range
    assert red.x > robot.blobs.width / 2


def test_speech_say(robot: SimpleNamespace, run: Serving) -> None:
    robot.speech.say("Test")
    robot.client.read()
    assert run.engine.robots[0].record.said[-1][1] == "Test"


# -- simulation ---------------------------------------------------------------------------------


def test_simulation_pose2d(robot: SimpleNamespace) -> None:
    simulation = robot.simulation
    before = simulation.get_pose2d("r1")
    assert before == pytest.approx((2.915, 0.807, 3 * math.pi / 4), abs=CLOSE_TO)
    simulation.set_pose2d("r1", (8.0, 8.0, 0.0))
    assert simulation.get_pose2d("r1") == pytest.approx((8, 8, 0), abs=CLOSE_TO)
    simulation.set_pose2d("r1", before)
    assert simulation.get_pose2d("r1") == pytest.approx(before, abs=CLOSE_TO)


def test_simulation_pose3d_but_for_the_height_and_the_time(robot: SimpleNamespace) -> None:
    """The original wants the height kept, and time to pass between two requests."""
    simulation = robot.simulation
    before, time = simulation.get_pose3d("r1")
    assert before == pytest.approx((2.915, 0.807, 0, 0, 0, 3 * math.pi / 4), abs=CLOSE_TO)
    assert time > 0
    quarter = math.pi / 4
    simulation.set_pose3d("r1", (8.0, 8.0, 0.5, quarter, quarter, quarter))
    after, then = simulation.get_pose3d("r1")
    assert after == pytest.approx((8, 8, 0, 0, 0, quarter), abs=CLOSE_TO)
    assert then == time
    simulation.set_pose3d("r1", before)
    robot.client.read()
    assert simulation.get_pose3d("r1")[1] > time


def test_simulation_properties_that_are_numbers_in_memory(robot: SimpleNamespace) -> None:
    simulation = robot.simulation
    numbers = {("r0", "aggression"): 5, ("r1", "aggression"): 53, ("r1", "power"): 125}
    for (name, key), number in numbers.items():
        simulation.set_property(name, key, struct.pack("<q", number))
    for read in (False, True):
        if read:
            robot.client.read()
        for (name, key), number in numbers.items():
            told = simulation.get_property(name, key, size=8)
            assert struct.unpack("<q", told) == (number,)
