"""What robots perceive arrives over TCP as it is in the scene."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest

from tests.sim.one_client import ONLY_ONE, client_of
from tests.sim.served_world import ONE, RADIUS, SIZE, TWO, placed, ray
from tests.sim.serving import Serving, write_world
from troupe.testing.wire import (
    ACK,
    BLOBFINDER,
    BUMPER,
    FIDUCIAL,
    LASER,
    NACK,
    POSITION2D,
    RANGER,
    SIMULATION,
    SONAR,
    RawClient,
    text,
)

FLOAT32 = 1e-6  # relative: half of the last bit of a float32 is 6e-8
LASER_MOUNT = (0.2, 0.0)


@pytest.fixture
def run(tmp_path: Path) -> Iterator[Serving]:
    with Serving(write_world(tmp_path, ONLY_ONE)) as serving:
        yield serving


def scan(got: bytes) -> tuple[tuple[float, ...], list[float], bytes]:
    """A laser's head, its ranges, and what follows them."""
    *head, count, again = struct.unpack(">4f2I", got[:24])
    assert count == again
    ranges = list(struct.unpack(f">{count}f", got[24 : 24 + 4 * count]))
    return tuple(head), ranges, got[24 + 4 * count :]


def true_ranges(bearings: list[float], most: float, x: float, y: float) -> list[float]:
    """What rays from a point of robot one's frame meet."""
    circles = [(TWO[0], TWO[1], RADIUS)]
    at = placed(ONE, x, y)
    return [min(most, ray(*at, ONE[2] + bearing, circles)[0]) for bearing in bearings]


# -- sensors ------------------------------------------------------------------------------------


def test_a_laser_scan_is_what_the_rays_meet_from_right_to_left(run: Serving) -> None:
    with client_of(run, (LASER, 0)) as client:
        head, ranges, rest = scan(client.round()[LASER, 0, 1].payload)
    step = math.pi / 180
    assert head == pytest.approx((-math.pi / 2, math.pi / 2, step, 8.0), rel=FLOAT32)
    bearings = [-math.pi / 2 + k * step for k in range(181)]
    assert ranges == pytest.approx(true_ranges(bearings, 8.0, *LASER_MOUNT), rel=FLOAT32)
    assert rest == bytes(12)  # no intensities, id 0
    assert min(ranges) < 4 < max(ranges)


def test_a_laser_that_is_configured_serves_that_part_of_its_scan(run: Serving) -> None:
    degree = math.pi / 180
    with client_of(run, (LASER, 0)) as client:
        wanted = struct.pack(">5fIf", -30 * degree, 45.4 * degree, 2 * degree, 4.0, 0.0, 1, 10.0)
        told = client.request(LASER, 0, 2, wanted)
        actual = (-30 * degree, 44 * degree, 2 * degree, 4.0, 0.0, 1, 10.0)
        assert told.unpack("5fIf") == pytest.approx(actual, rel=FLOAT32)
        assert client.request(LASER, 0, 3).payload == told.payload
        head, ranges, rest = scan(client.round()[LASER, 0, 1].payload)
        bearings = [(-30 + 2 * k) * degree for k in range(38)]
        truth = true_ranges(bearings, 100.0, *LASER_MOUNT)
        assert head == pytest.approx((*actual[:4],), rel=FLOAT32)
        assert ranges == pytest.approx([min(4.0, r) for r in truth], rel=FLOAT32)
        marks = bytes(r <= 4.0 for r in truth)
        assert rest == struct.pack(">II", 38, 38) + marks + bytes(2) + bytes(4)
        assert 0 < sum(marks) < 38
        # and all of it, as a client of Stage's would ask for it: by the number of rays
        angle = math.pi / 2
        all_of_it = struct.pack(">5fIf", -angle, angle, math.pi / 181, 8.0, 0.02, 0, 10.0)
        whole = client.request(LASER, 0, 2, all_of_it).unpack("5fIf")
        assert whole[:4] == pytest.approx((-angle, angle, degree, 8.0), rel=FLOAT32)
        _, ranges, rest = scan(client.round()[LASER, 0, 1].payload)
        assert (len(ranges), rest) == (181, bytes(12))


def test_a_scan_comes_with_the_robots_pose_where_that_is_asked_for(run: Serving) -> None:
    with client_of(run, (LASER, 0)) as client:
        plain = client.round()[LASER, 0, 1].payload
        client.request(LASER, 0, 247, text("scan_pose") + struct.pack(">I", 1))
        client.request(POSITION2D, 0, 5, struct.pack(">3d", 1.0, 2.0, 0.5))
        client.data.clear()
        got = client.round()
        assert (LASER, 0, 1) not in got
        posed = got[LASER, 0, 2].payload
        assert posed[:-24] == plain
        assert struct.unpack(">3d", posed[-24:]) == got[POSITION2D, 0, 1].unpack("6dI")[:3]
        assert struct.unpack(">3d", posed[-24:]) == (1.0, 2.0, 0.5)


