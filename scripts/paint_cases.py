"""Reproduce the results of the paper on Paint: write docs/results/paint.md and its pictures.

    scripts/paint_cases [--tests N] [--jitter S] [--speeds V V] [--worlds NAME ...]
                        [--out FOLDER]

Runs the paper's three cases, N tests each (5, as in its section 5), at both speeds, as far as the
goals, and with painting all again at the higher speed and one at the lower; then every world.
Takes some ten minutes with its defaults on one core.
`--jitter 1` gives each robot cycles of random length up to 1 s. The counts over many placements are
those that `scripts/paint_placements` left in docs/results/paint. Needs matplotlib.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "scripts")]

import paint_figures as figures  # noqa: E402
from paint_perception import errors  # noqa: E402
from paint_placements import TABLE, Row, read  # noqa: E402

import troupe  # noqa: E402
from sim.result import Result  # noqa: E402
from troupe.sweep.results import result_of  # noqa: E402
from troupe.testing.paint.judge import Judged, judged_run  # noqa: E402

CASES = {1: "I", 2: "II", 3: "III"}
PAPER = {1: "2:33", 2: "2:30", 3: "2:25"}
SPEEDS = (0.115, 0.5)
KINDS = ("case_1", "case_2", "case_3", "line", "tall", "convex", "swarm_8", "swarm_12", "swarm_16")

HEAD = """\
# Paint

Written by `scripts/paint_cases`. The paper: "Simulation of a distributed algorithm for painting a
priori known rectangular region by swarm of mobile robots", in Player/Stage. Here each robot has a
process of its own, a laser of 180 degrees, a blobfinder and odometry in its own start frame, and
is told the region's shape and the number of robots. Times are simulated; a test's time is that of
its slowest robot. Goals, contacts and order are judged from the true poses of every tick. P robots
have the world's axes, N robots axes turned by 180 degrees.

## The program, beside the paper

In `controllers/paint`, `cycle.py` is one computational cycle of section 2: `observe.py` takes in
what laser and blobfinder show, with `sight/` (walls, robots, who is who, where unseen ones may be,
the rank); `compute.py` is section 3.1 from the ranks to the cases A to D, pure functions, and
`task.py` the strip and the goal; `moves/` says where there is room to go and to turn, and `acts/`
what a robot does in each phase; `boustrophedon.py` is the way over a strip. `constants.py` holds
the paper's numbers and those of a body, `memory.py` all that is kept from cycle to cycle, and why.

## What bodies add

The paper's robots are points that see everything at once. Of these robots one in view hides
others, and to the paper's three steps is added what that takes:

- Rank: a robot keeps bounds on how many are above and below it, which never expire because all
  keep the order; a grid of the places where an unseen robot may be says how many more there can
  be. It goes when the bounds meet. Until then it looks around, steps aside along its row to where
  it sees most, and goes up or down as far as every rank it may have leads.
- Robots on one line hide each other for good (`paint_line` has lasers of 27 m, farther than the
  arena's diagonal: nobody can leave the line to look into a far corner). Who stays hidden behind a
  robot at exactly the own height for two minutes is taken to be on that line as well: the one thing
  that is taken for true without being seen. Meanwhile a robot that stands between two others, above
  both or below both, leaves their line.
- A robot that waits steps aside along its row: first to the wall, so as not to stand in others'
  view, later to one end or the other, as it may hide two others from each other; where it has no
  room to turn it slides. After 100 s it also leaves the row of a robot that is nearly level, by
  half a body: it may be what keeps that one from knowing its rank.
- Two bodies nearer than 1.41 m must not turn at the same time. Who has come no nearer to its goal
  for 60 s begins to turn slowly beside one that it sees standing, and turns back if that one begins
  as well.
- A robot paints once no strip that it sees holds two robots, which may still be looking, but waits
  no longer than 900 s for that.
- Who has painted looks for robots that it never saw, to tell that the number is right. In a crowd
  of more than six some may stay hidden; in strips lower than 1.5 m neighbours could not turn beside
  each other, and nobody looks.
- Two heights that differ by less than two millimetres are equal, and x decides. "Order changed"
  counts what goes beyond a centimetre between two robots that start so.

"""


FIGURES = """\
![starts and goals](paint/starts_and_goals.png)

As the paper's figures 5 and 6, at the lower speed: where the robots start (squares; P look to the
right, N to the left), where they stand at the end (dots), and the two legs of the algorithm between
(dotted; side-steps are left out). Metres.

![phases of each robot](paint/timelines.png)

What each robot is about, in the first test of each case at the lower speed, with painting.

