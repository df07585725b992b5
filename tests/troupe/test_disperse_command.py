"""`troupe disperse`, as one uses it."""

import json
import subprocess
import sys

import pytest
import typer
from typer.testing import CliRunner

from troupe.commands.disperse import disperse

app = typer.Typer()
app.command("disperse")(disperse)


@app.callback()
def main():
    """So that the command keeps its name."""


def run(*arguments):
    return CliRunner().invoke(app, ["disperse", *map(str, arguments)])


def test_json_reports_the_run():
    result = run("--grid", "30x30", "--door", "13,16", "--json")
    assert result.exit_code == 0
    report = json.loads(result.stdout)
    assert report["total_travel"] == report["sum_of_distances"] == 13620
    assert report["max_travel"] == report["max_distance"] == 32
    assert report["cells"] == report["settled"] == 900
    assert (report["makespan"], report["steps"], report["collisions"]) == (1799, 1800, 0)
    assert report["covered"] is True
    assert report["rule"] == "fcdfs"


def test_the_summary_for_people_has_the_same_figures():
    result = run("--grid", "30x30", "--door", "13,16")
    for figure in ("completed", "900", "1799", "13620", "32"):
        assert figure in result.stdout


def test_columns_come_before_rows():
    wide = json.loads(run("--grid", "9x2", "--door", "8,1", "--json").stdout)
    assert wide["max_distance"] == 9
    assert run("--grid", "9x2", "--door", "1,8").exit_code == 2


@pytest.fixture
def map_file(tmp_path):
    def write(text):
        path = tmp_path / "map.txt"
        path.write_text(text)
        return path

    return write


def test_a_map_brings_its_doors_and_an_option_replaces_them(map_file):
    path = map_file("#####\n#S..#\n#####\n")
    assert json.loads(run(path, "--json").stdout)["max_distance"] == 2
    other = json.loads(run(path, "--door", "2,1", "--json").stdout)
    assert (other["max_distance"], other["doors"]) == (1, [[2, 1]])


def test_the_best_door_is_found():
    report = json.loads(run("--grid", "5x7", "--door", "best", "--json").stdout)
    assert report["doors"] == [[2, 3]]


@pytest.mark.parametrize(
    ("text", "where", "what"),
    [
        ("", ":1:1: ", "empty"),
        ("S..\n..\n", ":2:3: ", "ragged"),
        ("S.?\n", ":1:3: ", "'?' is not allowed"),
        ("S.#.\n", ":1:4: ", "not connected"),
        ("S..\n.#.\n...\n", ":2:2: ", "not simply connected"),
        ("...\n", ": ", "no door"),
    ],
)
def test_a_bad_map_is_told_by_file_line_and_column(map_file, text, where, what):
    path = map_file(text)
    result = run(path)
    assert result.exit_code == 2
    assert result.stderr.startswith(f"{path}{where}")
    assert what in result.stderr
    assert not result.stdout


def test_a_door_in_a_wall_is_told_by_file_line_and_column(map_file):
    path = map_file("S.\n.#\n")
    result = run(path, "--door", "1,1")
    assert result.exit_code == 2
    assert result.stderr.startswith(f"{path}:2:2: door 1,1 is in a wall")


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["nowhere.txt"],
        ["nowhere.txt", "--grid", "3x3"],
        ["--grid", "3x3"],
        ["--grid", "3", "--door", "1,1"],
        ["--grid", "0x3", "--door", "1,1"],
        ["--grid", "3x3", "--door", "1;1"],
        ["--grid", "3x3", "--door", "1,1", "--rule", "fcdf"],
        ["--grid", "3x3", "--door", "1,1", "--conflict", "fight"],
        ["--grid", "3x3", "--door", "1,1", "--q", "1"],
        ["--grid", "3x3", "--door", "1,1", "--seed", "-1"],
        ["--grid", "3x3", "--door", "1,1", "--at", "3"],
        ["--grid", "99999x99999", "--door", "1,1"],
        ["--grid", "3x3", "--door", "1,1", "--picture", "no/such/folder/p.png"],
        ["--grid", "3x3", "--door", "1,1", "--video", "no/such/folder/v.mp4"],
    ],
)
def test_bad_usage_ends_with_2_and_a_message(arguments):
    result = run(*arguments)
    assert result.exit_code == 2
    assert result.stderr.strip()
    assert "Traceback" not in result.stderr
    assert not result.stdout


def test_a_mistyped_rule_gets_a_suggestion():
    result = run("--grid", "3x3", "--door", "1,1", "--rule", "fcdf")
    assert "fcdfs" in result.stderr


def test_force_runs_a_ring_and_ending_short_is_1(map_file):
    path = map_file("S...\n.##.\n.##.\n....\n")
    stopped = run(path, "--force", "--json")
    assert stopped.exit_code == 1
    assert json.loads(stopped.stdout)["collisions"] == 1
    stayed = run(path, "--force", "--json", "--conflict", "stay")
    assert stayed.exit_code == 1
    report = json.loads(stayed.stdout)
    assert (report["outcome"], report["collisions"], report["covered"]) == ("circling", 0, False)


def test_a_run_cut_short_ends_with_1():
    result = run("--grid", "9x9", "--door", "4,4", "--max-steps", "20", "--json")
    assert result.exit_code == 1
    assert json.loads(result.stdout)["steps"] == 20


def test_missed_steps_depend_on_the_seed_alone():
    def report(seed):
        options = ["--rule", "light", "--q", "0.3", "--seed", seed, "--json"]
        return json.loads(run("--grid", "9x9", "--door", "4,4", *options).stdout)

    assert report(1) == report(1)
    assert report(1)["makespan"] != report(2)["makespan"]


def test_other_commands_need_not_wait_for_the_compiler():
    code = (
        "import sys, troupe.commands.disperse\n"
        "sys.exit('numba' in sys.modules or 'cv2' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
