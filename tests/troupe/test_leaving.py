"""The end of the command's process: all that an exit does is done, but nothing is taken apart."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.patience import PATIENCE
from tests.processes import environment

PROGRAM = """
import atexit, os, sys, threading
{before}
class Kept:
    def __del__(self, write=os.write):
        write(2, b"taken apart")
kept = Kept()
kept.itself = kept
atexit.register(lambda: print("exit function"))
ready = threading.Event()
threading.Thread(target=lambda: (ready.wait(), print("thread"))).start()
sys.argv = [{name!r}, "--version"]
sys.path.insert(0, {root!r})
from troupe.__main__ import main
import troupe.leaving
was = troupe.leaving.end_process
troupe.leaving.end_process = lambda code: (ready.set(), was(code))
try:
    main()
finally:
    ready.set()
"""


def run(folder: Path, name: str = "troupe", before: str = "") -> subprocess.CompletedProcess[str]:
    root = str(Path(__file__).parent.parent.parent)
    program = folder / "program.py"
    program.write_text(PROGRAM.format(before=before, name=name, root=root))
    return subprocess.run(
        [sys.executable, str(program)], env=environment(),
        capture_output=True, text=True, check=False, timeout=PATIENCE,
    )  # fmt: skip


def test_threads_and_exit_functions_have_their_turn_and_nothing_is_taken_apart(
    tmp_path: Path,
) -> None:
    done = run(tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.splitlines()[1:] == ["thread", "exit function"]


@pytest.mark.parametrize(
    ("name", "before"),
    [("mine.py", ""), ("troupe", "sys.setprofile(lambda *words: None)")],
    ids=["another program", "a profiler"],
)
def test_whoever_waits_for_the_command_gets_its_turn(
    tmp_path: Path, name: str, before: str
) -> None:
    done = run(tmp_path, name, before)
    assert "taken apart" in done.stderr


def test_a_profiler_around_the_command_tells_what_it_found() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "cProfile", "-m", "troupe", "--version"], env=environment(),
        capture_output=True, text=True, check=False, timeout=PATIENCE,
    )  # fmt: skip
    assert "function calls" in done.stdout