"""


BARE = """\
In the convex region a little more than a thousandth stays bare: triangles beside the slanted edges
where two strips meet, around (2.5, 15.9) the largest, then (13.9, 5.4) and (13.9, 15.6). A body
that keeps to its own strip and off the walls cannot bring a square sprayer there.
"""


OVER = """\
Each a run as far as the goals, at 0.5 m/s and for at most 1800 s, by `scripts/paint_placements`; a
row each in [placements.csv](paint/placements.csv). "Seconds" are of those in which all goals are
right. Where a placement has no end, who waits says for whom and gives up after 1700 s. At seed 57
of `paint_swarm_12` three robots that start within 0.3 m of height hide each other, and the rank of
one stays open. The runs of 12 robots from seed 30 on (but for 33 and 71), and those of 16 robots,
are from before robots turned carefully beside each other and kept their patience where they come no
nearer to their goals. Both act only after 60 s without progress; at seeds 33 and 111 of 12 robots
they were what was missing.
"""


@dataclass
class Page:
    """The page as it grows: written after each part, because all of it takes long."""

    path: Path
    text: str = ""

    def add(self, part: str) -> None:
        """One more part."""
        self.text += part
        self.growing.write_text(self.text.rstrip() + "\n", encoding="utf-8")

    def end(self) -> None:
        """It is whole: it takes the place of the page that was there."""
        self.growing.replace(self.path)

    @property
    def growing(self) -> Path:
        """Where it is kept until it is whole."""
        return self.path.with_suffix(".part.md")


def table(heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table in Markdown."""
    lines = [heads, ["---"] * len(heads), *rows]
    return "".join("| " + " | ".join(map(str, line)) + " |\n" for line in lines)


def minutes(seconds: float) -> str:
    """Seconds as the paper writes times: 2:33."""
    whole = round(seconds)
    return f"{whole // 60}:{whole % 60:02d}"


def run(kind: str, seed: int, speed: float, jitter: float, paint: bool) -> Judged:
    """One run of a world that comes with Troupe, judged from the true poses of every tick."""
    settings = [
        f"models.painter.drive.max_speed={speed}",
        f"controllers.paint.args.speed={speed}",
        f"controllers.paint.args.jitter={jitter}",
        f"controllers.paint.args.paint={str(paint).lower()}",
    ]
    return judged_run(ROOT / "worlds" / f"paint_{kind}.yaml", seed, settings)


def last(result: Result, key: str) -> float | None:
    """The latest of a time that all robots report; None if one does not."""
    times = [robot.properties.get(key) for robot in result.robots]
    return max(times) if None not in times else None


def total(result: Result, key: str) -> int:
    """The sum of a count over the robots."""
    return sum(robot.properties.get(key, 0) for robot in result.robots)


def mean(values: Sequence[float]) -> str:
    """A mean and, of more than one value, the standard deviation of one."""
    if not values:
        return "-"
    spread = f" ± {statistics.stdev(values):.0f}" if len(values) > 1 else ""
    return f"{statistics.mean(values):.0f}{spread}"


def cases(tests: int, whole: int, speed: float, jitter: float, folder: Path | None) -> str:
    """The paper's table beside ours at one speed; figures 5 and 6 into the folder, if given."""
    rows, shown, timelines = [], {}, {}
    for case, name in CASES.items():
        judged = [run(f"case_{case}", seed, speed, jitter, paint=False) for seed in range(tests)]
        goal = [result_of(one.result) for one in judged]
        painted = [
            result_of(run(f"case_{case}", seed, speed, jitter, paint=True).result)
            for seed in range(whole)
        ]
        times = [t for result in goal if (t := last(result, "goal_time")) is not None]
        work = [t for result in painted if (t := last(result, "done_time")) is not None]
        rows.append(
            [
                name,
                PAPER[case],
                minutes(statistics.mean(times)) if times else "-",
                mean(times),
                f"{sum(all(one.right) for one in judged)} of {tests}",
                sum(len(one.contacts) for one in judged),
                sum(len(one.swaps) for one in judged),
                mean([sum(robot.distance for robot in r.robots) for r in goal]),
                mean([total(r, "looks") for r in goal]),
                mean([total(r, "waits") for r in goal]),
                f"{mean(work)} ({len(work)} of {whole})",
                f"{min(r.floor.coverage for r in painted):.4f}",
                f"{max(r.floor.passes for r in painted):.2f}",
            ]
        )
        print(speed, *rows[-1], flush=True)
        shown[f"case {name}"], timelines[f"case {name}"] = goal[:5], painted[0]
    heads = ["case", "paper", "here", "seconds", "goals right", "contacts", "order changed"]
    heads += ["metres, all robots", "looks", "waits", "painted after, s"]
    heads += ["coverage, least", "passes, most"]
    text = f"### At {speed:g} m/s\n\n{table(heads, rows)}\n"
    if folder is not None:
        figures.starts_and_goals(shown, folder / "starts_and_goals.png")
        figures.timelines(timelines, folder / "timelines.png")
    return text


