"""A report tells what came out of a sweep, in one file, and nothing that is not so."""

from __future__ import annotations

import re
import shlex
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.troupe.sweep.sweeping import plan_of, quiet_world, troupe
from troupe.report.groups import Measure, factors, grouped, measures_of, pairings, short
from troupe.report.sweep import contents, write_html, write_markdown
from troupe.sweep.collect import gather
from troupe.sweep.session import How, sweep
from troupe.sweep.statistics import middle
from troupe.usage import UsageError


def row(seed: int, level: object, time: float | None, hash_: str = "a") -> dict[str, object]:
    found = {"world": "w", "seed": seed, "a.level": level, "hash": f"{hash_}{level}"}
    if time is None:
        return {**found, "outcome": "timeout", "reason": "slow"}
    return {**found, "outcome": "completed", "reason": None, "sim_time": time}


ROWS = [row(seed, level, 10.0 * level + seed) for level in (1, 2) for seed in range(5)]
ROWS += [row(9, 1, None), row(9, 2, 100.0)]
TIME = Measure("sim_time", higher=False)


@given(st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=50))
def test_an_interval_holds_its_median_and_is_always_the_same(values: list[float]) -> None:
    found = middle(np.array(values), "x")
    assert found == middle(np.array(values[::-1]), "x")
    assert min(values) <= found.low <= found.median <= found.high <= max(values)
    assert found.median == np.median(values)


def test_the_interval_covers_the_true_median_about_as_often_as_it_says() -> None:
    random = np.random.default_rng(1)
    hits = 0
    for trial in range(300):
        found = middle(random.normal(size=40), str(trial))
        hits += found.low <= 0.0 <= found.high
    # 95 % of 300 are 285, the binomial's deviation is 3.8; the percentile bootstrap of a median
    # of 40 values covers 93 to 96 %, so five deviations below 93 % are 257
    assert hits >= 257


def test_a_version_that_gives_up_on_what_is_hard_does_not_look_better() -> None:
    easy, hard = [(seed, 10.0 + seed) for seed in range(4)], [(seed, 50.0) for seed in range(4, 10)]
    rows = [row(seed, 1, time + 1.0) for seed, time in (*easy, *hard)]
    rows += [row(seed, 2, time) for seed, time in easy] + [row(seed, 2, None) for seed, _ in hard]
    rows += [row(10, 1, None), row(10, 2, 99.0)]
    found = factors(rows)
    patient, hasty = grouped(rows, found)
    assert np.median(patient.values(TIME)[0]) > np.median(hasty.values(TIME)[0])
    assert patient.median_of_all(TIME) == 51.0
    assert hasty.median_of_all(TIME) == np.inf
    assert hasty.median_of_all(Measure("sim_time", higher=True)) == -np.inf
    (pair,) = pairings([patient, hasty], TIME, found)
    assert (len(pair.before), pair.only_before, pair.only_after) == (4, 6, 1)


def test_groups_have_what_completed_and_what_failed() -> None:
    groups = grouped(ROWS, factors(ROWS))
    assert [(g.label, len(g.rows), g.failed) for g in groups] == [
        ("level 1", 6, 1),
        ("level 2", 6, 0),
    ]
    values, rows = groups[1].values(TIME)
    assert rows[TIME.worst(values)]["seed"] == 9


def test_pairs_are_of_one_seed_and_both_completed() -> None:
    found = factors(ROWS)
    (pair,) = pairings(grouped(ROWS, found), TIME, found)
    assert (pair.base, pair.other, pair.difference.number) == (1, 2, 5)
    assert pair.difference.median == 10.0
    assert (pair.lower, pair.higher) == (0, 5)


def test_a_world_that_was_changed_is_another_version() -> None:
    rows = [*ROWS, *(row(seed, 1, 5.0, "b") for seed in range(5))]
    assert factors(rows)["version"] == ["a1", "a2", "b1"]


def test_names_are_as_short_as_they_can_be() -> None:
    names = ["models.a.drive.max_speed", "models.b.drive.max_speed", "clock.interval"]
    assert [short(name, names) for name in names] == [
        "a.drive.max_speed", "b.drive.max_speed", "interval",
    ]  # fmt: skip


