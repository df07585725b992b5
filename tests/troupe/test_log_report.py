"""The report of a run: one page with what its log holds, true to the numbers, safe to open."""

from __future__ import annotations

import re
import sys
import xml.etree.ElementTree as ET
from html.parser import HTMLParser
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from typer.testing import CliRunner

import troupe
from troupe.app import app
from troupe.report.charts import nice
from troupe.report.log import report_of
from troupe.report.measures import measure, nearest_pair
from troupe.sweep.folder import write_aside
from troupe.usage import UsageError

WORLD = """\
name: "A <b>bold</b> \\x1b[31mworld"
size: [10, 8]
duration: 12
floor: {resolution: 0.2}
models:
  rover:
    body: {shape: circle, radius: 0.4}
    drive: {kind: differential}
    sensors: [{type: laser, samples: 9}]
    actuators: [{type: sprayer}]
robots:
  - {name: painter, model: rover, pose: [2, 2, 0], controller: paint}
  - {name: rammer, model: rover, pose: [7, 6, 0], controller: ram}
"""
PAINT = """\
from player import DioProxy, PlayerClient, Position2dProxy, SimulationProxy, SpeechProxy

with PlayerClient() as robot:
    base, spray = Position2dProxy(robot), DioProxy(robot)
    SpeechProxy(robot).say("\\x1b[31mred <script>alert(1)</script>")
    SimulationProxy(robot).report("rank", 1)
    SimulationProxy(robot).report("strip", [0.5, 1.5])
    spray.set_output(1)
    base.set_speed(0.5)
    for _ in range(60):
        robot.read()
"""
RAM = """\
from player import PlayerClient, Position2dProxy

with PlayerClient() as robot:
    base = Position2dProxy(robot)
    base.set_speed(1.0)
    for _ in range(80):
        robot.read()
    print("I have had \\x1b[31menough")
    raise ValueError("a wall")
"""
CONTROLLERS = "controllers: {paint: {program: ./paint.py}, ram: {program: ./ram.py}}\n"


class Kept(NamedTuple):
    log: troupe.Log
    result: object
    page: str


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Kept:
    folder = tmp_path_factory.mktemp("report")
    (folder / "world.yaml").write_text(WORLD + CONTROLLERS)
    (folder / "paint.py").write_text(PAINT)
    (folder / "ram.py").write_text(RAM)
    path = folder / "run.mcap"
    result = troupe.run(folder / "world.yaml", seed=4, log=path, set={"duration": 11})
    log = troupe.Log(path)
    return Kept(log, result, report_of(log))


class Reader(HTMLParser):
    """What a browser would find in a page: the tags that are open, and what is loaded."""

    ALONE = frozenset({"meta", "br", "img"})

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.loaded: list[str] = []
        self.scripts = 0
        self.text = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in self.ALONE:
            self.open.append(tag)
        self.scripts += tag == "script" or any(name.startswith("on") for name, _ in attrs)
        self.loaded += [value or "" for name, value in attrs if name in ("src", "href")]

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        pass

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data


def read(page: str) -> Reader:
    reader = Reader()
    reader.feed(page)
    assert reader.open == []
    return reader


def test_the_page_is_whole_and_loads_nothing(kept: Kept) -> None:
    reader = read(kept.page)
    assert [what for what in reader.loaded if not what.startswith("data:")] == []
    assert set(re.findall(r"https?://[^\"' ]+", kept.page)) <= {"http://www.w3.org/2000/svg"}
    assert len(kept.page) < 300_000


def test_what_robots_say_runs_nothing_and_reaches_no_terminal(kept: Kept) -> None:
    assert read(kept.page).scripts == 0
    assert "\x1b" not in kept.page
    assert "<b>bold" not in kept.page
    assert "alert(1)" in read(kept.page).text


def test_it_tells_what_ran_and_what_repeats_it(kept: Kept) -> None:
    text = read(kept.page).text
    assert kept.result.digest in text
    assert "a controller failed" in text
    command = next(line for line in text.splitlines() if line.startswith("Again:troupe run"))
    assert command.endswith("--seed 4 --duration 11 --set duration=11")


def test_distances_approach_and_coverage_are_those_of_the_run(kept: Kept) -> None:
    log, text = kept.log, read(kept.page).text
    gaps = np.hypot(*(log.poses[:, 0, :2] - log.poses[:, 1, :2]).T)
    assert f"{gaps.min():.3f} m at {log.times[gaps.argmin()]:.1f} s" in text
    for robot in kept.result.robots:
        assert f"{robot.distance:.2f}" in text
    assert f"{100 * kept.result.floor.coverage:.2f} % at the end" in text


