"""Every proxy: what it makes of data, and what its methods say on the wire."""

import json
import math

import numpy as np
import pytest
from captured_conversations import server_messages
from scripted_server import scripted
from wire_talk import ACK, CMD, DATA, REQ

from player import (
    BlobfinderProxy,
    BumperProxy,
    BumperSegment,
    DioProxy,
    FiducialProxy,
    LaserConfig,
    LaserProxy,
    PlayerClient,
    Position2dProxy,
    RangerConfig,
    RangerProxy,
    SimulationProxy,
    Size,
    SpeechProxy,
    XdrError,
    messages,
)
from player.codes import Interface

POSE = (1.0, 2.0, 3.0, 0.0, 0.0, 0.5)
SIZE = (0.4, 0.6, 0.2)  # on the wire: width, length, height
GEOMETRY = {"pose": POSE, "size": SIZE}
ELEMENTS = {
    "element_poses": [(0.0, 0, 0, 0, 0, a) for a in (-1, 0, 1)],
    "element_sizes": [SIZE] * 3,
}
LASER_CONFIG = LaserConfig(-1.5, 1.5, 0.5, 8.0, 0.25, True, 10.0)
RANGER_CONFIG = RangerConfig(-1.5, 1.5, 0.5, 0.1, 8.0, 0.25, 10.0)


def answer_ranger(talk):
    """What a RangerProxy asks when it is made."""
    reply = messages.encode(62, ACK, 5, **RANGER_CONFIG._asdict())
    talk.accept(Interface.RANGER, 5, reply)
    talk.accept(Interface.RANGER, 1, messages.encode(62, ACK, 1, **GEOMETRY, **ELEMENTS))


def talk_with(proxy_class, script, act):
    """Runs `act(proxy)` against a server that greets, subscribes, and then does `script`."""

    def whole(talk):
        talk.greet()
        talk.subscribe()
        if proxy_class is RangerProxy:
            answer_ranger(talk)
        script(talk)

    environ = {"PLAYER_ROBOT": "r1"}
    with scripted(whole) as sock, PlayerClient(sock=sock, environ=environ) as robot:
        return act(proxy_class(robot))


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


# -- data


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


# -- commands and requests

COMMANDS = [
    (Position2dProxy, lambda p: p.set_speed(1, 2, vy=3), 1, {"vel": (1, 3, 2), "state": 1}),
    (
        Position2dProxy,
        lambda p: p.go_to(1, 2, 3),
        2,
        {"pos": (1, 2, 3), "vel": (0, 0, 0), "state": 1},
    ),
    (Position2dProxy, lambda p: p.set_car(1, 2), 3, {"velocity": 1, "angle": 2}),
    (Position2dProxy, lambda p: p.set_velocity_heading(1, 2), 4, {"velocity": 1, "heading": 2}),
    (DioProxy, lambda p: p.set_output(5, 3), 1, {"count": 3, "bits": 5}),
    (SpeechProxy, lambda p: p.say("at goal ✓"), 1, {"text": "at goal ✓"}),
    (SimulationProxy, lambda p: p.pause(), 1, {}),
    (SimulationProxy, lambda p: p.reset(), 2, {}),
    (SimulationProxy, lambda p: p.save(), 3, {}),
]


@pytest.mark.parametrize(("proxy_class", "act", "subtype", "values"), COMMANDS)
def test_commands(proxy_class, act, subtype, values):
    def script(talk):
        heard = talk.expect(proxy_class.interface, CMD, subtype)
        assert messages.decode(heard.interf, CMD, subtype, heard.payload) == values

    talk_with(proxy_class, script, act)