def test_a_measure_that_is_no_column_is_a_mistake() -> None:
    with pytest.raises(UsageError, match="there are"):
        measures_of(ROWS, ["sim_tim"], [], [])
    assert measures_of(ROWS, [], [], []) == [TIME]


class Page(HTMLParser):
    """The tags that are open, all attributes, and the text of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.text = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.links += [value or "" for name, value in attrs if name in ("src", "href")]

    def handle_data(self, data: str) -> None:
        self.text += data


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    place = tmp_path_factory.mktemp("sweep")
    own = place / "own.py"
    own.write_text("def spread(result):\n    return max(r.pose[0] for r in result.robots)\n")
    plan = plan_of(
        quiet_world(place), "0:6", "models.rover.body.radius=0.1,0.3", "clock.interval=0.1,0.05",
        each=(f"{own}:spread",),
    )  # fmt: skip
    sweep(plan, place / "out", How(jobs=2, quiet=True))
    return place / "out"


def test_a_report_is_one_file_that_needs_nothing_else(folder: Path, tmp_path: Path) -> None:
    write_html(contents(gather([folder]), title="<b>mine</b>"), tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text()
    page = Page()
    page.feed(text)
    assert all(link.startswith(("data:image/png;base64,", "#")) for link in page.links)
    assert "<b>mine" not in text
    assert "&lt;b&gt;mine" in text
    assert text.count("<svg") == 4  # against two parameters, and pairs of two levels of each
    assert len(set(re.findall(r' id="([^"]+)"', text))) == len(re.findall(r' id="([^"]+)"', text))
    assert "spread" in page.text


def test_a_report_says_of_each_run_to_look_at_what_repeats_it(folder: Path) -> None:
    found = contents(gather([folder]), title="x")
    rows = gather([folder]).results
    assert [look["title"] for look in found["looks"]] == ["best", "median", "worst"]
    assert all(look["picture"].startswith(b"\x89PNG") for look in found["looks"])
    worst = found["looks"][2]
    words = shlex.split(worst["command"])
    assert words[:2] == ["troupe", "run"]
    assert words[words.index("--seed") + 1] == str(worst["seed"])
    assert max(row["spread"] for row in rows) == pytest.approx(float(worst["value"]), rel=1e-5)


def test_a_world_that_was_changed_has_no_pictures(folder: Path) -> None:
    world = folder.parent / "quiet.yaml"
    before = world.read_text()
    try:
        world.write_text(before + "obstacles: [{shape: circle, radius: 0.3, pose: [1, 1, 0]}]\n")
        found = contents(gather([folder]), title="x")
    finally:
        world.write_text(before)
    assert all("changed since" in look["why_not"] for look in found["looks"])


def test_markdown_has_its_plots_beside_it(folder: Path, tmp_path: Path) -> None:
    content = contents(gather([folder]), title="x", pictures=False)
    write_markdown(content, tmp_path / "page.md")
    text = (tmp_path / "page.md").read_text()
    files = re.findall(r"\]\(([^)]+)\)", text)
    assert len(files) == 4
    assert all((tmp_path / name).read_text().startswith("<svg") for name in files)


def test_a_report_of_the_same_folder_is_the_same(folder: Path, tmp_path: Path) -> None:
    for name in ("one.html", "two.html"):
        write_html(contents(gather([folder]), title="x"), tmp_path / name)
    assert (tmp_path / "one.html").read_bytes() == (tmp_path / "two.html").read_bytes()


def test_the_command_makes_a_report(folder: Path, tmp_path: Path) -> None:
    done = troupe("report", folder, "-o", tmp_path / "page.html", "--no-pictures")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "page.html").stat().st_size > 10_000
    for words, said in (
        (("--measure", "nonsense"), "--measure nonsense: is no column of numbers"),
        (("--higher", "nonsense"), "--higher nonsense: is no column of numbers"),
        (("--format", "pdf"), "html or md"),
    ):
        done = troupe("report", folder, "-o", tmp_path / "page.html", *words)
        assert done.returncode == 2
        assert said in done.stderr
    world = tmp_path / "world.yaml"
    world.write_text("mine")
    done = troupe("report", folder, "-o", world)
    assert (done.returncode, world.read_text()) == (2, "mine")
    assert "name it *.html or *.md" in done.stderr