def test_a_ranger_of_elements_and_a_sonar_tell_the_same_cones(run: Serving) -> None:
    with client_of(run, (RANGER, 0), (SONAR, 0)) as client:
        got = client.round()
        count, again, *ranges = got[RANGER, 0, 1].unpack("II4d")
        assert count == again == 4
        poses = [(0.5, 0, 0), (0, 0.4, 90), (-0.5, 0, 180), (0, -0.4, -90)]
        for (x, y, heading), reach in zip(poses, ranges, strict=True):
            # the nearest of a fan of rays that fills the cone: finer rays, nearer to the truth
            fan = [math.radians(heading - 5 + 0.01 * k) for k in range(1001)]
            assert reach == pytest.approx(min(true_ranges(fan, 5.0, x, y)), abs=1e-3)
        assert got[SONAR, 0, 1].unpack("II4f")[2:] == pytest.approx(ranges, rel=FLOAT32)
        told = client.request(SONAR, 0, 1).unpack("II" + 4 * "6d")[2:]
        for k, (x, y, heading) in enumerate(poses):
            assert told[6 * k : 6 * k + 2] == (x, y)
            assert told[6 * k + 5] == pytest.approx(math.radians(heading))
        geometry = client.request(RANGER, 0, 1).unpack("6d3dII24dII12d")
        assert geometry[9:11] == (4, 4)
        assert geometry[11:35] == pytest.approx(told)
        config = client.request(RANGER, 0, 5).unpack("7d")
        fov = math.radians(10)
        assert config == pytest.approx((-fov / 2, fov / 2, fov, 0, 5, 0, 10))


def test_a_laser_is_served_as_a_ranger_too_with_its_bearings(run: Serving) -> None:
    with client_of(run, (RANGER, 1)) as client:
        config = client.request(RANGER, 1, 5).unpack("7d")
        assert config == pytest.approx(
            (-math.pi / 2, math.pi / 2, math.pi / 180, 0, 8, 0, 10), rel=1e-12
        )
        count, again, *ranges = client.round()[RANGER, 1, 1].unpack("II181d")
        assert count == again == 181
        bearings = [config[0] + k * config[2] for k in range(181)]
        # double all the way; only rays that graze a corner could differ, and none does here
        truth = true_ranges(bearings, 8.0, *LASER_MOUNT)
        assert ranges == pytest.approx(truth, rel=1e-9)
        client.request(RANGER, 1, 3, struct.pack(">I", 1))
        got = client.round()
        marks = got[RANGER, 1, 3].unpack("II181d")[2:]
        assert list(marks) == [float(reach < 8.0) for reach in truth]