REQUESTS = [
    # proxy, what is called, subtype, what it sends, what the server answers, what it returns
    (Position2dProxy, lambda p: p.request_geometry(), 1, {}, GEOMETRY, (POSE, (0.6, 0.4, 0.2))),
    (Position2dProxy, lambda p: p.set_motor_power(True), 2, {"state": 1}, {}, None),
    (Position2dProxy, lambda p: p.set_velocity_mode(2), 3, {"value": 2}, {}, None),
    (Position2dProxy, lambda p: p.set_position_mode(1), 4, {"state": 1}, {}, None),
    (Position2dProxy, lambda p: p.set_odometry(1, 2, 3), 5, {"pose": (1, 2, 3)}, {}, None),
    (Position2dProxy, lambda p: p.reset_odometry(), 6, {}, {}, None),
    (LaserProxy, lambda p: p.request_geometry(), 1, {}, GEOMETRY, (POSE, (0.6, 0.4, 0.2))),
    (
        LaserProxy,
        lambda p: p.configure(LASER_CONFIG),
        2,
        LASER_CONFIG._asdict(),
        LASER_CONFIG._asdict(),
        LASER_CONFIG,
    ),
    (LaserProxy, lambda p: p.request_configuration(), 3, {}, LASER_CONFIG._asdict(), LASER_CONFIG),
    (LaserProxy, lambda p: p.set_power(False), 4, {"state": 0}, {}, None),
    (LaserProxy, lambda p: p.request_id(), 5, {}, {"serial_number": 9}, 9),
    (RangerProxy, lambda p: p.set_power(True), 2, {"value": 1}, {}, None),
    (RangerProxy, lambda p: p.set_intensity(True), 3, {"value": 1}, {}, None),
    (
        RangerProxy,
        lambda p: p.configure(RANGER_CONFIG),
        4,
        RANGER_CONFIG._asdict(),
        RANGER_CONFIG._asdict(),
        RANGER_CONFIG,
    ),
    (
        BlobfinderProxy,
        lambda p: p.set_tracking_color((1, 2), (3, 4), (5, 6), 7),
        1,
        {
            "channel": 7,
            "red_min": 1,
            "red_max": 2,
            "green_min": 3,
            "green_max": 4,
            "blue_min": 5,
            "blue_max": 6,
        },
        {},
        None,
    ),
    (
        FiducialProxy,
        lambda p: p.request_geometry(),
        1,
        {},
        {**GEOMETRY, "fiducial_size": (1, 2)},
        (POSE, (0.6, 0.4, 0.2)),
    ),
    (
        FiducialProxy,
        lambda p: p.request_fov(),
        2,
        {},
        {"min_range": 0, "max_range": 8, "view_angle": 3},
        (0, 8, 3),
    ),
    (FiducialProxy, lambda p: p.request_id(), 7, {}, {"id": 4}, 4),
    (FiducialProxy, lambda p: p.set_id(5), 8, {"id": 5}, {"id": 5}, 5),
    (
        BumperProxy,
        lambda p: p.request_geometry(),
        1,
        {},
        {"bumpers": [(1, 2, 3, 4, 5, 6, 7, 8)]},
        [BumperSegment(1, 2, 3, 4, 5, 6, 7, 8)],
    ),
    (
        SimulationProxy,
        lambda p: p.get_pose2d("r2"),
        1,
        {"name": "r2", "pose": (0, 0, 0)},
        {"name": "r2", "pose": (1, 2, 3)},
        (1, 2, 3),
    ),
    (
        SimulationProxy,
        lambda p: p.set_pose2d("r2", (1, 2, 3)),
        2,
        {"name": "r2", "pose": (1, 2, 3)},
        {},
        None,
    ),
    (
        SimulationProxy,
        lambda p: p.get_pose3d("r2"),
        3,
        {"name": "r2", "pose": (0,) * 6, "simtime": 0},
        {"name": "r2", "pose": POSE, "simtime": 2.5e6},
        (POSE, 2.5),
    ),
    (
        SimulationProxy,
        lambda p: p.set_pose3d("r2", POSE),
        4,
        {"name": "r2", "pose": POSE, "simtime": 0},
        {},
        None,
    ),
    (
        SimulationProxy,
        lambda p: p.get_property("r2", "color", size=2),
        5,
        {"name": "r2", "property": "color", "index": 0, "value": b"\0\0"},
        {"name": "r2", "property": "color", "index": 0, "value": b"ab"},
        b"ab",
    ),
    (
        SimulationProxy,
        lambda p: p.set_property("r2", "color", b"red", 3),
        6,
        {"name": "r2", "property": "color", "index": 3, "value": b"red"},
        {},
        None,
    ),
    (
        SimulationProxy,
        lambda p: p.report("rank", np.int64(2)),
        6,
        {"name": "r1", "property": "rank", "index": 0, "value": b"2"},
        {},
        None,
    ),
]


@pytest.mark.parametrize(("proxy_class", "act", "subtype", "sent", "answer", "result"), REQUESTS)
def test_requests(proxy_class, act, subtype, sent, answer, result):
    def script(talk):
        heard = talk.expect(proxy_class.interface, REQ, subtype)
        assert messages.decode(heard.interf, REQ, subtype, heard.payload) == sent
        talk.reply(heard, messages.encode(heard.interf, ACK, subtype, **answer))

    # Sizes are doubles on the wire: what goes in comes out.
    assert talk_with(proxy_class, script, act) == result


def test_reports_are_json():
    value = {"strip": (1, 2), "mean": np.float64(0.5), "path": np.arange(3), "name": "ä"}

    def script(talk):
        heard = talk.expect(Interface.SIMULATION, REQ, 6)
        sent = messages.decode(31, REQ, 6, heard.payload)
        assert json.loads(sent["value"]) == {
            "strip": [1, 2],
            "mean": 0.5,
            "path": [0, 1, 2],
            "name": "ä",
        }
        talk.reply(heard)

    talk_with(SimulationProxy, script, lambda p: p.report("plan", value))


@pytest.mark.parametrize("value", [math.nan, object()])
def test_what_json_cannot_carry_is_refused_before_it_is_sent(value):
    def act(proxy):
        with pytest.raises((ValueError, TypeError)):
            proxy.report("rank", value)

    talk_with(SimulationProxy, lambda talk: None, act)


def test_a_command_that_does_not_fit_is_refused_before_it_is_sent():
    def act(proxy):
        with pytest.raises(XdrError, match="velocity"):
            proxy.set_car("fast", 0)
        with pytest.raises(XdrError, match="m/s and rad/s"):
            proxy.set_speed("fast")

    talk_with(Position2dProxy, lambda talk: None, act)