def test_it_tells_contacts_reports_and_last_words(kept: Kept) -> None:
    text = read(kept.page).text
    touch = kept.log.touches[0]
    assert f"{touch.time:.1f}" in text
    assert f"{touch.point[0]:.2f}" in text
    assert "ValueError: a wall" in text
    assert "I have had \\x1b[31menough" in text
    assert "[0.5, 1.5]" in text
    assert "failed" in text


def test_its_pictures_are_svg_that_can_be_taken_out(kept: Kept) -> None:
    found = re.findall(r"<svg .*?</svg>", kept.page, re.DOTALL)
    assert len(found) >= 6
    for svg in found:
        ET.fromstring(svg)
    names = re.findall(r'id="([^"]+)"', kept.page)
    assert len(names) == len(set(names))


def test_it_needs_no_package_that_is_an_extra(kept: Kept, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("matplotlib", "jinja2", "pandas", "pyarrow"):
        monkeypatch.setitem(sys.modules, name, None)
    assert report_of(kept.log) == kept.page


def test_speeds_and_stalls_are_measured(kept: Kept) -> None:
    found = measure(kept.log)
    poses = kept.log.poses[:, :, :2]
    moved = np.hypot(*np.moveaxis(np.diff(poses, axis=0), 2, 0)).sum(axis=0)
    assert found.distances[-1] == pytest.approx(moved)
    assert found.stalled == pytest.approx(kept.log.stalls.sum(axis=0) * kept.log.interval)
    assert found.top_speeds.max() == pytest.approx(
        np.abs(kept.log.velocities[:, :, 0]).max(), rel=0.1
    )
    assert all(len(way) == len(kept.log) for way in found.ways)


def test_the_nearest_pair_is_found_among_those_who_are_there() -> None:
    places = np.array([[0, 0], [np.nan, np.nan], [5, 0], [5, 1]])
    assert nearest_pair(places) == (1.0, (2, 3))
    assert nearest_pair(places[:2]) is None


def test_axes_have_round_numbers() -> None:
    assert nice(0.0, 170.4, 8) == [0, 50, 100, 150]
    assert nice(0.0, 4.0, 8, whole=True) == [0, 1, 2, 3, 4]
    assert nice(0.0, 0.31, 5) == pytest.approx([0, 0.1, 0.2, 0.3])


def test_the_command_makes_the_page(kept: Kept, tmp_path: Path) -> None:
    out = tmp_path / "page.html"
    done = CliRunner().invoke(app, ["report", str(kept.log.path), "-o", str(out)])
    assert done.exit_code == 0, done.output
    assert out.read_text() == kept.page


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["-o", "page.pdf"], "name it *.html"),
        (["-o", "nowhere/page.html"], "no folder"),
        (["-o", "page.html", "--measure", "x"], "no sweep"),
        (["-o", "page.md", "--format", "md"], "no sweep"),
    ],
)
def test_what_no_report_can_be_made_of_is_refused(
    kept: Kept, words: list[str], message: str
) -> None:
    done = CliRunner().invoke(app, ["report", str(kept.log.path), *words])
    assert done.exit_code == 2
    assert message in done.stderr


@pytest.mark.parametrize("name", ["folder.html", "no\0name.html", "here.html"])
def test_where_no_report_can_be_written_is_said_before_the_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("folder.html").mkdir()
    Path("here.html").symlink_to("here.html")
    ticks: list[float] = []
    with pytest.raises(UsageError, match=r"^(folder|no\0name|here)\.html: "):
        troupe.run("wander", duration=0.1, report=name, each_tick=lambda sim: ticks.append(1))
    assert not ticks


def test_a_page_that_cannot_be_written_is_named_as_it_was_asked_for(tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    page.mkdir()
    with pytest.raises(OSError, match=r"page\.html'$") as told:
        write_aside(page, b"")
    assert told.value.filename == str(page)
    assert list(tmp_path.iterdir()) == [page]


def test_a_file_that_is_no_log_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    path.write_bytes(b"nothing")
    done = CliRunner().invoke(app, ["report", str(path), "-o", str(tmp_path / "page.html")])
    assert done.exit_code == 2
    assert "is not an MCAP file" in done.stderr


def test_a_run_leaves_its_report_and_no_log(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    plain = troupe.run("wander", duration=1)
    result = troupe.run("wander", duration=1, report="page.html")
    assert result.digest == plain.digest
    assert [path.name for path in tmp_path.iterdir()] == ["page.html"]
    assert result.digest in (tmp_path / "page.html").read_text()
    with pytest.raises(UsageError, match="html"):
        troupe.run("wander", duration=1, report="page.txt")


def test_a_run_without_robots_has_a_report(tmp_path: Path) -> None:
    world = {"size": [4, 3], "duration": 1}
    troupe.run(world, report=tmp_path / "page.html")
    assert "completed" in read((tmp_path / "page.html").read_text()).text
