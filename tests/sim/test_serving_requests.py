"""Every request of Player's protocol has exactly one answer; every command has none."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator

import pytest

from tests.sim.served_world import WORLD
from tests.sim.serving import Serving, write_world
from troupe.testing.wire import (
    ACK,
    BLOBFINDER,
    BUMPER,
    CLOSE,
    CMD,
    DIO,
    ERROR,
    FIDUCIAL,
    GRAPHICS2D,
    LASER,
    LOG,
    NACK,
    OPEN,
    PLAYER,
    POSITION2D,
    RANGER,
    REQ,
    SIMULATION,
    SONAR,
    SPEECH,
    RawClient,
    message,
    octets,
    pulling,
    text,
)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Serving]:
    with Serving(write_world(tmp_path_factory.mktemp("served"), WORLD)) as serving:
        yield serving


@pytest.fixture(scope="module")
def full(run: Serving) -> Iterator[RawClient]:
    """A client of the robot that has everything, with `simulation: full`."""
    with pulling(run.port("one")) as client:
        yield client


@pytest.fixture(scope="module")
def report(run: Serving) -> Iterator[RawClient]:
    """A client of the other robot, with `simulation: report`."""
    with pulling(run.port("two")) as client:
        yield client


def u32(*numbers: int) -> bytes:
    return struct.pack(f">{len(numbers)}I", *numbers)


def f64(*numbers: float) -> bytes:
    return struct.pack(f">{len(numbers)}d", *numbers)


def f32(*numbers: float) -> bytes:
    return struct.pack(f">{len(numbers)}f", *numbers)


def device(interf: int, index: int = 0) -> bytes:
    return u32(0, 0, interf, index)


COLOR_VALUE = octets(struct.pack("<4f", 0.0, 0.0, 1.0, 1.0))
LASER_CONFIG = f32(-math.pi / 2, math.pi / 2, math.pi / 180, 8.0, 0.02) + u32(0) + f32(10.0)
RANGER_CONFIG = f64(-1, 1, 0.1, 0, 5, 0.1, 10)

# name, interface, index, subtype, payload, answer, bytes of the answer (None: see the test of it)
REQUESTS: list[tuple[str, int, int, int, bytes, int, int | None]] = [
    ("player device list", PLAYER, 0, 1, b"", ACK, None),
    ("player driver info", PLAYER, 0, 2, device(LASER) + u32(0, 0), ACK, 16 + 8 + 8),
    ("player driver info of nothing", PLAYER, 0, 2, device(LASER, 9) + u32(0, 0), NACK, 0),
    ("player subscribe", PLAYER, 0, 3, device(LASER) + u32(OPEN, 0, 0), ACK, None),
    ("player unsubscribe", PLAYER, 0, 3, device(LASER) + u32(CLOSE, 0, 0), ACK, None),
    ("player subscribe nothing", PLAYER, 0, 3, device(LASER, 9) + u32(OPEN, 0, 0), NACK, 28),
    ("player data mode", PLAYER, 0, 5, u32(2), ACK, 0),
    ("player data mode 9", PLAYER, 0, 5, u32(9), ACK, 0),
    ("player auth", PLAYER, 0, 7, octets(b"key"), NACK, 0),
    ("player name service", PLAYER, 0, 8, text("robot") + u32(0), NACK, 0),
    ("player replace rule", PLAYER, 0, 10, struct.pack(">5i", -1, -1, 1, -1, 1), ACK, 0),
    ("player request that is none", PLAYER, 0, 6, b"", NACK, 0),
    ("player request without payload", PLAYER, 0, 5, b"", NACK, 0),
    ("position2d geometry", POSITION2D, 0, 1, b"", ACK, 72),
    ("position2d motor power", POSITION2D, 0, 2, u32(1), ACK, 0),
    ("position2d velocity mode", POSITION2D, 0, 3, u32(0), NACK, 0),
    ("position2d position mode", POSITION2D, 0, 4, u32(0), ACK, 0),
    ("position2d set odometry", POSITION2D, 0, 5, f64(1, 2, 0.5), ACK, 0),
    ("position2d set odometry to NaN", POSITION2D, 0, 5, f64(math.nan, 0, 0), NACK, 0),
    ("position2d set odometry too far", POSITION2D, 0, 5, f64(1e300, 0, 0), NACK, 0),
    ("position2d reset odometry", POSITION2D, 0, 6, b"", ACK, 0),
    ("position2d speed pid", POSITION2D, 0, 7, f32(1, 2, 3), NACK, 0),
    ("position2d position pid", POSITION2D, 0, 8, f32(1, 2, 3), NACK, 0),
    ("position2d speed profile", POSITION2D, 0, 9, f32(1, 2), NACK, 0),
    ("laser geometry", LASER, 0, 1, b"", ACK, 72),
    ("laser set config", LASER, 0, 2, LASER_CONFIG, ACK, 28),
    ("laser set config to nothing", LASER, 0, 2, f32(2, 3, 0.1, 8, 0) + u32(0) + f32(10), NACK, 0),
    ("laser get config", LASER, 0, 3, b"", ACK, 28),
    ("laser power", LASER, 0, 4, u32(1), ACK, 0),
    ("laser id", LASER, 0, 5, b"", ACK, 4),
    ("laser filter", LASER, 0, 6, u32(0, 0, 0), NACK, 0),
    ("ranger geometry of elements", RANGER, 0, 1, b"", ACK, 376),
    ("ranger geometry of a scan", RANGER, 1, 1, b"", ACK, 160),
    ("ranger power", RANGER, 0, 2, u32(1), ACK, 0),
    ("ranger intensities of elements", RANGER, 0, 3, u32(1), NACK, 0),
    ("ranger intensities of a scan", RANGER, 1, 3, u32(1), ACK, 0),
    ("ranger set config", RANGER, 0, 4, RANGER_CONFIG, NACK, 0),
    ("ranger get config", RANGER, 0, 5, b"", ACK, 56),
    ("blobfinder set color", BLOBFINDER, 0, 1, u32(0, 0, 255, 0, 255, 0, 255), ACK, 0),
    ("blobfinder set color 99", BLOBFINDER, 0, 1, u32(99, 0, 255, 0, 255, 0, 255), NACK, 0),
    ("blobfinder set imager", BLOBFINDER, 0, 2, u32(1, 1, 1, 1), NACK, 0),
    ("blobfinder get color", BLOBFINDER, 0, 3, b"", ACK, 28),
    ("fiducial geometry", FIDUCIAL, 0, 1, b"", ACK, 88),
    ("fiducial fov", FIDUCIAL, 0, 2, b"", ACK, 12),
    ("fiducial set fov", FIDUCIAL, 0, 3, f32(0, 1, 1), NACK, 0),
    ("fiducial id", FIDUCIAL, 0, 7, b"", ACK, 4),
    ("fiducial set id", FIDUCIAL, 0, 8, u32(7), ACK, 4),
    ("fiducial set id too large", FIDUCIAL, 0, 8, u32(1 << 31), NACK, 0),
    ("bumper geometry", BUMPER, 0, 1, b"", ACK, 8 + 4 * 56),
    ("sonar geometry", SONAR, 0, 1, b"", ACK, 8 + 4 * 48),
    ("sonar power", SONAR, 0, 2, u32(1), ACK, 0),
    ("dio has no requests", DIO, 0, 1, b"", NACK, 0),
    ("speech has no requests", SPEECH, 0, 1, b"", NACK, 0),
    ("graphics2d has no requests", GRAPHICS2D, 0, 1, b"", NACK, 0),
    ("simulation pose", SIMULATION, 0, 1, text("one") + bytes(24), ACK, 12 + 24),
    ("simulation pose of nobody", SIMULATION, 0, 1, text("nobody") + bytes(24), NACK, 0),
    ("simulation set pose", SIMULATION, 0, 2, text("one") + f64(3, 4, 0.5), ACK, 0),
    ("simulation set pose outside", SIMULATION, 0, 2, text("one") + f64(11, 4, 0), NACK, 0),
    ("simulation set pose into an obstacle", SIMULATION, 0, 2, text("one") + f64(2, 8, 0), NACK, 0),
    ("simulation set pose into a wall", SIMULATION, 0, 2, text("one") + f64(0.4, 4, 0), NACK, 0),
    ("simulation set pose onto a robot", SIMULATION, 0, 2, text("one") + f64(6.4, 5.5, 0), NACK, 0),
    ("simulation set pose3d onto a robot", SIMULATION, 0, 4,
     text("two") + f64(3, 4, 0, 0, 0, 0.5, 0), NACK, 0),
    ("simulation set pose to NaN", SIMULATION, 0, 2, text("one") + f64(math.nan, 4, 0), NACK, 0),
    ("simulation pose3d", SIMULATION, 0, 3, text("one") + bytes(56), ACK, 12 + 56),
    ("simulation set pose3d", SIMULATION, 0, 4, text("one") + f64(3, 4, 0, 0, 0, 0.5, 0), ACK, 0),
    ("simulation color", SIMULATION, 0, 5, text("one") + text("color") + u32(0) + octets(bytes(16)),
     ACK, 12 + 16 + 4 + 24),
    ("simulation time", SIMULATION, 0, 5, text("one") + text("time") + u32(0) + octets(bytes(8)),
     ACK, 12 + 16 + 4 + 16),
    ("simulation unknown property", SIMULATION, 0, 5, text("one") + text("x") + u32(0, 0, 0),
     NACK, 0),
    ("simulation set color", SIMULATION, 0, 6, text("one") + text("color") + u32(0) + COLOR_VALUE,
     ACK, 0),
    ("simulation set time", SIMULATION, 0, 6, text("one") + text("time") + u32(0) + octets(b"1"),
     NACK, 0),
    ("simulation set to what is no JSON", SIMULATION, 0, 6,
     text("one") + text("x") + u32(0) + octets(b"\xff\xfe"), NACK, 0),
    ("log state", LOG, 0, 3, b"", NACK, 0),
    ("log file name", LOG, 0, 5, octets(b"file.log"), NACK, 0),
    ("log write state", LOG, 0, 1, u32(1), NACK, 0),
    ("log read state", LOG, 0, 2, u32(1), NACK, 0),
    ("log rewind", LOG, 0, 4, b"", NACK, 0),
    ("capabilities that are there", POSITION2D, 0, 255, u32(REQ, 1), ACK, 0),
    ("capabilities that are not", POSITION2D, 0, 255, u32(REQ, 99), NACK, 0),
    ("capabilities of the simulation", SIMULATION, 0, 255, u32(REQ, 1), ACK, 0),
    ("a property of type int", POSITION2D, 0, 254, text("x") + u32(0), NACK, 0),
    ("a property of type double", LASER, 0, 252, text("x") + f64(0), NACK, 0),
    ("a property of type string", BUMPER, 0, 249, text("x") + text("y"), NACK, 0),
    ("scans with poses?", LASER, 0, 248, text("scan_pose") + u32(0), ACK, 20 + 4),
    ("scans with poses", LASER, 0, 247, text("scan_pose") + u32(0), ACK, 0),
    ("a request that is none", LASER, 0, 77, b"", NACK, 0),
    ("a device that is not there", SONAR, 9, 1, b"", NACK, 0),
    ("an interface that is not served", 40, 0, 1, b"", NACK, 0),
    ("a payload that is too short", POSITION2D, 0, 5, f64(1, 2), NACK, 0),
    ("a payload that is too long", POSITION2D, 0, 5, f64(1, 2, 3, 4), NACK, 0),
    ("a payload where none is wanted", POSITION2D, 0, 6, f64(1), ACK, 0),
    ("a payload whose counts differ", SIMULATION, 0, 1, u32(4, 3) + b"one\0" + bytes(24), NACK, 0),
]  # fmt: skip


@pytest.mark.parametrize("row", REQUESTS, ids=[row[0] for row in REQUESTS])
def test_a_request_has_exactly_one_answer_of_its_kind_and_size(
    full: RawClient, row: tuple[str, int, int, int, bytes, int, int | None]
) -> None:
    _, interf, index, subtype, payload, answer, size = row
    got = full.request(interf, index, subtype, payload)  # checks interface, index, subtype
    assert got.type == answer
    if size is not None:
        assert len(got.payload) == size
    after = full.request(PLAYER, 0, 2, device(POSITION2D) + u32(0, 0))
    assert (after.type, after.subtype) == (ACK, 2)  # nothing else had come for the first one


@pytest.mark.parametrize(
    ("interf", "subtype", "payload"),
    [
        (POSITION2D, 1, f64(0.1, 0, 0) + u32(1)),
        (POSITION2D, 2, f64(1, 1, 0, 0, 0, 0) + u32(1)),
        (POSITION2D, 3, f64(0.1, 0.1)),
        (POSITION2D, 4, f64(0.1, 0.1)),
        (POSITION2D, 9, b""),
        (DIO, 1, u32(1, 0)),
        (SPEECH, 1, text("hello")),
        (GRAPHICS2D, 1, b""),
        (GRAPHICS2D, 2, u32(1, 1) + f64(0, 0) + u32(0, 1, 2, 3)),
        (SIMULATION, 2, b""),
        (SIMULATION, 3, b""),
        (LOG, 1, b""),
        (LASER, 1, bytes(100)),
        (POSITION2D, 1, b"too short"),
        (POSITION2D, 1, f64(math.nan, math.inf, -math.inf) + u32(1)),
        (POSITION2D, 2, f64(*[1e308] * 6) + u32(1)),
    ],
)
def test_a_command_is_never_answered_whatever_it_holds(
    full: RawClient, interf: int, subtype: int, payload: bytes
) -> None:
    full.data.clear()
    full.send(message(interf, 0, CMD, subtype, payload))
    assert full.request(POSITION2D, 0, 1).type == ACK  # the next message is this one's answer
    assert full.data == []


def test_other_types_of_message_are_passed_over_or_refused(full: RawClient) -> None:
    for type_ in (1, 4, 5, 6):
        full.send(message(POSITION2D, 0, type_, 1, b""))
        assert full.request(POSITION2D, 0, 1).type == ACK
        full.send(message(PLAYER, 0, type_, 1, b""))
        got = full.receive()
        assert (got.interf, got.type, got.subtype) == (PLAYER, NACK, 1)


def test_a_connection_begins_with_players_banner(full: RawClient) -> None:
    assert full.banner == b"Player v.3.1.1-dev".ljust(32, b"\0")


def test_the_device_list_holds_what_can_be_subscribed_and_no_more(
    run: Serving, full: RawClient
) -> None:
    listed = full.devices()
    assert len(set(listed)) == len(listed)
    assert {interf for interf, _ in listed} == {
        POSITION2D, LASER, RANGER, BLOBFINDER, FIDUCIAL, BUMPER, SONAR, DIO, SPEECH, GRAPHICS2D,
        SIMULATION,
    }  # fmt: skip
    with RawClient(run.port("one")) as client:
        for interf in range(1, 70):
            for index in range(3):
                got = client.access(interf, index, OPEN)
                if (interf, index) in listed:
                    assert got.type == ACK, (interf, index)
                else:
                    assert (got.type, got.payload[16:]) == (NACK, u32(ERROR, 0, 0))


def test_replies_carry_the_servers_address_and_the_simulated_time(
    run: Serving, full: RawClient, report: RawClient
) -> None:
    for _ in range(3):
        report.ask()
        full.round()
        report.answer()
    got = full.request(POSITION2D, 0, 1)
    assert got.host == 0x0100007F
    assert got.robot == run.port("one")
    assert got.time == run.simulation.time >= 0.3


def test_a_robot_with_simulation_report_may_deal_with_itself_alone(report: RawClient) -> None:
    def asked(subtype: int, payload: bytes) -> int:
        return report.request(SIMULATION, 0, subtype, payload).type

    own_color = text("two") + text("color") + u32(0) + COLOR_VALUE
    assert asked(6, own_color) == ACK
    assert asked(5, own_color) == ACK
    assert asked(5, text("two") + text("time") + u32(0) + octets(bytes(8))) == ACK
    assert asked(6, text("two") + text("rank") + u32(0) + octets(b"3")) == ACK
    assert asked(6, text("one") + text("color") + u32(0) + COLOR_VALUE) == NACK
    assert asked(6, text("one") + text("rank") + u32(0) + octets(b"3")) == NACK
    assert asked(5, text("one") + text("color") + u32(0) + COLOR_VALUE) == NACK
    for name in ("one", "two"):
        assert asked(1, text(name) + bytes(24)) == NACK
        assert asked(2, text(name) + f64(1, 1, 0)) == NACK
        assert asked(3, text(name) + bytes(56)) == NACK
        assert asked(4, text(name) + bytes(56)) == NACK


def test_a_robot_without_a_finder_still_says_which_id_it_carries(
    run: Serving, full: RawClient, report: RawClient
) -> None:
    assert report.request(FIDUCIAL, 0, 7).unpack("I") == (9,)
    assert report.request(FIDUCIAL, 0, 8, u32(12)).unpack("I") == (12,)
    report.ask()
    full.round()
    report.answer()
    assert report.request(FIDUCIAL, 0, 7).unpack("I") == (12,)
    assert report.request(FIDUCIAL, 0, 1).unpack("6d3d2d")[6:9] == (0.8, 0.8, 1.0)
