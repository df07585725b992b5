"""The scripts of the papers' results keep what sweeps leave, and run nothing twice."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from tests.patience import PATIENCE
from tests.processes import ROOT, environment

TABLE = ROOT / "docs" / "results" / "paint" / "placements.csv"


def script(name: str, *words: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, str(ROOT / "scripts" / name), *map(str, words)],
        env=environment(), capture_output=True, text=True, timeout=PATIENCE, check=True,
    )  # fmt: skip


def test_a_placement_that_a_sweep_has_run_is_a_row_and_is_not_run_again(tmp_path: Path) -> None:
    out = tmp_path / "placements.csv"
    known = "tall,0,2,3,3,0,0,25.0,completed\n"
    out.write_text("world,jitter,seed,robots,right,contacts,swaps,seconds,outcome\n" + known)
    words = ("--worlds", "tall", "--seeds", "2", "3", "--jitter", "0", "--limit", "1")
    more = ("--jobs", "1", "--folder", tmp_path / "runs", "--out", out)
    done = script("paint_placements.py", *words, *more)
    assert done.stdout.startswith("1 runs, 1 are in ")
    lines = out.read_text().splitlines(keepends=True)
    assert lines[1:] == [known, "tall,0,3,3,0,0,0,1.0,time_limit\n"]
    assert script("paint_placements.py", *words, *more).stdout.startswith("0 runs, 2 are in ")


def test_the_table_of_placements_is_the_same_after_it_was_read_and_written(tmp_path: Path) -> None:
    words = ("--worlds", "case_1", "--seeds", "1000", "1000", "--jitter", "0")
    copy = tmp_path / "copy.csv"
    copy.write_bytes(TABLE.read_bytes())
    code = (
        f"import sys; sys.path[:0] = [{str(ROOT / 'scripts')!r}]\n"
        "import paint_placements as p; from pathlib import Path\n"
        f"p.write(Path({str(copy)!r}), p.read(p.TABLE)[::-1])"
    )
    subprocess.run([sys.executable, "-c", code], env=environment(), check=True)
    assert copy.read_bytes() == TABLE.read_bytes()
    assert script("paint_placements.py", *words).stdout.startswith("0 runs, 1 are in ")


def test_rows_are_those_of_what_was_asked_for_last(tmp_path: Path) -> None:
    code = f"""\
import sys; sys.path[:0] = [{str(ROOT / "scripts")!r}]
from pathlib import Path; from sweeps import rows, sweep
study, out = Path({str(tmp_path / "study.py")!r}), Path({str(tmp_path / "out")!r})
for seeds, number in (("0:3", 1), ("0:2", 2)):
    study.write_text(f"def f(seed):\\n    return {{{{'x': {{number}}}}}}\\n")
    sweep(out, f"{{study}}:f", "--seeds", seeds, "--quiet", "--jobs", "1")
    print([row["x"] for row in rows(out)])
"""
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=environment(), capture_output=True, text=True, timeout=PATIENCE, check=True,
    )  # fmt: skip
    assert [line for line in done.stdout.splitlines() if line[0] == "["] == ["[1, 1, 1]", "[2, 2]"]


def test_the_page_on_paint_sweeps_each_folder_once(tmp_path: Path) -> None:
    """What is read of a folder is what was asked for last."""
    code = f"""\
import sys; sys.path[:0] = [{str(ROOT / "scripts")!r}]
import paint_cases as p
for name in ("keep_cases", "keep_worlds", "keep_noise", "keep_perception", "write"):
    setattr(p, name, lambda *_, **__: None)
p.sweep = lambda folder, *words: print("swept:", folder.name)
sys.argv[1:] = ["--out", {str(tmp_path)!r}, "--folder", {str(tmp_path)!r}]
p.main()
"""
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=environment(), capture_output=True, text=True, timeout=PATIENCE, check=True,
    )  # fmt: skip
    swept = [line for line in done.stdout.splitlines() if line.startswith("swept:")]
    assert swept == ["swept: cases", "swept: worlds", "swept: noise"]
