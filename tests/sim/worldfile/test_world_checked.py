"""A checked world is what its file says; what is built of it adds its mistakes at their places."""

from __future__ import annotations

from pathlib import Path

import pytest
from world_texts import HEAD, mistakes_in

from sim.build import build
from sim.worldfile import Mistake, WorldError, check_file

OVERLAP = "robots:\n  - {model: rover, pose: [5, 4, 0]}\n  - {model: rover, pose: [5.1, 4, 0]}\n"


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "world.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_robots_that_overlap_are_no_mistake_of_the_text_but_of_what_is_built(
    tmp_path: Path,
) -> None:
    path = written(tmp_path, HEAD + OVERLAP)
    checked = check_file(path)
    assert checked.error() is None
    with pytest.raises(WorldError) as raised:
        build(checked)
    assert [str(one) for one in raised.value.mistakes] == [
        f"{path}:7:26: robots.1.pose: the robot starts in robot rover1 "
        "(given: robot rover2 at [5.1, 4]; allowed: a free place)"
    ]


def test_both_kinds_of_mistakes_are_told_at_once_in_the_order_of_the_file(tmp_path: Path) -> None:
    found = mistakes_in(tmp_path, HEAD + OVERLAP + "untill: duration\n")
    assert [one.split(":")[0] for one in found] == ["7", "8"]
    assert "the robot starts in robot rover1" in found[0]
    assert "untill" in found[1]


def test_what_is_found_later_is_placed_by_the_files_indices_though_entries_were_left_out(
    tmp_path: Path,
) -> None:
    text = "doors:\n  - {at: S, name: 3}\n  - {at: [2, 2], name: b, model: rover, period: 1}\n"
    checked = check_file(written(tmp_path, HEAD + text))
    assert checked.world is not None
    assert len(checked.world.doors) == 1
    error = checked.error([Mistake(("doors", 0, "at"), "is in a wall")])
    assert error is not None
    (late,) = [one for one in error.mistakes if one.what == "is in a wall"]
    assert (late.line, late.where) == (7, ("doors", 1, "at"))