def test_blobs_are_where_the_colours_are(run: Serving) -> None:
    with client_of(run, (BLOBFINDER, 0)) as client:
        payload = client.round()[BLOBFINDER, 0, 1].payload
        width, height, count, again = struct.unpack(">4I", payload[:16])
        assert (width, height) == (160, 120)
        assert count == again == (len(payload) - 16) / 40
        blobs = [struct.unpack_from(">9If", payload, 16 + 40 * k) for k in range(count)]
        blue = [blob for blob in blobs if blob[1] == 0x0000FF]
        assert len(blue) == 1
        number, _, area, x, y, left, right, top, bottom, reach = blue[0]
        # robot two, a disc: its bearing and the angle it takes up, in columns from the left
        bearing = math.atan2(TWO[1] - ONE[1], TWO[0] - ONE[0]) - ONE[2]
        distance = math.hypot(TWO[0] - ONE[0], TWO[1] - ONE[1])
        half = math.asin(RADIUS / distance)
        column = math.pi / 159  # 160 columns, both ends of the view included
        assert left * column == pytest.approx(math.pi / 2 - bearing - half, abs=column)
        assert right * column == pytest.approx(math.pi / 2 - bearing + half, abs=column)
        assert distance - RADIUS <= reach <= distance
        assert (x, y) == ((left + right) // 2, (top + bottom) // 2)
        assert area == (right - left) * (bottom - top)
        assert number == 2  # the colour's place in the world file
        assert all(a[5] > b[6] for a, b in pairwise(blobs))  # from right to left
        assert {blob[1] for blob in blobs} == {0xFF0000, 0x00FF00, 0x0000FF}


def test_a_channel_of_colour_that_a_client_sets_takes_what_lies_in_its_bounds(
    run: Serving,
) -> None:
    def colors(client: RawClient) -> set[tuple[int, int]]:
        payload = client.round()[BLOBFINDER, 0, 1].payload
        count = struct.unpack(">I", payload[8:12])[0]
        blobs = [struct.unpack_from(">II", payload, 16 + 40 * k) for k in range(count)]
        return {(number, color) for number, color in blobs}

    with client_of(run, (BLOBFINDER, 0)) as client:
        assert colors(client) == {(0, 0xFF0000), (1, 0x00FF00), (2, 0x0000FF)}
        exactly_red = (0, 255, 255, 0, 0, 0, 0)
        assert client.request(BLOBFINDER, 0, 3).unpack("7I") == exactly_red
        bluish = (0, 0, 100, 0, 100, 200, 255)
        assert client.request(BLOBFINDER, 0, 1, struct.pack(">7I", *bluish)).type == ACK
        assert client.request(BLOBFINDER, 0, 3).unpack("7I") == bluish
        client.data.clear()
        # no channel takes red any more, the others are as they were
        assert colors(client) == {(1, 0x00FF00), (0, 0x0000FF)}
        anything = struct.pack(">7I", 5, 0, 255, 0, 255, 0, 255)
        assert client.request(BLOBFINDER, 0, 1, anything).type == ACK
        client.data.clear()
        assert colors(client) == {(0, 0x0000FF), (1, 0x00FF00), (5, 0xFF0000)}
        none = struct.pack(">7I", 0, 9, 3, 0, 0, 0, 0)
        assert client.request(BLOBFINDER, 0, 1, none).type == NACK


def test_a_fiducial_is_seen_with_its_id_where_it_is(run: Serving) -> None:
    with client_of(run, (FIDUCIAL, 0)) as client, RawClient(run.port("two")) as other:
        count, again, number, *pose = client.round()[FIDUCIAL, 0, 1].unpack("IIi6d6d")
        assert (count, again, number) == (1, 1, 9)
        assert placed(ONE, pose[0], pose[1]) == pytest.approx(TWO[:2], abs=1e-9)
        assert ONE[2] + pose[5] == pytest.approx(TWO[2], abs=1e-9)
        assert client.request(FIDUCIAL, 0, 7).unpack("I") == (7,)
        assert client.request(FIDUCIAL, 0, 2).unpack("3f") == pytest.approx((0, 8, 2 * math.pi))
        other.request(FIDUCIAL, 0, 8, struct.pack(">I", 33))
        assert client.round()[FIDUCIAL, 0, 1].unpack("IIi6d6d")[2] == 33
        other.request(FIDUCIAL, 0, 8, struct.pack(">I", 0))
        assert client.round()[FIDUCIAL, 0, 1].unpack("II") == (0, 0)


def test_a_bumper_closes_where_the_body_touches(run: Serving) -> None:
    with client_of(run, (BUMPER, 0)) as client:
        assert client.round()[BUMPER, 0, 1].unpack("II4B") == (4, 4, 0, 0, 0, 0)
        client.request(SIMULATION, 0, 2, text("one") + struct.pack(">3d", 9.3, 2.0, 0.0))
        for _ in range(12):
            client.drive(0.5)
            got = client.round()
        assert got[BUMPER, 0, 1].unpack("II4B") == (4, 4, 1, 0, 0, 0)  # the one ahead
        assert got[POSITION2D, 0, 1].unpack("6dI")[6] == 1  # stall
        rows = client.request(BUMPER, 0, 1).unpack("II" + 4 * "6dff")[2:]
        ahead = rows[:8]
        assert (ahead[0], ahead[1], ahead[5]) == pytest.approx((0.5, 0, 0))
        assert ahead[6] == pytest.approx(0.5 * math.pi / 2)  # a quarter of the circle
        assert ahead[7] == pytest.approx(0.5)


def test_ranges_never_pass_below_zero_nor_above_the_sensors_range(run: Serving) -> None:
    with client_of(run, (LASER, 0), (RANGER, 0)) as client:
        for k in range(20):
            at = (0.5 + 0.45 * k, 0.5 if k % 2 else SIZE - 0.5, 0.7 * k)
            client.request(SIMULATION, 0, 2, text("one") + struct.pack(">3d", *at))
            got = client.round()
            _, ranges, _ = scan(got[LASER, 0, 1].payload)
            assert all(0 <= reach <= 8 for reach in ranges)
            assert all(0 <= reach <= 5 for reach in got[RANGER, 0, 1].unpack("II4d")[2:])
