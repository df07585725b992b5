"""Commands that are no numbers stop the robot, and say so once; finite ones are limited."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import troupe
from tests.sim.serving import Serving, write_world
from troupe.testing.wire import (
    GRAPHICS2D,
    LASER,
    NACK,
    POSITION2D,
    SIMULATION,
    RawClient,
    pulling,
    text,
)

WORLD = """\
size: [20, 20]
models:
  differential: {{body: {{shape: circle, radius: 0.3}}, sensors: [{{type: laser}}]}}
  omnidirectional: {{body: {{shape: circle, radius: 0.3}}, drive: {{kind: omnidirectional}}}}
  car:
    body: {{shape: box, size: [0.6, 0.4]}}
    drive: {{kind: car, wheelbase: 0.35, max_steering: 30}}
robots: [{{model: {drive}, name: one, pose: [10, 10, 0], controller: hand}}]
controllers: {{hand: {{external: true}}}}
"""

Send = Callable[[RawClient], None]
NO_NUMBERS = [math.nan, math.inf, -math.inf]


def doubles(subtype: int, values: list[float], tail: bytes = b"") -> Send:
    payload = struct.pack(f">{len(values)}d", *values) + tail
    return lambda client: client.command(POSITION2D, 0, subtype, payload)


def velocity(vx: float, vy: float, wz: float) -> Send:
    return doubles(1, [vx, vy, wz], b"\0\0\0\1")


def position(x: float, y: float, yaw: float, speed: float = 0, turn: float = 0) -> Send:
    return doubles(2, [x, y, yaw, speed, 0, turn], b"\0\0\0\1")


def car(speed: float, angle: float) -> Send:
    return doubles(3, [speed, angle])


def towards(speed: float, heading: float) -> Send:
    return doubles(4, [speed, heading])


OBEYED = {
    "differential": {1: 3, 2: 6, 4: 2},
    "omnidirectional": {1: 3, 2: 6, 4: 2},
    "car": {1: 3, 3: 2},
}
"""Of each drive: how many numbers the commands that it obeys have."""


def serving(folder: Path, drive: str) -> Serving:
    return Serving(write_world(folder, WORLD.format(drive=drive)))


def goes(folder: Path, drive: str, send: Send, rounds: int = 30) -> tuple[float, float, float]:
    """Where a command leads a robot to, within so many rounds."""
    with serving(folder, drive) as run, pulling(run.port("one")) as client:
        send(client)
        for _ in range(rounds):
            client.round()
        return run.pose()


@pytest.mark.parametrize("drive", OBEYED)
def test_at_a_command_that_is_no_number_the_robot_stops_and_a_line_says_so_once(
    tmp_path: Path, drive: str
) -> None:
    for subtype, count in OBEYED[drive].items():
        for place in range(count):
            with serving(tmp_path, drive) as run, pulling(run.port("one")) as client:
                bad = NO_NUMBERS[place % 3]
                numbers = [bad if k == place else 0.3 for k in range(count)]
                tail = b"\0\0\0\1" if subtype in (1, 2) else b""
                client.drive(0.3)
                for _ in range(10):
                    client.round()
                for _ in range(20):
                    doubles(subtype, numbers, tail)(client)
                    client.round()
                speed = np.abs(run.engine.scenery.stage.velocities[0]).max()
                said = [line for line in run.lines if "which is no number" in line]
            assert speed < 1e-6, (subtype, numbers)
            assert len(said) == 1
            assert said[0].startswith("one: 127.0.0.1:")
            assert f"{bad:g}" in said[0]


def test_a_program_that_sends_what_is_no_number_is_named_and_its_robot_stops(
    tmp_path: Path,
) -> None:
    (tmp_path / "mine.py").write_text("""
import struct
from player import PlayerClient, Position2dProxy
from player.header import pack_message

with PlayerClient() as robot:
    base = Position2dProxy(robot)
    while robot.time < 3.0 and robot.read():
        if robot.time < 1.0:
            base.set_speed(0.3)
        else:
            robot.queue(pack_message(4, 0, 2, 1, struct.pack(">3dI", float("nan"), 0, 0, 1)))
