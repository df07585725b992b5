"""Values at the ends of what can be written: a mistake with its place, or a world that runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from world_texts import HEAD, mistakes_in, mistakes_of

import troupe
from sim.stage import distance_field
from sim.stage.geometry import Floats
from troupe.address import parse_address
from troupe.usage import UsageError
from troupe.worlds import find_world

LASER = "    sensors: [{type: laser, %s}]\n"
REFUSED = {
    "clock: {interval: 1.0e-12}": "5:19: clock.interval: is too small",
    "clock: {interval: 1.0e-300}": "5:19: clock.interval: is too small",
    "clock: {interval: 1e308}": "5:19: clock.interval: is out of range",
    "boundary: {thickness: 1e10}": "5:23: boundary.thickness: is out of range",
    "floor: {resolution: 1e-12}": "5:21: floor.resolution: is too small",
    "player: {host: a..b}": "5:16: player.host: cannot be a host",
    f"player: {{host: {'a' * 300}}}": "5:16: player.host: cannot be a host",
    f"player: {{host: {'a.' * 200}}}": "5:16: player.host: cannot be a host",
    "player: {host: 'a b'}": "5:16: player.host: cannot be a host",
    'player: {host: "a\\0b"}': "5:16: player.host: cannot be a host",
    'player: {host: "a\\e[2Jb"}': "5:16: player.host: cannot be a host",
    "player: {host: ''}": "5:16: player.host: cannot be a host",
    "include: " + "x" * 5000: "5:10: include: cannot be read: File name too long",
    "map: {file: " + "x" * 5000 + ", cell: 1}": "5:13: map.file: the map cannot be read",
    LASER % "range: 1e300": "5:36: models.rover.sensors.0.range: is out of range",
    LASER % "pose: [0, -1e10, 0]": "5:39: models.rover.sensors.0.pose.1: is out of range",
    LASER % f"range: 1{'0' * 300}": "5:36: models.rover.sensors.0.range: is out of range",
    "region: [[1, 1], [1e9, 1], [9, 7], [1, 7]]\n"
    "robots: [{model: rover, count: 3, placement: {same_y: true}}]": "5:9: region: a corner lies",
    "robots:\n- {model: rover, count: 99999, placement: random}\n"
    "- {model: rover, count: 99999, placement: random}": "7:3: robots.1: with these there would be",
}


@pytest.mark.parametrize("text", REFUSED, ids=range(len(REFUSED)))
def test_what_is_beyond_all_measure_is_one_mistake_with_its_place(
    tmp_path: Path, text: str
) -> None:
    (told,) = mistakes_in(tmp_path, HEAD + text + "\n")
    assert told.startswith(REFUSED[text])
    assert len(told) < 800


@pytest.mark.parametrize(
    "change",
    ["boundary.thickness=1e9", "boundary.height=1e9", "robots.0.pose=[0.3, 0.3, 1e9]",
     "models.r.body.height=1e-9", "size=[1e6, 1]", "size=[1e9, 1]", "size=[1, 1e9]",
     "obstacles=[{shape: box, size: [1e9, 0.1], pose: [0, 6, 30]}]",
     "models.r.body.mass=1e9", "floor.resolution=1e9",
     "duration=1e-9", "clock={interval: 1e-9}", "name=" + "x" * 5000],
)  # fmt: skip
def test_a_world_at_the_ends_of_what_is_allowed_runs(
    tmp_path: Path, change: str, recwarn: pytest.WarningsRecorder
) -> None:
    path = tmp_path / "world.yaml"
    path.write_text(
        "size: [8, 8]\nduration: 0.2\nuntil: duration\n"
        "models: {r: {body: {shape: circle, radius: 0.2}, sensors: [{type: laser}]}}\n"
        "robots: [{model: r, pose: [0.5, 0.5, 0]}]\n"
    )
    extra = ["duration=3e-9"] if "interval" in change else []
    result = troupe.run(path, settings=[change, *extra])
    assert result.outcome == "completed"
    assert not list(recwarn)


def test_an_outline_marks_the_same_cells_however_far_it_goes_on() -> None:
    """A wall of 10 m along the x axis, and the same wall up to 10^9 m away."""
    short, long = np.full((2, 40, 40), 255, np.uint8)
    wall: Floats = np.array([[0.0, 5.0], [10.0, 5.0], [10.0, 5.5], [0.0, 5.5]])
    distance_field._mark(short, 0.25, wall)
    distance_field._mark(long, 0.25, np.where(wall == 10.0, 1e9, wall) - [[3e8, 0]])
    assert short[20].max() == 0
    assert short[22].max() == 0
    assert long[20].max() == 0
    assert long[22].max() == 0
    assert long[21, 1:-1].min() == 255  # its ends are far away


@pytest.mark.parametrize("host", ["a..b", "a" * 300, "a b", "\x1b[31m"])
def test_no_option_takes_a_host_that_cannot_be_one(host: str) -> None:
    with pytest.raises(UsageError, match="must be HOST:PORT"):
        parse_address("view", f"{host}:6665")


def test_a_world_with_a_name_that_no_file_can_have_is_told() -> None:
    with pytest.raises(ValueError, match="no such world"):
        find_world("x" * 5000)


SETTINGS = {
    "models.rovr.x=1": "models.rovr.x: unknown key; the file has no models.rovr; "
    "did you mean rover?",
    "models.rovr.drive.max_speed=1": "models.rovr.body: is missing; the file has no models.rovr; "
    "did you mean rover?",
    "controllers.mne.args.speed=1": "controllers.mne: a controller is one of three kinds; the "
    "file has no controllers.mne; did you mean mine?",
    "modls.rover.drive=null": "modls: unknown key; did you mean models?",
    "models.rover.drve.max_speed=1": "models.rover.drve: unknown key; did you mean drive?",
}


@pytest.mark.parametrize("setting", SETTINGS)
def test_a_name_in_a_setting_that_is_nearly_one_of_the_files_is_suggested(
    tmp_path: Path, setting: str
) -> None:
    path = tmp_path / "world.yaml"
    path.write_text(HEAD + "controllers: {mine: {external: true}}\n")
    told = mistakes_of(path, setting)
    assert any(one.startswith(f"--set {setting}: {SETTINGS[setting]}") for one in told)


def test_a_setting_may_still_make_a_model_with_nearly_the_same_name(tmp_path: Path) -> None:
    path = tmp_path / "world.yaml"
    path.write_text(HEAD + "duration: 0.1\nuntil: duration\n")
    new = ["models.rover2.body.shape=circle", "models.rover2.body.radius=1"]
    assert troupe.run(path, settings=new).outcome == "completed"