def worlds(kinds: Sequence[str], folder: Path) -> str:
    """One run of each world, with painting, and its picture strip."""
    rows, strips = [], ""
    for kind in kinds:
        with tempfile.TemporaryDirectory() as name:
            video = Path(name) / "run.mp4"
            path = ROOT / "worlds" / f"paint_{kind}.yaml"
            result = troupe.run(path, video=video, video_fps=10)
            if result.outcome == "interrupted":
                raise KeyboardInterrupt
            figures.contact_sheet(video, folder / f"{kind}.png")
        goal, done = last(result, "goal_time"), last(result, "done_time")
        rows.append(
            [
                f"`paint_{kind}`",
                len(result.robots),
                result.outcome.replace("_", " "),
                "-" if goal is None else f"{goal:.0f}",
                "-" if done is None else f"{done:.0f}",
                f"{result.floor.coverage:.4f}",
                f"{result.floor.passes:.2f}",
                sum(robot.contacts for robot in result.robots),
            ]
        )
        print(*rows[-1], flush=True)
        strips += f"`paint_{kind}`\n\n![a run of paint_{kind}](paint/{kind}.png)\n\n"
    heads = ["world", "robots", "outcome", "at goals, s", "painted, s", "coverage", "passes"]
    return f"## Whole runs\n\n{table([*heads, 'contacts'], rows)}\n{BARE}\n{strips}"


def placements(path: Path) -> str:
    """The table of `scripts/paint_placements`, summed up; nothing if there is none."""
    groups: dict[tuple[str, float], list[Row]] = {}
    for row in read(path):
        groups.setdefault((row.world, row.jitter), []).append(row)
    if not groups:
        return ""
    rows = []
    for (world, jitter), runs in sorted(groups.items(), key=lambda item: item[1][0].robots):
        times = sorted(row.seconds for row in runs if row.right == row.robots)
        rows.append(
            [
                f"`paint_{world}`",
                runs[0].robots,
                f"{jitter:g}",
                f"{len(times)} of {len(runs)}",
                f"{sum(row.right for row in runs)} of {sum(row.robots for row in runs)}",
                sum(row.contacts for row in runs),
                sum(row.swaps for row in runs),
                f"{statistics.median(times):.0f}" if times else "-",
                f"{times[max(0, round(0.95 * len(times)) - 1)]:.0f}" if times else "-",
                f"{times[-1]:.0f}" if times else "-",
            ]
        )
    heads = ["world", "robots", "cycles up to, s", "all goals right", "robots at their goals"]
    heads += ["contacts", "order changed", "seconds, median", "95 %", "most"]
    return f"## Over many placements\n\n{OVER}\n{table(heads, rows)}\n"


def perception(scenes: int) -> str:
    """How exactly robots are seen."""
    rows = []
    for what, tilted in (("standing along the axes", False), ("turned any way", True)):
        found = errors(scenes, tilted)
        rows.append(
            [
                what,
                len(found.distance),
                f"{100 * found.quantile(0.5):.2f}",
                f"{100 * found.quantile(0.95):.2f}",
                f"{100 * found.quantile(0.5, plain=True):.1f}",
                f"{100 * found.quantile(0.95, plain=True):.1f}",
                found.outside,
            ]
        )
    heads = ["robots", "seen", "median, cm", "95 %, cm", "plain mean: median", "95 %"]
    return f"""## How exactly robots are seen

{scenes} random scenes of four robots, one look of 180 degrees from one of them in any direction:
the distance of the centre that a robot is given from where it is, and for comparison that of the
mean of the laser's points on it. A robot of which only a corner is in view is given bounds that
hold its centre; the last column counts the robots outside of their bounds by more than 0.1 m.

{table([*heads, "out of bounds"], rows)}
"""


def main() -> None:
    """Run everything and write the page."""
    options = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    options.add_argument("--tests", type=int, default=5, help="placements per case")
    options.add_argument("--jitter", type=float, default=0.0, help="longest cycle, s")
    options.add_argument("--speeds", type=float, nargs="+", default=SPEEDS, help="m/s")
    options.add_argument("--scenes", type=int, default=1000, help="scenes for perception")
    options.add_argument(
        "--worlds", nargs="*", default=KINDS, choices=KINDS, help="those run whole, with painting"
    )
    options.add_argument("--out", type=Path, default=ROOT / "docs" / "results")
    given = options.parse_args()
    if given.tests < 1 or given.scenes < 1 or min(given.speeds) <= 0.0 or given.jitter < 0.0:
        options.error("--tests, --scenes and --speeds have to be above 0, --jitter 0 or more")
    folder = given.out / "paint"
    folder.mkdir(parents=True, exist_ok=True)
    page = Page(given.out / "paint.md")
    intro = f"## The three cases\n\n{given.tests} tests each"
    intro += f", cycles of random lengths up to {given.jitter:g} s" if given.jitter else ""
    page.add(HEAD + intro + ". The paper's times fit robots of 0.11 to 0.12 m/s.\n\n")
    for k, speed in enumerate(given.speeds):
        whole = given.tests if speed == max(given.speeds) else 1  # painting slowly takes long
        page.add(cases(given.tests, whole, speed, given.jitter, folder if k == 0 else None))
    page.add(FIGURES)
    page.add(perception(given.scenes))
    if given.worlds:
        page.add(worlds(given.worlds, folder))
    page.add(placements(given.out / "paint" / TABLE.name))
    page.end()
    print(page.path)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        print("interrupted; the parts so far are in paint.part.md", file=sys.stderr)
        sys.exit(130)