""")
    world = WORLD.format(drive="differential").replace("{external: true}", "{program: ./mine.py}")
    lines: list[str] = []
    result = troupe.run(write_world(tmp_path, world), say=lines.append)
    assert result.outcome == "completed"
    assert result.robot("one").distance < 0.4
    assert [line for line in lines if "no number" in line] == [
        "one: its program sent the command velocity (nan, 0, 0), which is no number: "
        "the robot stops"
    ]


HUGE = [1e7, 1e300, 1.7e308]


@pytest.mark.parametrize("huge", HUGE)
@pytest.mark.parametrize(
    ("drive", "send", "same"),
    [
        ("differential", lambda x: velocity(x, 0, 0), velocity(1e3, 0, 0)),
        ("differential", lambda x: velocity(-x, 1.7e308, 0.3), velocity(-1e3, 0, 0.3)),
        ("differential", lambda x: velocity(0.2, 0, -x), velocity(0.2, 0, -1e3)),
        ("differential", lambda x: position(0, x, 0), position(0, 1e3, 0)),
        ("differential", lambda x: position(2, 0, 0, x, x), position(2, 0, 0, 1e3, 1e3)),
        ("differential", lambda x: towards(-x, 0.5), towards(-1e3, 0.5)),
        ("omnidirectional", lambda x: velocity(x, x, 0), velocity(1e3, 1e3, 0)),
        ("omnidirectional", lambda x: velocity(x, -x / 2, 0), velocity(1e3, -5e2, 0)),
        ("omnidirectional", lambda x: position(-x, x, 0), position(-1e3, 1e3, 0)),
        ("car", lambda x: velocity(x, 0, x / 2), velocity(1e3, 0, 5e2)),
        ("car", lambda x: car(x, 0.2), car(1e3, 0.2)),
        ("car", lambda x: car(0.2, -x), car(0.2, -1e3)),
    ],
)
def test_a_finite_command_is_limited_whatever_its_size(
    tmp_path: Path, drive: str, send: Callable[[float], Send], same: Send, huge: float
) -> None:
    # as far as the direction to a goal 1 km away differs from that to one farther off: by the
    # robot's own way over that, 1.5 m in 3 s at 0.5 m/s, and that many metres to the side
    near = 1.5 * 1.5 / 1e3
    assert goes(tmp_path, drive, send(huge)) == pytest.approx(goes(tmp_path, drive, same), abs=near)


@pytest.mark.parametrize("turns", [1e7, 1e300])
def test_a_heading_of_many_turns_is_that_heading(tmp_path: Path, turns: float) -> None:
    yaw = math.remainder(turns, math.tau)
    for send in (lambda a: towards(0.1, a), lambda a: position(0.01, 0, a)):
        assert goes(tmp_path, "differential", send(turns), 60) == pytest.approx(
            goes(tmp_path, "differential", send(yaw), 60), abs=1e-9
        )


def test_requests_that_are_no_numbers_are_refused(tmp_path: Path) -> None:
    with serving(tmp_path, "differential") as run, pulling(run.port("one")) as client:
        for bad in NO_NUMBERS:
            assert client.request(POSITION2D, 0, 5, struct.pack(">3d", 0, bad, 0)).type == NACK
            pose = text("one") + struct.pack(">3d", bad, 1, 1)
            assert client.request(SIMULATION, 0, 2, pose).type == NACK
            for place in range(4):
                asked = [bad if k == place else 1.0 for k in range(4)]
                config = struct.pack(">4ffIf", *asked, 0, 0, 0)
                assert client.request(LASER, 0, 2, config).type == NACK
        client.round()


def test_a_scan_as_wide_far_or_coarse_as_can_be_said_is_refused(tmp_path: Path) -> None:
    most = 3.4e38  # about the largest float32
    with serving(tmp_path, "differential") as run, pulling(run.port("one")) as client:
        before = client.request(LASER, 0, 3)
        config = before.unpack("5fIf")
        for place, bad in ((0, -most), (1, most), (2, most), (3, most), (4, most)):
            asked = [bad if k == place else config[k] for k in range(7)]
            assert client.request(LASER, 0, 2, struct.pack(">5fIf", *asked)).type == NACK
        assert client.request(LASER, 0, 3).payload == before.payload


def drawn(client: RawClient, points: list[tuple[float, float]]) -> None:
    flat = [number for point in points for number in point]
    payload = struct.pack(f">II{len(flat)}d", len(points), len(points), *flat) + bytes(16)
    client.command(GRAPHICS2D, 0, 3, payload)
    client.round()


def test_shapes_of_points_that_are_no_numbers_are_not_drawn_and_far_points_are_limited(
    tmp_path: Path,
) -> None:
    with serving(tmp_path, "differential") as run, pulling(run.port("one")) as client:
        for _ in range(3):
            drawn(client, [(0, 0), (1, math.nan)])
        assert run.engine.robots[0].drawings == []
        assert sum("graphics2d's polyline" in line for line in run.lines) == 1
        drawn(client, [(0.5, 0.25), (1e300, -1e300), (-1.7e308, 0)])
        (drawing,) = run.engine.robots[0].drawings
        assert drawing.points.tolist() == [[0.5, 0.25], [1e6, -1e6], [-1e6, 0]]
