"""One mistake does not hide another one, however deep the first goes."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.build import load
from sim.worldfile import WorldError


def mistakes(tmp_path: Path, text: str) -> list[str]:
    """What is wrong with a world, each as `place: words`."""
    path = tmp_path / "world.yaml"
    path.write_text(text)
    with pytest.raises(WorldError) as caught:
        load(path)
    return [f"{'.'.join(map(str, one.where))}: {one.what}" for one in caught.value.mistakes]


def test_a_bad_size_does_not_hide_a_missing_map(tmp_path: Path) -> None:
    found = mistakes(tmp_path, "size: [-1, 5]\nmap: {file: nowhere.txt, cell: 1}\n")
    assert [one.partition(":")[0] for one in found] == ["size.0", "map.file"]


def test_a_bad_size_does_not_hide_a_door_without_its_place(tmp_path: Path) -> None:
    (tmp_path / "map.txt").write_text("###\n#.#\n###\n")
    found = mistakes(
        tmp_path,
        "size: wide\nmap: {file: map.txt, cell: 1}\n"
        "models: {m: {body: {shape: box, size: [0.5, 0.5]}}}\n"
        "doors: [{name: s, at: S, model: m, period: 1}]\n",
    )
    assert [one.partition(":")[0] for one in found] == ["size", "doors.0.at"]


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("{shape: sphere, radius: 1, mass: -2, colour: red}", ["shape", "mass", "colour"]),
        ("{shape: sphere, radius: -1}", ["shape", "radius"]),
        ("{shape: boxx, size: [1, 1], height: x}", ["shape", "height"]),
        ("{shape: boxx, radius: 1, height: x}", ["shape", "height"]),
        ("{shape: sphere, mass: 0}", ["shape", "mass"]),
        ("{points: [[0, 0], [1, 0], [0, 1]], friction: -1}", ["shape", "friction"]),
        ("{shape: [1], size: [1, 1]}", ["shape"]),
        ("{}", ["shape"]),
    ],
)
def test_a_bad_shape_does_not_hide_the_rest_of_its_body(
    tmp_path: Path, body: str, expected: list[str]
) -> None:
    text = (
        f"size: [5, 5]\nmodels: {{m: {{body: {body}, drive: {{max_speed: 0}}}}}}\n"
        "robots: [{model: m, pose: [0, 0, 0]}]\n"  # in the wall, whatever its shape
    )
    found = [one.partition(":")[0] for one in mistakes(tmp_path, text)]
    assert sorted(found) == sorted([f"models.m.body.{key}" for key in expected] +
                                   ["models.m.drive.max_speed"])  # fmt: skip


def test_a_bad_shape_does_not_hide_the_rest_of_an_obstacle_or_the_next_one(tmp_path: Path) -> None:
    found = mistakes(
        tmp_path,
        "size: [5, 5]\nobstacles:\n"
        "  - {shape: oval, pose: [1, 2], movable: maybe}\n"
        "  - {shape: box, size: [1, -1], pose: [1, 2, 3]}\n"
        "  - {shape: circle, radius: 1, pose: [1, 2, 3], speed: 1}\n",
    )
    assert [one.partition(":")[0] for one in found] == [
        "obstacles.0.shape", "obstacles.0.pose", "obstacles.0.movable", "obstacles.1.size.1",
        "obstacles.2.speed",
    ]  # fmt: skip


@pytest.mark.parametrize("wrong", ["pose: [1, 1]", "pose: here", "colour: red, pose: [1, 1, 0]"])
def test_a_robot_with_a_mistake_is_told_of_its_model_and_controller_too(
    tmp_path: Path, wrong: str
) -> None:
    found = mistakes(
        tmp_path,
        "size: [5, 5]\nmodels: {m: {body: {shape: box, size: [0.5, 0.5]}}}\n"
        f"robots: [{{model: k, controller: nobody, {wrong}}}]\n",
    )
    places = [one.partition(":")[0] for one in found]
    assert {"robots.0.model", "robots.0.controller"} < set(places)
    assert len(places) == 3
