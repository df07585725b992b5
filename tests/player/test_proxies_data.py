"""Every proxy: what it makes of data."""

import math
import pickle

import numpy as np
import pytest
from captured_conversations import server_messages
from proxy_talk import ELEMENTS, GEOMETRY, RANGER_CONFIG, talk_with
from scripted_server import PATIENCE, scripted
from wire_talk import ACK, DATA, NACK, REQ

from player import (
    AioProxy,
    Blob,
    BlobfinderProxy,
    BumperProxy,
    DioProxy,
    FiducialProxy,
    LaserProxy,
    NoReading,
    PlayerClient,
    Position2dProxy,
    PowerProxy,
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
        AioProxy,
    ],
)
@pytest.mark.parametrize("payload", [b"", bytes(4), b"\0\0\0\x09" * 3, b"\xff" * 60])
def test_data_that_is_cut_or_wrong_is_an_error(proxy_class, payload):
    with pytest.raises(XdrError, match=proxy_class.interface.name.lower()):
        see(proxy_class, (1, payload))


@pytest.mark.parametrize(
    "proxy_class",
    [Position2dProxy, LaserProxy, RangerProxy, BlobfinderProxy, FiducialProxy, DioProxy, AioProxy],
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


def test_a_battery_tells_what_is_left_and_what_it_takes():
    state = {"percent": 25.0, "joules": 50.0, "watts": -7.5, "charging": 1}
    proxy = see(PowerProxy, (1, {"valid": 30, "volts": 0.0, **state}))
    assert (proxy.known, proxy.percent, proxy.joules, proxy.watts, proxy.charging) == (
        30, 25.0, 50.0, -7.5, 1,
    )  # fmt: skip


def test_plain_numbers_are_numpy():
    proxy = see(AioProxy, (1, {"voltages": [0.5, -2.0]}))
    assert proxy.values.dtype == np.float64
    assert proxy.values.tolist() == proxy.voltages.tolist() == [0.5, -2.0]
    assert proxy.count == 2


READINGS = [
    (Position2dProxy, ["x", "y", "yaw", "pose", "vx", "vy", "vyaw", "stall"]),
    (
        LaserProxy,
        ["ranges", "hits", "bearings", "points", "count", "intensity", "min_angle", "max_angle",
         "resolution", "max_range", "id", "robot_pose"],
    ),
    (RangerProxy, ["ranges", "hits", "bearings", "count", "intensities"]),
    (BlobfinderProxy, ["blobs", "width", "height"]),
    (FiducialProxy, ["fiducials"]),
    (BumperProxy, ["bumped", "any_bumped"]),
    (DioProxy, ["bits", "count"]),
    (AioProxy, ["values", "voltages", "count"]),
    (PowerProxy, ["known", "volts", "percent", "joules", "watts", "charging"]),
]  # fmt: skip


@pytest.mark.parametrize(("proxy_class", "names"), READINGS)
def test_a_reading_before_the_first_read_is_an_error_that_says_so(proxy_class, names):
    """No zeros that nobody has measured, and no arrays without elements: all proxies alike."""

    def act(proxy):
        assert not proxy.valid
        for name in names:
            with pytest.raises(
                NoReading, match=rf"{proxy.addr} has sent no .* call read\(\) first"
            ):
                getattr(proxy, name)

    talk_with(proxy_class, lambda talk: None, act)


def test_a_device_that_has_sent_nothing_in_the_first_rounds_has_no_reading_then():
    """As behind a server whose devices are not equally fast."""

    def script(talk):
        talk.greet()
        talk.subscribe()
        talk.subscribe()
        talk.round((Interface.POSITION2D, 1, bytes(52)))
        talk.round((Interface.LASER, 1, messages.encode(6, DATA, 1, **scan([1.0]))))

    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        base, laser = Position2dProxy(robot), LaserProxy(robot)
        assert robot.read()
        assert base.pose == (0, 0, 0)
        assert not laser.valid
        with pytest.raises(NoReading, match="laser:0 has sent no ranges yet"):
            _ = laser.ranges
        assert robot.read()
        assert laser.ranges.tolist() == [1.0]


def test_blobs_that_are_none_are_no_reading():
    """Nor is data of a later Player's subtype."""

    def script(talk):
        for subtype, payload in ((1, b"\0\0\0\x09" * 5), (99, b"whatever")):
            talk.round((Interface.BLOBFINDER, subtype, payload))

    def act(camera):
        with pytest.raises(XdrError, match="blobfinder:0: 9 blobs do not fit 20 bytes"):
            camera.client.read()
        assert camera.client.read()
        assert camera.client.read()
        for name in ("blobs", "width"):
            with pytest.raises(NoReading):
                getattr(camera, name)

    talk_with(BlobfinderProxy, script, act)


def test_what_a_laser_has_hit_is_told_from_the_end_of_its_range():
    end = float(np.nextafter(np.float32(8.0), np.float32(0.0)))
    assert see(LaserProxy, (1, scan([0.0, 7.5, end, 8.0]))).hits.tolist() == [True] * 3 + [False]


def test_what_a_ranger_has_hit_is_told_from_the_end_of_its_range():
    proxy = see(RangerProxy, (1, {"ranges": [0.0, 7.9, 8.0]}))
    assert proxy.hits.tolist() == [True, True, False]
    proxy.config = None
    with pytest.raises(ValueError, match="did not tell how far"):
        _ = proxy.hits


BLOBS = {
    "width": 161,
    "height": 120,
    "blobs": [(0, 0xFF0000, 0, left + 1, 60, left, left + 2, 59, 61, 2.0) for left in (0, 79, 158)],
}


def see_blobs(answer):
    """The proxy and its blobs, where the server does `answer(talk, request)` when asked for fov."""

    def script(talk):
        talk.round((Interface.BLOBFINDER, 1, messages.encode(7, DATA, 1, **BLOBS)))
        request = talk.expect(Interface.BLOBFINDER, REQ, 252)
        assert messages.decode(7, REQ, 252, request.payload)["key"] == "fov"
        answer(talk, request)

    def act(camera):
        assert camera.client.read()
        camera.client.timeout = PATIENCE
        return camera, camera.fov, camera.blobs

    return talk_with(BlobfinderProxy, script, act)


def tell(fov):
    reply = messages.encode(7, ACK, 252, key="fov", value=fov)
    return lambda talk, request: talk.reply(request, reply)


def test_a_blob_has_a_bearing_by_the_field_of_view_that_the_server_tells():
    _, fov, blobs = see_blobs(tell(1.6))
    assert fov == 1.6
    # 160 columns apart is the whole view; the blobs' middles are columns 1, 80 and 159
    assert [blob.bearing for blob in blobs] == pytest.approx([0.79, 0.0, -0.79], abs=1e-12)


@pytest.mark.parametrize(
    "answer",
    [
        lambda talk, request: talk.reply(request, type_=NACK),
        tell(0.0),
        tell(math.nan),
        tell(1e300),
    ],
    ids=["refused", "zero", "nan", "absurd"],
)
def test_without_a_field_of_view_a_bearing_is_an_error_until_it_is_set(answer):
    """A real Player server refuses the request: the program knows its own camera."""
    camera, fov, blobs = see_blobs(answer)
    assert fov is None
    with pytest.raises(ValueError, match=r"blobfinder:0: .*field of view: set the proxy's `fov`"):
        _ = blobs[0].bearing
    for wrong in (0.0, -1.0, math.nan, 7.0):
        with pytest.raises(ValueError, match="angle"):
            camera.fov = wrong
    camera.fov = 0.8
    assert blobs[0].bearing == pytest.approx(0.395, abs=1e-12)


def test_a_blob_is_still_ten_numbers_that_can_be_copied():
    _, _, blobs = see_blobs(tell(1.6))
    assert pickle.loads(pickle.dumps(blobs[0])) == blobs[0] == BLOBS["blobs"][0]
    with pytest.raises(ValueError, match="no camera"):
        _ = Blob(*BLOBS["blobs"][0]).bearing
