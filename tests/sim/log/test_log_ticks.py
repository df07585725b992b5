"""What a run has noted is in its log, tick by tick, also where tapes end and robots come."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

import troupe
from sim.log.recover import recover

WORLD: dict[str, Any] = {
    "size": [6, 6],
    "duration": 9,
    "until": "duration",
    "models": {
        "m": {
            "body": {"shape": "circle", "radius": 0.2},
            "drive": {"kind": "differential", "max_speed": 0.5, "max_turn_rate": 90},
            "sensors": [
                {"type": "laser", "samples": 5},
                {"type": "blobfinder", "colors": ["red"], "image": [20, 10]},
            ],
        }
    },
    "robots": [
        {"name": "a", "model": "m", "pose": [1, 2, 0]},
        {"name": "b", "model": "m", "pose": [4, 2, 90]},
    ],
}
FORMAT_1 = Path(__file__).parent / "format_1.mcap"
"""A log of such a run with 25 ticks, in the first 12 of which both robots were commanded anew."""


def test_ticks_go_on_where_a_tape_ends(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # each tape has room for one row, and the run waits until it is written
    for name in ("FIRST_TAPE", "TAPE", "CHUNK_BYTES", "MOST_WAITING"):
        monkeypatch.setattr(f"sim.log.writer.{name}", 1)
    poses, ranges, sent = [], [], []
    log = tmp_path / "run.mcap"
    with troupe.Simulation(WORLD, log=log, log_sensors=["all"], controllers=False) as sim:
        for tick in range(50):
            turn = 0.01 * tick
            sim.command(forward=0.2, turn=turn)
            sent += [(tick + 1, 0, turn), (tick + 1, 1, turn)]
            sim.step()
            poses.append(sim.poses)
            ranges.append(sim.readings("laser").ranges.astype(np.float32))
    kept = troupe.Log(log)
    assert kept.ticks.tolist() == list(range(1, 51))
    assert kept.poses.tobytes() == np.array(poses).tobytes()
    for robot, name in enumerate("ab"):
        scans = kept.scans(name).ranges
        assert scans.tobytes() == np.array(ranges)[:, robot].tobytes()
    told = kept.commands[["tick", "robot", "wz"]].tolist()
    assert [one[:2] for one in told] == [one[:2] for one in sent]
    np.testing.assert_allclose([one[2] for one in told], [one[2] for one in sent])
    part = kept[2.35:3.15].commands
    assert sorted(set(part["tick"].tolist())) == list(range(24, 32))


def test_velocities_are_rounded_and_a_body_that_stands_has_one_zero(tmp_path: Path) -> None:
    log, velocities = tmp_path / "run.mcap", []
    with troupe.Simulation(WORLD, log=log, controllers=False) as sim:
        for tick in range(40):
            sim.command(forward=0.2 * (tick % 3 - 1), turn=0.0317 * (tick % 5 - 2))
            sim.step()
            velocities.append(sim.velocities)
    known, kept = np.array(velocities), troupe.Log(log).velocities
    assert ((known < 0) & (known > -1e-9)).any()  # who turns slips by less than any rounding shows
    assert not np.signbit(kept[kept == 0]).any()
    assert np.abs(kept - known).max() <= 2.0**-17 + np.spacing(np.float32(1))
    assert np.array_equal(kept * 2**16, np.rint(kept * 2**16))


def test_other_readers_find_the_commands_of_a_second_in_one_message(tmp_path: Path) -> None:
    log = tmp_path / "run.mcap"
    with troupe.Simulation(WORLD, log=log, controllers=False) as sim:
        for tick in range(15):
            sim.command(forward=0.2, turn=0.01 * tick)
            sim.step()
    with log.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        one = [m for _, _, _, m in reader.iter_decoded_messages(topics=["/troupe/commands"])]
    with AnyReader([log]) as bag:
        wanted = [c for c in bag.connections if c.topic == "/troupe/commands"]
        two = [bag.deserialize(d, c.msgtype) for c, _, d in bag.messages(connections=wanted)]
    for found in (one, two):
        assert [tick for message in found for tick in message.ticks] == sorted([*range(1, 16)] * 2)
        assert [robot for message in found for robot in message.robots] == [0, 1] * 15
        turns = [turn for message in found for turn in message.wz]
        np.testing.assert_allclose(turns, np.repeat(0.01 * np.arange(15), 2))
        assert all(len(message.goal_yaw) == 0 for message in found)
        limits = [(message.stamp.sec, message.ticks[-1] // 10) for message in found]
        assert all(first == last for first, last in limits)


def test_a_new_colour_is_in_the_state_and_in_a_new_body_from_its_tick_on(tmp_path: Path) -> None:
    log = tmp_path / "run.mcap"
    with troupe.Simulation(WORLD, log=log, log_sensors=["laser"], controllers=False) as sim:
        sim.step(3)
        engine = sim._engine
        robot = engine.robots[1]
        engine.context.later(robot, lambda: engine.scenery.set_color(robot, 0x0000FF))
        sim.step(3)
    kept = troupe.Log(log)
    assert kept.colors[:, 1].tolist() == [kept.colors[0, 1]] * 3 + [0x0000FF] * 3
    bodies = [one for _, one in kept._reader.messages("/troupe/bodies")]
    assert len(bodies) == 2
    assert kept.scans("b").ranges.shape == (6, 5)


def test_a_log_of_format_1_is_read_checked_and_recovered(tmp_path: Path) -> None:
    saved = tmp_path / "saved.mcap"
    recover(FORMAT_1, saved)
    for path in (FORMAT_1, saved):
        kept = troupe.Log(path)
        assert kept.poses.shape == (25, 2, 3)
        assert kept.commands["tick"].tolist() == np.repeat(np.arange(1, 13), 2).tolist()
        np.testing.assert_allclose(kept.commands["wz"], np.repeat(0.1 * np.arange(12), 2))
        assert kept[0.45:0.75].commands["tick"].tolist() == [5, 5, 6, 6, 7, 7]
        assert kept.scans("a").ranges.shape == (25, 5)


def test_readings_whose_array_another_takes_the_place_of_are_kept(tmp_path: Path) -> None:
    log, ranges = tmp_path / "run.mcap", []
    with troupe.Simulation(WORLD, log=log, log_sensors=["laser"], controllers=False) as sim:
        (group,) = [one for one in sim._engine.scenery.suite.groups if one.kind == "scan"]
        sense = group.type.sense

        def in_a_new_array(settings: Any, view: Any, readings: Any) -> None:
            sense(settings, view, readings)
            readings.ranges = readings.ranges.astype(np.float32) + np.float32(view.tick)

        group.type = replace(group.type, sense=in_a_new_array)
        for _ in range(5):
            sim.step()
            ranges.append(group.readings.ranges)
        recorder = sim._recorder
        assert recorder is not None
        sheet = recorder.tape.sheet
        sim.step()
        assert recorder.tape.sheet is sheet  # looked for once, not in every tick
    kept = troupe.Log(log).scans("b").ranges
    assert kept[:5].tobytes() == np.array(ranges)[:, 1].tobytes()
