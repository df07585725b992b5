"""What robots and the simulation are told over TCP happens."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.patience import PATIENCE
from tests.sim.one_client import ONLY_ONE, client_of, state
from tests.sim.served_world import ONE, TWO, placed
from tests.sim.serving import Serving, write_world
from troupe.testing.wire import (
    ACK,
    BLOBFINDER,
    DIO,
    NACK,
    POSITION2D,
    SIMULATION,
    RawClient,
    octets,
    text,
)


@pytest.fixture
def run(tmp_path: Path) -> Iterator[Serving]:
    with Serving(write_world(tmp_path, ONLY_ONE)) as serving:
        yield serving


# -- driving ------------------------------------------------------------------------------------


def test_velocity_commands_move_the_robot_and_its_odometry(run: Serving) -> None:
    with client_of(run) as client:
        assert state(client) == pytest.approx((0, 0, 0, 0, 0, 0, 0), abs=1e-12)
        for _ in range(30):
            client.drive(0.5, 0.3)
            x, y, yaw, vx, vy, wz, stall = state(client)
        assert (vx, vy, wz, stall) == pytest.approx((0.5, 0, 0.3, 0), abs=1e-9)
        assert yaw > 0.5
        assert placed(ONE, x, y) == pytest.approx(run.pose()[:2], abs=1e-9)
        assert ONE[2] + yaw == pytest.approx(run.pose()[2], abs=1e-9)


def test_a_position_command_leads_there_in_the_odometrys_frame(run: Serving) -> None:
    with client_of(run) as client:
        client.request(POSITION2D, 0, 5, struct.pack(">3d", 5.0, -2.0, 1.0))
        goal = (5.8, -1.0, 2.0)
        client.command(POSITION2D, 0, 2, struct.pack(">6dI", *goal, 0.5, 0, 0, 1))
        x, y, yaw, *_ = state(client, 150)
        assert (x, y) == pytest.approx(goal[:2], abs=0.02)  # the drive's own tolerance
        assert yaw == pytest.approx(goal[2], abs=0.02)


def test_a_heading_command_turns_to_a_heading_and_drives_along_it(run: Serving) -> None:
    with client_of(run) as client:
        client.command(POSITION2D, 0, 4, struct.pack(">2d", 0.2, 0.7))
        _, _, yaw, vx, _, wz, _ = state(client, 60)
        assert (yaw, vx, wz) == pytest.approx((0.7, 0.2, 0.0), abs=0.01)


def test_a_car_obeys_speed_and_steering_and_others_pass_it_over(tmp_path: Path) -> None:
    world = ONLY_ONE.replace(
        "    simulation: full",
        "    simulation: full\n    drive: {kind: car, wheelbase: 0.8, max_steering: 40}",
    )
    with Serving(write_world(tmp_path, world)) as run, client_of(run) as client:
        client.command(POSITION2D, 0, 3, struct.pack(">2d", 0.2, 0.3))
        *_, vx, vy, wz, _ = state(client, 20)
        assert (vx, vy) == pytest.approx((0.2, 0.0), abs=1e-6)
        assert wz == pytest.approx(0.2 * math.tan(0.3) / 0.8, rel=1e-3)  # an axle that rolls


def test_a_differential_drive_passes_car_commands_over(run: Serving) -> None:
    with client_of(run) as client:
        client.drive(0.2)
        client.command(POSITION2D, 0, 3, struct.pack(">2d", -0.4, 0.3))
        assert state(client, 20)[3] == pytest.approx(0.2, abs=1e-9)


def test_motors_that_are_off_do_not_move_whatever_the_command(run: Serving) -> None:
    with client_of(run) as client:
        client.drive(0.4)
        state(client, 10)
        client.request(POSITION2D, 0, 2, struct.pack(">I", 0))
        client.drive(0.4)
        assert state(client, 20)[3] == pytest.approx(0.0, abs=1e-9)
        client.request(POSITION2D, 0, 2, struct.pack(">I", 1))
        assert state(client, 20)[3] == pytest.approx(0.4, abs=1e-9)


def test_the_geometry_is_the_bodys_width_before_its_length(run: Serving) -> None:
    with client_of(run) as client:
        geometry = client.request(POSITION2D, 0, 1).unpack("6d3d")
        assert geometry == (0, 0, 0, 0, 0, 0, 0.8, 1.0, 1.0)


def test_odometry_is_set_and_reset_from_the_next_reading_on(run: Serving) -> None:
    with client_of(run) as client:
        for _ in range(10):
            client.drive(0.5)
            client.round()
        client.drive(0.0)
        state(client, 10)
        client.request(POSITION2D, 0, 5, struct.pack(">3d", 7.0, 8.0, -1.0))
        client.data.clear()
        assert state(client)[:3] == pytest.approx((7.0, 8.0, -1.0), abs=1e-9)
        client.request(POSITION2D, 0, 6)
        client.data.clear()
        assert state(client)[:3] == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


# -- the sprayer and the simulation -------------------------------------------------------------


def test_the_sprayer_paints_while_bit_0_of_its_output_is_set(run: Serving) -> None:
    floor = run.engine.scenery.floor
    with client_of(run, (DIO, 0)) as client:
        assert client.round()[DIO, 0, 1].unpack("II") == (1, 0)
        client.command(DIO, 0, 1, struct.pack(">II", 1, 1))
        client.drive(0.5)
        assert client.round()[DIO, 0, 1].unpack("II") == (1, 1)
        for _ in range(20):
            client.drive(0.5)
            client.round()
        painted = floor.painted_area
        assert painted > 1.0
        client.command(DIO, 0, 1, struct.pack(">II", 1, 0xFFFFFFFE))
        client.drive(0.5)
        assert client.round()[DIO, 0, 1].unpack("II") == (1, 0)
        stopped = floor.painted_area
        for _ in range(10):
            client.drive(0.5)
            client.round()
        assert floor.painted_area == stopped


def ask_property(client: RawClient, name: str, key: str, size: int) -> bytes:
    got = client.request(SIMULATION, 0, 5, text(name) + text(key) + bytes(4) + octets(bytes(size)))
    assert got.type == ACK
    return got.payload[-size:] if size % 4 == 0 else got.payload


def test_the_simulation_tells_and_sets_true_poses_by_name(run: Serving) -> None:
    with client_of(run) as client:
        client.round()
        got = client.request(SIMULATION, 0, 1, text("two") + bytes(24))
        assert got.payload[:12] == text("two")
        assert struct.unpack(">3d", got.payload[12:]) == pytest.approx(TWO)
        goal = (8.0, 2.0, 0.25)
        client.request(SIMULATION, 0, 2, text("two") + struct.pack(">3d", *goal))
        client.round()
        got = client.request(SIMULATION, 0, 3, text("two") + bytes(56))
        x, y, z, roll, pitch, yaw, microseconds = struct.unpack(">7d", got.payload[12:])
        assert (x, y, z, roll, pitch, yaw) == pytest.approx((8.0, 2.0, 0, 0, 0, 0.25))
        assert microseconds == pytest.approx(run.simulation.time * 1e6)
        assert run.pose(1) == pytest.approx(goal)


def test_time_is_eight_bytes_of_microseconds(run: Serving) -> None:
    with client_of(run) as client:
        for _ in range(7):
            client.round()
        assert struct.unpack("<Q", ask_property(client, "one", "time", 8)) == (700_000,)


def test_a_colour_is_set_and_told_as_four_floats_and_cameras_see_it(run: Serving) -> None:
    with client_of(run, (BLOBFINDER, 0)) as client:
        client.round()
        assert struct.unpack("<4f", ask_property(client, "two", "color", 16)) == (0, 0, 1, 1)
        green = struct.pack("<4f", 0.0, 1.0, 0.0, 1.0)
        client.request(SIMULATION, 0, 6, text("two") + text("color") + bytes(4) + octets(green))
        payload = client.round()[BLOBFINDER, 0, 1].payload
        count = struct.unpack(">I", payload[8:12])[0]
        seen = {struct.unpack_from(">I", payload, 16 + 40 * k + 4)[0] for k in range(count)}
        assert seen == {0xFF0000, 0x00FF00}
        assert ask_property(client, "two", "color", 16) == green


def test_properties_and_speech_stand_in_the_result(run: Serving) -> None:
    with client_of(run) as client:
        client.round()
        value = octets(b'{"a": [1, 2]}')
        client.request(SIMULATION, 0, 6, text("one") + text("plan") + bytes(4) + value)
        client.command(12, 0, 1, text("hello there"))
        client.round()
        got = client.request(
            SIMULATION, 0, 5, text("one") + text("plan") + bytes(4) + octets(bytes(40))
        )
        assert b'{"a": [1, 2]}'.ljust(40, b"\0") in got.payload  # as long as what was asked for
    one = run.stop().robot("one")
    assert one.properties == {"plan": {"a": [1, 2]}}
    assert one.said == [(0.1, "hello there")]
    assert one.devices == ["position2d:0"]


def test_reset_puts_everybody_back_where_they_started(run: Serving) -> None:
    with client_of(run) as client:
        for _ in range(20):
            client.drive(0.5, 0.2)
            client.round()
        client.request(SIMULATION, 0, 2, text("two") + struct.pack(">3d", 8.0, 2.0, 0.25))
        client.drive(0.0)
        state(client, 15)
        client.command(SIMULATION, 0, 2)
        assert state(client)[:3] == pytest.approx((0, 0, 0), abs=1e-9)
        assert run.pose(0) == pytest.approx(ONE)
        assert run.pose(1) == pytest.approx(TWO)


def put(client: RawClient, name: str, *pose: float) -> int:
    """The type of the answer to a request to put a robot somewhere."""
    return client.request(SIMULATION, 0, 2, text(name) + struct.pack(">3d", *pose)).type


def test_two_robots_swap_by_way_of_a_third_place_before_one_tick(run: Serving) -> None:
    with client_of(run) as client:
        client.round()
        assert put(client, "one", *TWO) == NACK
        assert put(client, "one", 8.0, 2.0, 0.0) == ACK
        assert put(client, "two", *ONE) == ACK
        assert put(client, "one", *TWO) == ACK
        client.round()
        assert run.pose(0) == pytest.approx(TWO)
        assert run.pose(1) == pytest.approx(ONE)
        # where it stands is free for who stands there
        assert put(client, "one", TWO[0], TWO[1], 1.0) == ACK


def test_a_reset_leaves_those_on_whose_start_something_stands(run: Serving) -> None:
    with client_of(run) as client:
        client.round()
        put(client, "two", 8.0, 2.0, 0.0)
        client.round()
        run.engine.robots[1].record.start = run.engine.robots[0].record.start
        client.command(SIMULATION, 0, 2)
        client.round()
        assert run.pose(0) == pytest.approx(ONE)
        assert run.pose(1) == pytest.approx((8.0, 2.0, 0.0))


def test_a_pause_stops_the_clock_until_it_is_lifted(run: Serving) -> None:
    with client_of(run) as client, RawClient(run.port("one")) as tool:
        client.round()
        tool.command(SIMULATION, 0, 1)
        assert tool.request(POSITION2D, 0, 1).type == ACK  # answered while it stands
        client.ask()
        client.socket.settimeout(0.3)  # no data comes: as long as one cares to wait
        with pytest.raises(TimeoutError):
            client.answer()
        assert run.simulation.ticks == 1
        client.socket.settimeout(PATIENCE)
        tool.command(SIMULATION, 0, 1)
        while client.receive().type != 5:
            pass
        assert run.simulation.ticks == 2


def test_a_pause_ends_with_the_client_that_asked_for_it(run: Serving) -> None:
    with client_of(run) as client:
        with RawClient(run.port("one")) as tool:
            tool.command(SIMULATION, 0, 1)
            assert tool.request(POSITION2D, 0, 1).type == ACK
            assert run.engine.context.paused
        client.round()
        assert run.simulation.ticks == 1
