"""Every example does what its docstring says, with several seeds."""

from __future__ import annotations

import ast
import csv
import json
import math
import os
import re
import runpy
import subprocess
import sys
from pathlib import Path
from statistics import median

import numpy as np
import pytest

import troupe
from sim.result import Result
from tests import started
from tests.patience import PATIENCE
from tests.processes import environment, troupe_command
from troupe.examples import copy_examples, examples

SEEDS = [int(seed) for seed in os.environ.get("EXAMPLE_SEEDS", "1 2").split()]
seeds = pytest.mark.parametrize("seed", SEEDS)


@pytest.fixture(scope="module")
def copies(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The examples as a user copies them."""
    root = tmp_path_factory.mktemp("examples")
    copy_examples((one, root / one.name) for one in examples())
    return root


def run(folder: Path, seed: int) -> Result:
    """The example's world, run to its end."""
    result = troupe.run(folder / "world.yaml", seed=seed, trajectories=True)
    assert result.outcome == "completed", [robot.error for robot in result.robots]
    return result


def told(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], seed: int
) -> str:
    """What the example's program prints, run as a script in its folder."""
    program = f"{folder.name.partition('_')[2]}.py"
    monkeypatch.chdir(folder)
    monkeypatch.setattr(sys, "argv", [program, str(seed)])
    runpy.run_path(program, run_name="__main__")
    return capsys.readouterr().out


@seeds
def test_the_wanderer_touches_nothing_and_never_stands_for_long(copies: Path, seed: int) -> None:
    result = run(copies / "01_wander", seed)
    assert result.poses is not None
    assert result.robots[0].contacts == 0
    later = result.poses[80:, 0, :2] - result.poses[:-80, 0, :2]  # 8 s further on
    assert np.hypot(*later.T).min() > 0.05
    assert result.robots[0].distance > 10.0


@seeds
def test_the_wall_is_followed_all_the_way_round(copies: Path, seed: int) -> None:
    result = run(copies / "02_follow_wall", seed)
    assert result.poses is not None
    assert result.robots[0].contacts == 0
    x, y = result.poses[250:, 0, :2].T  # from 25 s on it has met a wall
    block = np.hypot(np.clip(3.6 - x, 0, None), np.clip(3.0 - y, 0, None))
    wall = np.min([x, y, 6.0 - x, 5.0 - y, block], axis=0)
    assert 0.4 < wall.min() < wall.max() < 0.9
    for place in [(0.6, 2.5), (3.0, 0.6), (5.4, 1.5), (4.8, 2.4), (3.0, 4.0), (1.5, 4.4)]:
        assert np.hypot(x - place[0], y - place[1]).min() < 0.4, place


@seeds
def test_the_orange_ball_is_found_and_not_touched(copies: Path, seed: int) -> None:
    result = run(copies / "03_find_blob", seed)
    rover = result.robots[0]
    assert rover.contacts == 0
    assert "found" in rover.properties
    gap = math.dist(rover.pose[:2], (6.5, 3.0)) - 0.3
    assert 0.25 < gap < 0.6


@seeds
def test_the_puck_is_pushed_to_the_goal(copies: Path, seed: int) -> None:
    result = run(copies / "04_push", seed)
    puck = result.robot("puck")
    assert puck.pose[0] == pytest.approx(7.6 - 0.25, abs=0.02)
    assert 2.0 < puck.pose[1] < 4.0


@seeds
def test_robots_that_keep_their_distance_have_a_metre_of_room(
    copies: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    seed: int,
) -> None:
    said = told(copies / "05_keep_distance", monkeypatch, capsys, seed)
    before, after = (float(gap) for gap in re.findall(r"([\d.]+) m\b", said))
    assert before < 0.7
    assert after > 1.0
    assert said.rstrip().endswith("contacts: 0")


@seeds
def test_the_light_seeker_arrives_at_the_lamp(copies: Path, seed: int) -> None:
    result = run(copies / "06_light_seeker", seed)
    seeker = result.robots[0]
    assert math.dist(seeker.pose[:2], (6.5, 3.0)) < 1.0
    assert seeker.contacts == 0


@seeds
def test_a_program_started_by_hand_drives_a_square(copies: Path, seed: int) -> None:
    folder = copies / "07_square"
    server = subprocess.Popen(
        troupe_command(
            "run", "world.yaml", "--seed", str(seed), "--set", "player.port=0", "--json"
        ),
        cwd=folder, env=environment(), text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    try:
        assert server.stderr is not None
        port = next(m[1] for line in server.stderr if (m := re.search(r"127\.0\.0\.1:(\d+)", line)))
        client = subprocess.run(
            [sys.executable, "square.py"], cwd=folder, env=environment(PLAYER_PORT=port),
            capture_output=True, text=True, timeout=PATIENCE, check=False,
        )  # fmt: skip
        out, err = server.communicate(timeout=PATIENCE)
    finally:
        server.kill()
    assert client.returncode == 0, client.stderr
    assert client.stdout.count("at corner") == 4
    rover = json.loads(out)["robots"][0]
    assert rover["distance"] == pytest.approx(8.0, abs=0.3), err
    assert math.dist(rover["pose"][:2], rover["start"][:2]) < 0.3


@seeds
def test_the_share_that_has_been_visited_is_kept_as_csv(
    copies: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    seed: int,
) -> None:
    said = told(copies / "08_metric", monkeypatch, capsys, seed)
    assert said.startswith("completed")
    with open("visited.csv", newline="") as file:
        rows = [(float(row["time"]), float(row["visited"])) for row in csv.DictReader(file)]
    times, visited = np.array(rows).T
    assert times == pytest.approx(np.arange(1, 61))
    assert (np.diff(visited) >= 0).all()
    assert visited[-1] > 1 / 5
    assert Path("visited.svg").read_text().startswith("<?xml")


def test_the_median_miss_grows_with_the_error_of_the_odometry(copies: Path) -> None:
    folder = copies / "09_dead_reckoning"
    words = ("sweep", "sweep.yaml", "--seeds", "0:2", "--out", "runs", "--jobs", "1")
    done = started.troupe(*words, cwd=folder)
    assert done.returncode == 0, done.stderr
    misses: dict[float, list[float]] = {}
    with (folder / "runs" / "results.csv").open(newline="") as file:
        for row in csv.DictReader(file):
            assert row["outcome"] == "completed"
            error = float(row["models.rover.odometry_noise.turn"])
            misses.setdefault(error, []).append(float(row["miss"]))
    medians = [median(misses[error]) for error in sorted(misses)]
    assert len(medians) == 3
    assert medians == sorted(medians)
    assert medians[-1] > 5 * medians[0]


@seeds
def test_a_swarm_fills_a_map_as_on_the_grid(
    copies: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    seed: int,
) -> None:
    said = told(copies / "10_disperse", monkeypatch, capsys, seed)
    on_the_grid, with_bodies = (ast.literal_eval(way) for way in re.findall(r"\[[\d, ]+\]", said))
    assert on_the_grid == with_bodies
    assert len(with_bodies) == 13
    assert said.count("completed") == 2
    assert said.rstrip().endswith("contacts: 0")
