"""Every proxy: what it makes of data."""

import math

import numpy as np
import pytest
from captured_conversations import server_messages
from proxy_talk import ELEMENTS, GEOMETRY, RANGER_CONFIG, talk_with
from scripted_server import scripted
from wire_talk import DATA

from player import (
    BlobfinderProxy,
    BumperProxy,
    DioProxy,
    FiducialProxy,
    LaserProxy,
    PlayerClient,
    Position2dProxy,
    RangerProxy,
    Size,
    XdrError,
    messages,
)
from player.codes import Interface


def see(proxy_class, *data):
    """The proxy after one round of data, given as (subtype, fields or payload)."""

    def script(talk):
        rows = []
        for subtype, values in data:
            payload = values
            if isinstance(values, dict):
                payload = messages.encode(proxy_class.interface, DATA, subtype, **values)
            rows.append((proxy_class.interface, subtype, payload))
        talk.round(*rows, time=4.5)

    def act(proxy):
        assert proxy.client.read()
        assert proxy.fresh
        assert proxy.valid
        assert proxy.time == 4.5
        return proxy

    return talk_with(proxy_class, script, act)


def scan(ranges, **more):
    head = {"min_angle": -1.0, "max_angle": 1.0, "resolution": 0.5, "max_range": 8.0}
    return {**head, "ranges": ranges, "intensity": b"", "id": 3, **more}


def test_position_and_speed():
    proxy = see(Position2dProxy, (1, {"pos": (1, 2, 3), "vel": (4, 5, 6), "stall": 1}))
    assert proxy.pose == (1, 2, 3)
    assert (proxy.vx, proxy.vy, proxy.vyaw, proxy.stall) == (4, 5, 6, True)


def test_a_laser_scan_is_numpy_with_bearings_and_points():
    proxy = see(LaserProxy, (1, scan([1, 2, 3, 4, 5], intensity=bytes([1, 2, 3, 4, 5]))))
    assert proxy.ranges.dtype == np.float64
    assert proxy.ranges.tolist() == [1, 2, 3, 4, 5]
    assert proxy.intensity.tolist() == [1, 2, 3, 4, 5]
    assert proxy.bearings.tolist() == [-1, -0.5, 0, 0.5, 1]
    assert proxy.points[2].tolist() == [3, 0]
    assert proxy.points[4] == pytest.approx([5 * math.cos(1), 5 * math.sin(1)], abs=1e-12)
    assert (proxy.count, proxy.max_range, proxy.resolution, proxy.id) == (5, 8.0, 0.5, 3)


def test_a_scan_with_a_pose_tells_it():
    proxy = see(LaserProxy, (2, scan([1.0], pose=(1, 2, 3))))
    assert proxy.robot_pose == (1, 2, 3)
    assert proxy.ranges.tolist() == [1]


def test_a_scan_with_angles_has_those_bearings():
    values = {"max_range": 8.0, "ranges": [1, 2], "angles": [-0.5, 0.25], "intensity": b"", "id": 0}
    proxy = see(LaserProxy, (3, values))
    assert proxy.bearings.tolist() == [-0.5, 0.25]
    assert (proxy.min_angle, proxy.max_angle) == (-0.5, 0.25)


def test_an_empty_scan_is_a_scan():
    proxy = see(LaserProxy, (1, scan([])))
    assert proxy.points.shape == (0, 2)


def test_a_kept_scan_does_not_change():
    def script(talk):
        for value in (1.0, 2.0):
            payload = messages.encode(6, DATA, 1, **scan([value] * 3))
            talk.round((Interface.LASER, 1, payload))

    def act(laser):
        laser.client.read()
        kept = laser.ranges
        laser.client.read()
        assert kept.tolist() == [1] * 3
        assert laser.ranges.tolist() == [2] * 3

    talk_with(LaserProxy, script, act)


def test_ranger_elements_point_where_they_are_mounted():
    proxy = see(RangerProxy, (1, {"ranges": [1, 2, 3]}), (3, {"intensities": [7, 8, 9]}))
    assert proxy.ranges.tolist() == [1, 2, 3]
    assert proxy.intensities.tolist() == [7, 8, 9]
    assert proxy.bearings.tolist() == [-1, 0, 1]
    assert proxy.config == RANGER_CONFIG
    assert proxy.geometry.size == Size(0.6, 0.4, 0.2)
    assert proxy.geometry.element_sizes[0].tolist() == [0.6, 0.4, 0.2]


