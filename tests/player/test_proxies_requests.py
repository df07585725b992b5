"""Every proxy: what its methods say on the wire, and what they return."""

import json
import math

import numpy as np
import pytest
from proxy_talk import GEOMETRY, LASER_CONFIG, POSE, RANGER_CONFIG, talk_with
from wire_talk import ACK, CMD, REQ

from player import (
    AioProxy,
    BlobfinderProxy,
    BumperProxy,
    BumperSegment,
    DioProxy,
    FiducialProxy,
    Graphics2dProxy,
    LaserProxy,
    Position2dProxy,
    PowerProxy,
    RangerProxy,
    SimulationProxy,
    SpeechProxy,
    XdrError,
    messages,
)
from player.codes import Interface

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
    (AioProxy, lambda p: p.set_output(2, 0.5), 1, {"id": 2, "voltage": 0.5}),
    (Graphics2dProxy, lambda p: p.clear(), 1, {}),
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


SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
RED, BLUE = (255, 255, 0, 0), (255, 0, 0, 255)  # alpha, red, green, blue
DRAWINGS = [
    (lambda p: p.draw_points(SQUARE), 2, {"color": RED}),
    (lambda p: p.draw_polyline(np.array(SQUARE), 0x0000FF), 3, {"color": BLUE}),
    (lambda p: p.draw_multiline(SQUARE, np.int64(255)), 5, {"color": BLUE}),
    (lambda p: p.draw_polygon(SQUARE), 4, {"color": RED, "fill_color": RED, "filled": 0}),
    (
        lambda p: p.draw_polygon(SQUARE, fill=0x0000FF),
        4,
        {"color": RED, "fill_color": BLUE, "filled": 1},
    ),
]


@pytest.mark.parametrize(("act", "subtype", "values"), DRAWINGS)
def test_drawings(act, subtype, values):
    def script(talk):
        heard = talk.expect(Interface.GRAPHICS2D, CMD, subtype)
        sent = messages.decode(heard.interf, CMD, subtype, heard.payload)
        assert sent.pop("points").tolist() == [list(point) for point in SQUARE]
        assert sent == values

    talk_with(Graphics2dProxy, script, act)


@pytest.mark.parametrize("color", ["red", -1, 0x1000000, 1.5, None, (255, 0, 0)])
def test_what_is_no_colour_is_refused_before_it_is_sent(color):
    def act(proxy):
        with pytest.raises(ValueError, match="0xRRGGBB"):
            proxy.draw_points(SQUARE, color)

    talk_with(Graphics2dProxy, lambda talk: None, act)


