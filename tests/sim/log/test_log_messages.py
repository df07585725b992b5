"""What a log holds, decoded by readers that know nothing of us, is what the run knew."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

import troupe

PROGRAM = """\
from player import LaserProxy, PlayerClient, Position2dProxy, SimulationProxy, SpeechProxy

with PlayerClient() as robot:
    base, laser = Position2dProxy(robot), LaserProxy(robot)
    speech, simulation = SpeechProxy(robot), SimulationProxy(robot)
    ticks = 0
    while robot.read():
        ticks += 1
        base.set_speed(0.4, 0.1 * ticks)
        if ticks == 3:
            speech.say("\\x1b[31mthree")
            simulation.report("rank", 7)
    print("done")
"""


def run_kept(world: Path, log: Path, **more: Any) -> dict[str, np.ndarray]:
    """Run a world with a log; what the simulation knew, tick by tick."""
    known: dict[str, list[np.ndarray]] = {"poses": [], "ranges": [], "odometry": []}

    def look(simulation: troupe.Simulation) -> None:
        known["poses"].append(simulation.poses)
        known["odometry"].append(simulation.odometry)
        known["ranges"].append(simulation.readings("laser").ranges.astype(np.float32))

    troupe.run(world, log=log, each_tick=look, **more)
    return {name: np.array(rows) for name, rows in known.items()}


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, np.ndarray]]:
    folder = tmp_path_factory.mktemp("kept")
    (folder / "mine.py").write_text(PROGRAM)
    (folder / "world.yaml").write_text(
        "size: [10, 10]\nduration: 3\nuntil: duration\n"
        "models:\n"
        "  rover:\n"
        "    body: {shape: box, size: [1, 1]}\n"
        "    sensors: [{type: laser, samples: 36}, {type: blobfinder, colors: [red, green]},\n"
        "      {type: ranger, elements: [[0, 0, 0], [0, 0, 90]]}]\n"
        "robots:\n"
        "  - {name: one, model: rover, pose: [2, 5, 0], controller: mine}\n"
        "  - {name: twotwo, model: rover, pose: [5, 5, 90], controller: wander}\n"
        "controllers: {mine: {program: ./mine.py}, wander: {program: wander}}\n"
    )
    known = run_kept(folder / "world.yaml", folder / "run.mcap", log_sensors=["all"])
    return folder / "run.mcap", known


def test_what_nobody_reads_is_logged_from_the_first_tick_on(tmp_path: Path) -> None:
    world = {
        "size": [5, 5],
        "duration": 1,
        "models": {"m": {"body": {"shape": "circle", "radius": 0.3},
                         "sensors": [{"type": "laser", "samples": 5}, {"type": "blobfinder"}]}},
        "robots": [{"name": "a", "model": "m", "pose": [2, 2, 0]}],
    }  # fmt: skip
    troupe.run(world, log=tmp_path / "run.mcap", log_sensors=["laser"])
    log = troupe.Log(tmp_path / "run.mcap")
    assert log.scans("a").ranges.shape == (10, 5)
    with pytest.raises(KeyError):
        log.blobs("a")


def decoded(path: Path) -> dict[str, list[Any]]:
    """All messages by topic, as `mcap-ros2-support` decodes them with an indexed reader."""
    found: dict[str, list[Any]] = {}
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        for _, channel, _, message in reader.iter_decoded_messages():
            found.setdefault(channel.topic, []).append(message)
    return found


def judged(path: Path) -> dict[str, list[Any]]:
    """The same with `rosbags`."""
    found: dict[str, list[Any]] = {}
    with AnyReader([path]) as reader:
        for connection, _, data in reader.messages():
            message = reader.deserialize(data, connection.msgtype)
            found.setdefault(connection.topic, []).append(message)
    return found


Kept = tuple[Path, dict[str, np.ndarray]]


@pytest.mark.parametrize("read", [decoded, judged])
def test_poses_scans_and_odometry_are_those_of_the_run(
    kept: Kept, read: Callable[[Path], dict[str, list[Any]]]
) -> None:
    path, known = kept
    found = read(path)
    states = np.array([message.poses for message in found["/troupe/state"]])
    assert states.tobytes() == known["poses"].tobytes()
    for robot, name in enumerate(["one", "twotwo"]):
        scans = np.array([message.ranges for message in found[f"/{name}/scan"]], np.float32)
        assert scans.tobytes() == known["ranges"][:, robot].tobytes()
        odometry = [message.pose.pose.position for message in found[f"/{name}/odom"]]
        places = np.array([[at.x, at.y] for at in odometry])
        assert places.tobytes() == known["odometry"][:, robot, :2].copy().tobytes()
        assert found[f"/{name}/scan"][0].header.frame_id == f"{name}/scan"
    assert [message.tick for message in found["/troupe/state"]] == list(range(1, 31))


@pytest.mark.parametrize("read", [decoded, judged])
def test_both_readers_find_every_topic_and_its_messages(
    kept: Kept, read: Callable[[Path], dict[str, list[Any]]]
) -> None:
    path, _ = kept
    found = read(path)
    assert set(found) == {
        "/clock", "/tf", "/map", "/rosout", "/troupe/state", "/troupe/walls", "/troupe/bodies",
        "/troupe/last",
        "/troupe/entries", "/troupe/sensed", "/troupe/commands", "/troupe/said",
        "/troupe/properties",
        *(f"/{name}/{what}" for name in ("one", "twotwo")
          for what in ("scan", "range", "blobs", "odom", "cmd_vel")),
    }  # fmt: skip
    assert len(found["/tf"]) == 30
    assert [message.clock.sec for message in found["/clock"]] == [0, 1, 2, 3]  # once a second
    assert len(found["/one/range"]) == 60  # two elements
    assert found["/troupe/said"][0].text == "\x1b[31mthree"
    assert found["/troupe/properties"][0].value == "7"


def test_tf_is_within_a_millimetre_and_a_milliradian_of_the_poses(kept: Kept) -> None:
    path, known = kept
    for message, poses in zip(decoded(path)["/tf"], known["poses"], strict=True):
        for transform, (x, y, yaw) in zip(message.transforms, poses, strict=True):
            at, turn = transform.transform.translation, transform.transform.rotation
            # half a step of 1/1024 m; half a step of 2^-11 in both parts of a half angle
            assert np.hypot(at.x - x, at.y - y) <= 1e-3
            off = 2 * np.arctan2(turn.z, turn.w) - yaw
            assert abs((off + np.pi) % (2 * np.pi) - np.pi) <= 1e-3


def test_a_channels_messages_stand_in_the_order_of_time(kept: Kept) -> None:
    path, _ = kept
    with path.open("rb") as file:
        for topic in ("/one/blobs", "/troupe/commands", "/one/range"):
            file.seek(0)
            times = [m.log_time for _, _, m in make_reader(file).iter_messages(topics=[topic])]
            assert times == sorted(times)
            assert times
