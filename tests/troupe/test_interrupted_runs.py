"""A signal at whatever moment of a run: in order from the first tick on, at once before it."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import uuid
from pathlib import Path

import av
import pytest

from tests import started
from tests.processes import ROOT, all_gone, environment

STRUCK = ROOT / "tests" / "troupe" / "struck.py"
TICKS = 10  # of the world that is run


def struck(
    place: str,
    folder: Path,
    *more: str,
    times: int = 1,
    number: int = signal.SIGINT,
    fresh: bool = False,
) -> subprocess.CompletedProcess[str]:
    """A run of `wander` with a video that gets signals at a place; `fresh`: nothing is loaded."""
    mark = uuid.uuid4().hex
    words = ["run", "wander", "--duration", "1", "--json", "--video", str(folder / "run.mp4")]
    variables = {"SIGNAL": str(int(number)), "TROUPE_TEST_MARK": mark}
    if fresh:
        done = subprocess.run(
            [sys.executable, str(STRUCK), place, str(times), *words, *more],
            env=environment(**variables), cwd=folder, capture_output=True, text=True, check=False,
            timeout=600,
        )  # fmt: skip
    else:
        done = started.troupe(
            place, str(times), *words, *more, cwd=folder, program=STRUCK, **variables
        )
    assert all_gone(mark)
    return done


def frames(video: Path) -> int:
    """How many frames of a video can be decoded."""
    with av.open(str(video)) as container:
        return sum(1 for _ in container.decode(video=0))


@pytest.mark.parametrize(
    "place",
    [
        "import:typer",
        "import:sim.engine",
        "import:numba",
        "sim.fleet.fleet:Fleet.__init__:after",
        "troupe.warm:warm_once",
        "troupe.world:load",
        "sim.build:LoadedWorld",
    ],
)
def test_before_there_is_anything_to_lose_the_command_ends_at_once(
    place: str, tmp_path: Path
) -> None:
    done = struck(place, tmp_path, fresh=place.startswith("import:"))
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "interrupted\n")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("place", "ticks"),
    [
        ("sim.filming:open_recorder:after", 0),
        ("sim.engine:Engine.__post_init__", 0),
        ("sim.engine:Engine.enter_first", 0),
        ("sim.stage.stage:Stage.tick", 1),
        ("sim.engine:Engine.record", 1),
        ("sim.video.recorder:Recorder.frame", 1),
        ("sim.fleet.crew:Crew.dismiss", TICKS),
        ("sim.fleet.fleet:Fleet.close", TICKS),
        ("sim.filming:Film.finish", TICKS),
        ("sim.video.encode:H264Encoder.close", TICKS),
        ("sim.video.encode:put_index_in_front", TICKS),
        ("sim.video.encode:put_index_in_front:after", TICKS),
        ("sim.result:Result.as_json", TICKS),
        ("sim.strictjson:dumps", TICKS),
        ("sim.strictjson:dumps:after", TICKS),
    ],
)
def test_from_the_first_tick_to_the_last_byte_a_run_ends_in_order(
    place: str, ticks: int, tmp_path: Path
) -> None:
    done = struck(place, tmp_path)
    assert done.returncode == 130
    assert done.stderr == ""
    result = json.loads(done.stdout)
    assert result["ticks"] == ticks
    # a run that was over already has lost nothing, so its result says what it is
    assert result["outcome"] == ("interrupted" if ticks < TICKS else "completed")
    assert [path.name for path in tmp_path.iterdir()] == (["run.mp4"] if ticks else [])
    assert not ticks or frames(tmp_path / "run.mp4") > 0


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_polite_kill_and_a_closed_terminal_are_the_same(number: int, tmp_path: Path) -> None:
    done = struck("sim.video.encode:H264Encoder.close", tmp_path, number=number)
    assert done.returncode == 130
    assert json.loads(done.stdout)["ticks"] == TICKS
    assert struck("troupe.world:load", tmp_path, number=number).returncode == 130


def test_the_plain_summary_is_printed_to_its_end(tmp_path: Path) -> None:
    words = ["run", "wander", "--duration", "1"]
    place = "troupe.summary:summary:after"
    done = started.troupe(place, "1", *words, cwd=tmp_path, program=STRUCK)
    assert done.returncode == 130
    assert "rover4" in done.stdout


@pytest.mark.parametrize(
    "place",
    [
        "sim.filming:open_recorder:after",
        "sim.engine:Engine.tick",
        "sim.engine:Engine.tick:after",
        "sim.fleet.crew:Crew.dismiss",
        "sim.video.encode:put_index_in_front",
        "sim.video.encode:put_index_in_front:after",
        "sim.result:Result.as_json",
    ],
)
def test_a_second_signal_ends_at_once_and_leaves_no_half_video(place: str, tmp_path: Path) -> None:
    done = struck(place, tmp_path, "--video-speed", "0.1", times=2)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "interrupted\n")
    for left in tmp_path.iterdir():
        assert left.name == "run.mp4"
        assert frames(left) > 0


def test_a_signal_that_was_ignored_stays_so(tmp_path: Path) -> None:
    """As SIGHUP is under nohup."""
    words = [sys.executable, str(STRUCK), "sim.engine:Engine.record", "2", "run", "wander"]
    command = "trap '' HUP; exec \"$@\""
    done = subprocess.run(
        ["sh", "-c", command, "sh", *words, "--duration", "1"],
        env=environment(SIGNAL=str(int(signal.SIGHUP))),
        cwd=tmp_path, capture_output=True, text=True, check=False, timeout=600,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr


def test_a_program_that_uses_troupe_gets_its_result_and_its_handlers_back(tmp_path: Path) -> None:
    program = (
        "import os, signal, troupe\n"
        "from sim.video.encode import H264Encoder\n"
        "close = H264Encoder.close\n"
        "def struck(self):\n"
        "    os.kill(os.getpid(), signal.SIGINT)\n"
        "    close(self)\n"
        "H264Encoder.close = struck\n"
        "result = troupe.run('wander', duration=0.5, video='run.mp4')\n"
        "print(result.outcome, result.ticks)\n"
        "assert signal.getsignal(signal.SIGINT) is signal.default_int_handler\n"
        "assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        env=environment(), cwd=tmp_path, capture_output=True, text=True, check=False, timeout=600,
    )  # fmt: skip
    assert (done.returncode, done.stdout) == (0, "completed 5\n"), done.stderr
    assert frames(tmp_path / "run.mp4") > 0