REQUESTS = [
    # proxy, what is called, subtype, what it sends, what the server answers, what it returns
    (Position2dProxy, lambda p: p.request_geometry(), 1, {}, GEOMETRY, (POSE, (0.6, 0.4, 0.2))),
    (Position2dProxy, lambda p: p.set_motor_power(True), 2, {"state": 1}, {}, None),
    (Position2dProxy, lambda p: p.set_velocity_mode(2), 3, {"value": 2}, {}, None),
    (Position2dProxy, lambda p: p.set_position_mode(1), 4, {"state": 1}, {}, None),
    (Position2dProxy, lambda p: p.set_odometry(1, 2, 3), 5, {"pose": (1, 2, 3)}, {}, None),
    (Position2dProxy, lambda p: p.reset_odometry(), 6, {}, {}, None),
    (
        PowerProxy,
        lambda p: p.set_charging_policy(True, False),
        1,
        {"enable_input": 1, "enable_output": 0},
        {},
        None,
    ),
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


@pytest.mark.parametrize(
    ("proxy_class", "act"),
    [
        (Graphics2dProxy, lambda p: p.draw_polyline(np.zeros((65_536, 2)))),
        (SpeechProxy, lambda p: p.say("x" * (1 << 20))),
    ],
)
def test_what_is_more_than_a_server_takes_is_refused_before_it_is_sent(proxy_class, act):
    def ask(proxy):
        with pytest.raises(XdrError, match="too many"):
            act(proxy)

    talk_with(proxy_class, lambda talk: None, ask)


def test_a_command_that_does_not_fit_is_refused_before_it_is_sent():
    def act(proxy):
        with pytest.raises(XdrError, match="velocity"):
            proxy.set_car("fast", 0)
        with pytest.raises(XdrError, match="m/s and rad/s"):
            proxy.set_speed("fast")

    talk_with(Position2dProxy, lambda talk: None, act)


NUMERIC = [
    # every call that takes numbers, with one of them left open
    (Position2dProxy, lambda p, x: p.set_speed(x)),
    (Position2dProxy, lambda p, x: p.set_speed(0.1, x)),
    (Position2dProxy, lambda p, x: p.set_speed(0.1, vy=x)),
    (Position2dProxy, lambda p, x: p.go_to(x, 0.0)),
    (Position2dProxy, lambda p, x: p.go_to(0.0, 0.0, x)),
    (Position2dProxy, lambda p, x: p.set_car(x, 0.1)),
    (Position2dProxy, lambda p, x: p.set_car(0.1, x)),
    (Position2dProxy, lambda p, x: p.set_velocity_heading(x, 0.1)),
    (Position2dProxy, lambda p, x: p.set_velocity_heading(0.1, x)),
    (Position2dProxy, lambda p, x: p.set_odometry(0.0, x, 0.0)),
    (Position2dProxy, lambda p, x: p.set_velocity_mode(x)),
    (Position2dProxy, lambda p, x: p.set_position_mode(x)),
    (LaserProxy, lambda p, x: p.configure(LASER_CONFIG._replace(max_range=x))),
    (RangerProxy, lambda p, x: p.configure(RANGER_CONFIG._replace(min_angle=x))),
    (BlobfinderProxy, lambda p, x: p.set_tracking_color((0, x), (0, 1), (0, 1))),
    (FiducialProxy, lambda p, x: p.set_id(x)),
    (AioProxy, lambda p, x: p.set_output(0, x)),
    (Graphics2dProxy, lambda p, x: p.draw_points([(0.0, x)])),
    (Graphics2dProxy, lambda p, x: p.draw_polyline([(0.0, 0.0), (x, 0.0)])),
    (Graphics2dProxy, lambda p, x: p.draw_polygon([(0.0, 0.0), (x, 0.0)], fill=0)),
    (Graphics2dProxy, lambda p, x: p.draw_multiline([(0.0, 0.0), (x, 0.0)])),
    (DioProxy, lambda p, x: p.set_output(x)),
    (DioProxy, lambda p, x: p.set_output(1, x)),
    (SimulationProxy, lambda p, x: p.set_pose2d("r2", (0.0, 0.0, x))),
    (SimulationProxy, lambda p, x: p.set_pose3d("r2", (0.0, 0.0, 0.0, 0.0, 0.0, x))),
    (SimulationProxy, lambda p, x: p.set_property("r2", "color", b"red", x)),
    (SimulationProxy, lambda p, x: p.report("speed", [x])),
]


@pytest.mark.parametrize(
    "number", [math.nan, math.inf, -math.inf, np.float64("nan"), np.float32("inf"), 10**400]
)
@pytest.mark.parametrize(("proxy_class", "act"), NUMERIC)
def test_what_is_no_finite_number_is_refused_at_the_call(proxy_class, act, number):
    def try_it(proxy):
        if isinstance(number, int) and proxy_class is SimulationProxy:
            return  # JSON carries whole numbers of any length
        with pytest.raises(ValueError):  # noqa: PT011 - each has words of its own
            act(proxy, number)

    def script(talk):
        """Nothing may have been sent: whoever hears anything here has failed."""
        with pytest.raises(EOFError):
            talk.hear()

    talk_with(proxy_class, script, try_it)


@pytest.mark.parametrize("text", ["fast", None, 1j, [1.0, 2.0]])
def test_what_is_no_number_at_all_is_refused_at_the_call(text):
    def act(proxy):
        for call in (proxy.set_speed, lambda x: proxy.set_car(x, 0), lambda x: proxy.go_to(0, x)):
            with pytest.raises(ValueError, match=r"set_speed|velocity|pos"):
                call(text)

    talk_with(Position2dProxy, lambda talk: None, act)


def test_large_finite_numbers_go_out_as_they_are():
    def script(talk):
        heard = talk.expect(Interface.POSITION2D, CMD, 1)
        sent = messages.decode(4, CMD, 1, heard.payload)
        assert sent["vel"] == (1e308, -1e308, 1e308)

    talk_with(Position2dProxy, script, lambda p: p.set_speed(1e308, 1e308, vy=-1e308))