def test_a_ranger_that_scans_spreads_its_bearings():
    proxy = see(RangerProxy, (1, {"ranges": [1.0] * 7}))
    assert proxy.bearings == pytest.approx(np.linspace(-1.5, 1.5, 7))


def test_stamped_ranges_bring_geometry_and_configuration():
    config = RANGER_CONFIG._replace(max_range=99.0)
    stamp = {f"config_{name}": value for name, value in config._asdict().items()}
    values = {**GEOMETRY, **ELEMENTS, "have_geometry": 1, "have_config": 1, **stamp}
    proxy = see(RangerProxy, (2, {"ranges": [1.0], **values}))
    assert proxy.config == config
    assert proxy.ranges.tolist() == [1]


def test_a_ranger_may_refuse_to_tell_about_itself():
    def script(talk):
        talk.greet()
        talk.subscribe()
        talk.refuse(Interface.RANGER, 5)
        talk.refuse(Interface.RANGER, 1)
        talk.round((Interface.RANGER, 1, messages.encode(62, DATA, 1, ranges=[1.0])))

    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        proxy = RangerProxy(robot)
        robot.read()
        assert proxy.ranges.tolist() == [1]
        with pytest.raises(ValueError, match="ranger:0: the server did not tell"):
            _ = proxy.bearings


def test_blobs_are_named_tuples():
    blob = (0, 0xFF0000, 12, 156, 60, 153, 159, 59, 61, 10.5)
    proxy = see(BlobfinderProxy, (1, {"width": 160, "height": 120, "blobs": [blob, blob]}))
    assert (proxy.width, proxy.height, len(proxy.blobs)) == (160, 120, 2)
    first = proxy.blobs[0]
    assert first == blob
    assert (first.color, first.left, first.right, first.range) == (0xFF0000, 153, 159, 10.5)


def test_fiducials_are_named_tuples():
    row = (7, 1.0, 2.0, 0.0, 0.0, 0.0, 0.5, *[0.0] * 6)
    [found] = see(FiducialProxy, (1, {"fiducials": [row]})).fiducials
    assert (found.id, found.x, found.y, found.yaw) == (7, 1.0, 2.0, 0.5)


def test_bumpers_are_bits():
    proxy = see(BumperProxy, (1, {"bumpers": b"\0\1\0"}))
    assert proxy.bumped.tolist() == [False, True, False]
    assert proxy.any_bumped


def test_digital_inputs():
    proxy = see(DioProxy, (1, {"count": 2, "bits": 3}))
    assert (proxy.count, proxy.bits) == (2, 3)


@pytest.mark.parametrize(
    "proxy_class",
    [
        Position2dProxy,
        LaserProxy,
        RangerProxy,
        BlobfinderProxy,
        FiducialProxy,
        BumperProxy,
        DioProxy,
    ],
)
@pytest.mark.parametrize("payload", [b"", bytes(4), b"\0\0\0\x09" * 3, b"\xff" * 60])
def test_data_that_is_cut_or_wrong_is_an_error(proxy_class, payload):
    with pytest.raises(XdrError, match=proxy_class.interface.name.lower()):
        see(proxy_class, (1, payload))


@pytest.mark.parametrize(
    "proxy_class",
    [Position2dProxy, LaserProxy, RangerProxy, BlobfinderProxy, FiducialProxy, DioProxy],
)
def test_data_of_a_later_players_subtype_is_passed_over(proxy_class):
    see(proxy_class, (99, b"whatever"))


@pytest.mark.parametrize("proxy_class", [Position2dProxy, LaserProxy, BlobfinderProxy])
def test_captured_data_is_read_as_the_table_reads_it(proxy_class):
    interface = proxy_class.interface
    sent = [m for m in server_messages("pull_r0") if (m.interf, m.type) == (interface, DATA)]
    proxy = see(proxy_class, (1, sent[-1].payload))
    values = messages.decode(interface, DATA, 1, sent[-1].payload)
    if proxy_class is Position2dProxy:
        assert proxy.pose == values["pos"]
    elif proxy_class is LaserProxy:
        assert np.array_equal(proxy.ranges, values["ranges"])
        assert proxy.intensity.tobytes() == values["intensity"]
    else:
        assert [tuple(blob) for blob in values["blobs"].tolist()] == proxy.blobs
