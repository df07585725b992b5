"""Paint in the simulated world: judged from the true poses of every tick."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import troupe
from controllers.paint.constants import OVERLAP
from tests import started
from tests.processes import ROOT
from troupe.testing.paint.judge import judged_run, reported_goal

WORLDS = ROOT / "worlds"
NO_PAINT = ["controllers.paint.args.paint=false"]


@pytest.mark.parametrize(
    ("case", "seed", "jitter"),
    [(1, 11, 0), (1, 12, 1), (2, 13, 0), (2, 14, 1), (3, 15, 0), (3, 16, 1)],
)
def test_all_reach_their_goals_in_order_and_touch_nothing(
    case: int, seed: int, jitter: float
) -> None:
    settings = [*NO_PAINT, f"controllers.paint.args.jitter={jitter}"]
    run = judged_run(WORLDS / f"paint_case_{case}.yaml", seed, settings)
    assert run.faults == []
    for robot in run.result["robots"]:
        assert robot["devices"] == [
            "position2d:0", "laser:0", "blobfinder:0", "speech:0", "simulation:0",
        ]  # fmt: skip


@pytest.mark.parametrize("seed", range(40))
def test_in_case_iii_two_robots_on_one_line_have_opposite_orientations(seed: int) -> None:
    poses = troupe.load(WORLDS / "paint_case_3.yaml").loaded.place(seed)
    assert poses[0, 1] == poses[1, 1]
    assert math.cos(poses[0, 2] - poses[1, 2]) == pytest.approx(-1.0)


def test_who_hides_two_nearly_level_robots_from_each_other_leaves_their_line() -> None:
    # Two robots are level; the third, 6 cm lower, is hidden from the first by the one between.
    settings = [*NO_PAINT, "controllers.paint.args.jitter=1"]
    assert judged_run(WORLDS / "paint_case_3.yaml", 1156, settings).faults == []


@pytest.mark.parametrize(("world", "seed"), [("line", 23), ("swarm_8", 7), ("swarm_12", 38)])
def test_lines_and_crowds_reach_their_goals(world: str, seed: int) -> None:
    assert judged_run(WORLDS / f"paint_{world}.yaml", seed, NO_PAINT).faults == []


@pytest.mark.parametrize(("world", "seed"), [("case_2", 21), ("tall", 22)])
def test_the_whole_floor_is_painted_and_each_paints_its_own_strip(world: str, seed: int) -> None:
    run = judged_run(WORLDS / f"paint_{world}.yaml", seed)
    assert run.faults == []
    assert run.result["floor"]["coverage"] >= 0.999
    assert run.result["floor"]["passes"] <= 1.35
    assert run.painted_outside < OVERLAP + 0.01  # 0.01: what braking takes beyond a lane
    for robot in run.result["robots"]:
        told = robot["properties"]
        assert {"rank", "strip", "goal", "goal_time", "paint_time", "done_time"} <= told.keys()
        assert told["goal_time"] <= told["paint_time"] < told["done_time"]
        height = run.region[:, 1].max() / len(run.result["robots"])
        assert told["strip"][1] - told["strip"][0] == pytest.approx(height, abs=1e-3)  # 4 digits
        assert "dio:0" in robot["devices"]
        assert [text for _, text in robot["said"]][-2:] == ["painting", "done"]
        assert any(text.startswith("observing") for _, text in robot["said"])


def test_a_convex_region_is_painted_but_for_corners_that_no_body_reaches() -> None:
    run = judged_run(WORLDS / "paint_convex.yaml", 5)
    assert run.result["outcome"] == "completed", run.faults
    assert run.contacts == []
    assert run.swaps == []
    assert run.result["floor"]["coverage"] >= 0.98  # triangles beside slanted edges stay bare
    assert run.painted_outside < OVERLAP + 0.01  # as in a rectangle


STARTS = [(3.0, 4.0, 0), (12.0, 6.5, 180), (7.0, 15.0, 180), (10.5, 11.0, 0)]


def goals_by_start(world: Path) -> dict[int, list[float]]:
    """The goals, relative to the arena's corner, by the number in `STARTS`."""
    result = troupe.run(world)
    assert result.outcome == "completed"
    low = np.min([robot.start[:2] for robot in result.robots], axis=0) - (3.0, 4.0)
    found = {}
    for robot in result.robots:
        number = next(
            i for i, (x, y, _) in enumerate(STARTS)
            if np.allclose(np.array(robot.start[:2]) - low, (x, y))
        )  # fmt: skip
        found[number] = (reported_goal(robot.as_json()) - low).round(3).tolist()
    return found


def write_world(folder: Path, order: list[int], shift: float, names: str) -> Path:
    """A world of the four robots of `STARTS`, in that order, the arena's corner shifted."""
    world: dict[str, Any] = yaml.safe_load((WORLDS / "parts" / "paint.yaml").read_text())
    world["robots"] = [
        {
            "name": f"{names}{k}",
            "model": "painter",
            "pose": [STARTS[i][0] + shift, STARTS[i][1] + shift, STARTS[i][2]],
            "controller": "paint",
        }
        for k, i in enumerate(order)
    ]
    world["controllers"] = {"paint": {"program": "paint", "args": {"robots": 4, "paint": False}}}
    if shift:
        a, b, c = shift, 16 + shift, 21 + shift
        world["size"] = [16 + 2 * shift, 21 + 2 * shift]
        world["region"] = [[a, a], [b, a], [b, c], [a, c]]
        world["boundary"] = {"shape": "region"}
    path = folder / f"world_{names}.yaml"
    path.write_text(yaml.safe_dump(world))
    return path


def test_names_order_in_the_file_and_the_arenas_place_make_no_difference(tmp_path: Path) -> None:
    plain = goals_by_start(write_world(tmp_path, [0, 1, 2, 3], 0.0, "r"))
    assert len(plain) == 4
    shuffled = goals_by_start(write_world(tmp_path, [2, 0, 3, 1], 0.0, "zeta"))
    moved = goals_by_start(write_world(tmp_path, [3, 2, 1, 0], 3.0, "m"))
    assert shuffled == plain
    assert moved == plain


@pytest.mark.parametrize(("told", "message"), [(5, "5 robots"), (3, "not 3")])
def test_a_wrong_number_of_robots_ends_with_a_message_and_no_contact(
    told: int, message: str
) -> None:
    setting = f"controllers.paint.args.robots={told}"
    done = started.troupe(
        "run", WORLDS / "paint_case_2.yaml", "--seed", "1", "--json", "--set", setting
    )
    result = json.loads(done.stdout)
    assert done.returncode == 1
    assert result["outcome"] == "controller_failed"
    assert message in done.stderr
    failed = [r for r in result["robots"] if r["controller"]["state"] == "failed"]
    assert failed
    assert all(message in robot["said"][-1][1] for robot in failed)
    assert all(robot["contacts"] == 0 for robot in result["robots"])
    assert result["sim_time"] < 600.0
