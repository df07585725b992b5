"""Entries become robots one by one, each with a name of its own."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from world_texts import HEAD, mistakes_in

from sim.build import LoadedWorld, load


def loaded(tmp_path: Path, text: str) -> LoadedWorld:
    path = tmp_path / "world.yaml"
    path.write_text(HEAD + text)
    return load(path)


def test_robots_without_names_are_numbered_model_by_model_through_all_entries(
    tmp_path: Path,
) -> None:
    world = loaded(
        tmp_path,
        "  cart: {body: {shape: box, size: [0.4, 0.4]}}\n"
        "robots:\n"
        "  - {model: rover, count: 2, placement: random}\n"
        "  - {model: cart, placement: random}\n"
        "  - {model: rover, pose: [5, 4, 0]}\n"
        "  - {model: rover, name: boss, placement: random}\n"
        "  - {model: rover, name: team, count: 2, placement: random}\n"
        "  - {model: rover, name: solo, count: 1, placement: random}\n"
        "  - {model: rover, placement: random}\n",
    )
    names = [robot.name for robot in world.robots]
    assert names == [
        "rover1", "rover2", "cart1", "rover3", "boss", "team1", "team2", "solo1", "rover4",
    ]  # fmt: skip
    assert [robot.entry for robot in world.robots] == [0, 0, 1, 2, 3, 4, 4, 5, 6]


def test_poses_and_headings_are_in_radians(tmp_path: Path) -> None:
    world = loaded(
        tmp_path,
        "robots:\n  - {model: rover, pose: [5, 4, 90]}\n"
        "  - {model: rover, placement: random, headings: [0, 180]}\n",
    )
    assert world.robots[0].pose == (5, 4, math.pi / 2)
    assert world.robots[1].pose is None
    assert world.robots[1].headings == (0, math.pi)


def test_a_robot_has_the_program_of_its_entry(tmp_path: Path) -> None:
    world = loaded(
        tmp_path,
        "robots:\n  - {model: rover, pose: [5, 4, 0], controller: wander}\n"
        "  - {model: rover, pose: [2, 4, 0], controller: null}\n"
        "  - {model: rover, pose: [7, 4, 0]}\n",
    )
    assert [robot.controller for robot in world.robots] == ["wander", None, None]


def test_random_places_depend_on_the_seed_alone(tmp_path: Path) -> None:
    text = "robots: [{model: rover, count: 5, placement: random}]\n"
    world = loaded(tmp_path, text)
    assert np.array_equal(world.place(7), world.place(7))
    assert not np.array_equal(world.place(7), world.place(8))
    assert np.array_equal(world.place(1), world.start)  # the world's own seed
    other = loaded(tmp_path, "name: another\nduration: 3\n" + text)
    assert np.array_equal(other.place(7), world.place(7))


def test_what_the_caller_does_to_the_places_is_the_callers(tmp_path: Path) -> None:
    world = loaded(tmp_path, "robots: [{model: rover, pose: [5, 4, 0]}]\n")
    world.place(1)[:] = 0
    assert world.place(1).tolist() == [[5, 4, 0]]


@pytest.mark.parametrize(
    ("names", "clash"),
    [
        (("s", "t"), None),
        (("s", "s2"), "s21"),
        (("s2", "s"), "s21"),
        (("s", "s0"), None),  # s01 is no name from the door s
        (("s", "sa"), None),
    ],
)
def test_robots_from_two_doors_never_have_one_name(
    tmp_path: Path, names: tuple[str, str], clash: str | None
) -> None:
    doors = "".join(
        f"  - {{name: {name}, at: [{x}, 2], model: rover, period: 1}}\n"
        for x, name in zip((2, 4), names, strict=True)
    )
    if clash is None:
        assert loaded(tmp_path, "doors:\n" + doors).layout.doors
    else:
        (found,) = mistakes_in(tmp_path, HEAD + "doors:\n" + doors)
        assert found.startswith(f"7:12: doors.1.name: a robot from this door would be called as "
                                f"another, {clash}")  # fmt: skip


@pytest.mark.parametrize(("robot", "clashes"), [("s7", True), ("s07", False), ("s", False)])
def test_a_robot_and_one_from_a_door_never_have_one_name(
    tmp_path: Path, robot: str, clashes: bool
) -> None:
    text = (
        f"robots: [{{name: {robot}, model: rover, pose: [5, 4, 0]}}]\n"
        "doors: [{name: s, at: [2, 2], model: rover, period: 1}]\n"
    )
    if clashes:
        (found,) = mistakes_in(tmp_path, HEAD + text)
        assert "6:16: doors.0.name" in found
    else:
        loaded(tmp_path, text)
