"""`troupe render`: from a log comes what the run itself would have drawn, to the pixel."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import av
import cv2
import numpy as np
import pytest
from typer.testing import CliRunner

import troupe
from sim.interrupts import Interrupts
from sim.log.playback import Playback
from sim.log.reader import LogReader
from tests.troupe.own_sensor import example
from troupe.app import app
from troupe.filmed import Filmed
from troupe.log import LogError
from troupe.render import render
from troupe.show import Screen
from troupe.usage import UsageError

WORLD = """\
name: "All that shows\\x1b[31m"
size: [10, 10]
duration: 9
until: duration
floor: {resolution: 0.1}
models:
  rover:
    body: {shape: box, size: [0.8, 0.6]}
    drive: {kind: omnidirectional}
    sensors:
      - {type: laser, samples: 61, range: 6, noise: 0.02}
      - {type: blobfinder, range: 8, colors: [red, "#00ff00", "#3366cc"]}
    actuators: [{type: sprayer}]
  disc:
    body: {shape: circle, radius: 0.3, color: "#3366cc"}
    sensors: [{type: laser, samples: 19, range: 3}]
obstacles:
  - {shape: box, size: [1, 1], pose: [4.2, 5, 0], movable: true, color: "#aa7700"}
  - {shape: circle, radius: 0.5, pose: [8, 2, 0]}
robots:
  - {name: one, model: rover, pose: [2, 5, 0], controller: painter}
  - {name: two, model: disc, pose: [5, 8, -90], controller: talker}
doors: [{name: late, at: [8, 8], model: disc, period: 30, controller: quick}]
controllers:
  painter: {program: ./painter.py}
  talker: {program: ./talker.py}
  quick: {program: ./quick.py}
"""
PAINTER = """\
from player import (BlobfinderProxy, DioProxy, LaserProxy, PlayerClient, Position2dProxy,
                    SimulationProxy)

with PlayerClient() as robot:
    base, spray, laser = Position2dProxy(robot), DioProxy(robot), LaserProxy(robot)
    eyes = BlobfinderProxy(robot)
    simulation = SimulationProxy(robot)
    spray.set_output(1)
    tick = 0
    while robot.read():
        tick += 1
        base.set_speed(0.5, 0.2 if tick > 30 else 0.0)
        if tick == 20:
            simulation.report("color", "#00ff00")
        if tick == 60:
            spray.set_output(0)
"""
TALKER = """\
from player import Graphics2dProxy, LaserProxy, PlayerClient, Position2dProxy, SpeechProxy

with PlayerClient() as robot:
    base, speech, pen = Position2dProxy(robot), SpeechProxy(robot), Graphics2dProxy(robot)
    base.set_speed(0.3, 0.4)
    for tick in range(55):
        if not robot.read():
            break
        if tick % 10 == 0:
            speech.say(f"tick {tick}\\x1b[31m")
            pen.clear()
            pen.draw_polyline([(0, 0), (0.5, 0.1 * tick)], 0xFF0000)
            pen.draw_polygon([(0, 0), (0.3, 0), (0, 0.3)], 0x0000FF, fill=0xFFFF00)
        if tick == 30:
            laser = LaserProxy(robot)
    speech.say("and that was all")
"""
QUICK = """\
from player import LaserProxy, PlayerClient, SpeechProxy

with PlayerClient() as robot:
    laser = LaserProxy(robot)
    robot.read()
    SpeechProxy(robot).say("here")
"""


class Kept(NamedTuple):
    """A run's log, video and pictures, and the folder where others can be made."""

    log: Path
    video: Path
    still: Path
    folder: Path


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Kept:
    folder = tmp_path_factory.mktemp("render")
    (folder / "world.yaml").write_text(WORLD)
    for name, text in (("painter", PAINTER), ("talker", TALKER), ("quick", QUICK)):
        (folder / f"{name}.py").write_text(text)
    kept = Kept(folder / "run.mcap", folder / "run.mp4", folder / "run.png", folder)
    result = troupe.run(
        folder / "world.yaml", log=kept.log, video=kept.video, video_speed=4.0,
        video_show=["fans", "names", "trails", "speech", "blobs"], picture=kept.still, at=5.0,
    )  # fmt: skip
    assert result.outcome == "completed", [robot.error for robot in result.robots]
    assert result.floor.painted_area > 0
    return kept


def frames(video: Path) -> Iterator[np.ndarray]:
    """The decoded frames of a video, as RGB."""
    with av.open(str(video)) as film:
        for frame in film.decode(video=0):
            yield frame.to_ndarray(format="rgb24")


def test_a_rendered_video_is_that_of_the_run_frame_by_frame(kept: Kept) -> None:
    again = kept.folder / "again.mp4"
    show = ["fans", "names", "trails", "speech", "blobs"]
    assert render(kept.log, Filmed(again, speed=4.0, show=show)) is None
    mine, theirs = list(frames(again)), list(frames(kept.video))
    assert len(mine) == len(theirs) > 50
    for k, (a, b) in enumerate(zip(mine, theirs, strict=True)):
        assert (a == b).all(), f"frame {k}"
    assert again.read_bytes() == kept.video.read_bytes()


def test_a_rendered_picture_is_that_of_the_run(kept: Kept) -> None:
    again = kept.folder / "again.png"
    show = ["fans", "names", "trails", "speech", "blobs"]
    assert render(kept.log, Filmed(picture=again, at=5.0, show=show)) is None
    assert (cv2.imread(str(again)) == cv2.imread(str(kept.still))).all()


def test_rendering_tells_how_far_it_has_come(kept: Kept) -> None:
    told: list[tuple[float, float]] = []
    render(
        kept.log,
        Filmed(picture=kept.folder / "told.svg", at=5.0),
        progress=lambda *both: told.append(both),
    )
    assert told == [(pytest.approx(0.1 * tick), 5.0) for tick in range(1, 51)]


def test_a_terminal_gets_a_bar_while_a_log_is_rendered(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = io.StringIO()
    terminal.isatty = lambda: True  # type: ignore[method-assign]
    monkeypatch.setattr("sys.stderr", terminal)
    monkeypatch.setenv("TERM", "xterm")
    with Screen(quiet=False) as screen:
        screen.rendered(5.0, 20.0)
        screen.bar.refresh()
    assert "5.0 s of 20" in terminal.getvalue()


def test_what_shows_at_the_end_is_what_the_run_showed(kept: Kept) -> None:
    world = kept.folder / "world.yaml"
    mine, theirs = kept.folder / "mine.svg", kept.folder / "theirs.svg"
    troupe.run(world, picture=theirs)
    assert render(kept.log, Filmed(picture=mine)) is None
    assert mine.read_text() == theirs.read_text()
    assert "and that was all" in mine.read_text()


def test_ticks_show_the_same_in_any_order(kept: Kept) -> None:
    forward = Playback(LogReader(kept.log))
    shown = {k: described(forward, k) for k in range(0, 90, 7)}
    other = Playback(LogReader(kept.log))
    for k in sorted(shown, key=lambda k: (k * 37) % 91):
        assert described(other, k) == shown[k]


def described(playback: Playback, k: int) -> str:
    """All that a tick shows, as text."""
    present = playback.present(k)
    frame = present.snapshot()
    painted = None if frame.floor is None else np.bincount(frame.floor.reshape(-1)).tolist()
    fans = [(scan.robot, list(scan.ranges)) for scan in present.scans()]
    return repr((frame.time, frame.poses.tolist(), list(frame.colors), frame.said, painted, fans,
                 list(frame.settled), [len(one.points) for one in frame.drawings]))  # fmt: skip


def test_nobodys_code_runs_because_a_log_is_looked_at(tmp_path: Path) -> None:
    ran = tmp_path / "ran"
    code = example("nose.py") + f"\nfrom pathlib import Path\n\nPath({str(ran)!r}).touch()\n"
    (tmp_path / "nose.py").write_text(code)
    (tmp_path / "world.yaml").write_text(
        "size: [6, 6]\nduration: 1\nmodels:\n  m:\n    body: {shape: circle, radius: 0.3}\n"
        "    sensors: [{type: ./nose.py, color: red}, {type: laser, samples: 9}]\n"
        "robots: [{model: m, pose: [3, 3, 0]}]\n"
    )
    log, picture = tmp_path / "run.mcap", tmp_path / "again.svg"
    troupe.run(tmp_path / "world.yaml", log=log, log_sensors=["all"], picture=tmp_path / "a.svg")
    ran.unlink()
    assert render(log, Filmed(picture=picture)) is None
    assert not ran.exists()
    assert picture.read_text() == (tmp_path / "a.svg").read_text()


def test_the_command_tells_what_it_has_made(kept: Kept) -> None:
    picture = kept.folder / "told.svg"
    done = CliRunner().invoke(
        app, ["render", str(kept.log), "--picture", str(picture), "--at", "3"]
    )
    assert done.exit_code == 0, done.output
    assert f"picture: {picture}" in done.stdout
    assert "3.0 s" in picture.read_text()
    assert "\x1b" not in done.output


def test_a_moment_after_the_end_shows_the_end_and_says_so(kept: Kept) -> None:
    picture = kept.folder / "late.svg"
    said: list[str] = []
    assert render(kept.log, Filmed(picture=picture, at=99), say=said.append) is None
    assert any("ended at 9 s" in line for line in said)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ([], "nothing to be made"),
        (["--video-fps", "9"], "no video"),
        (["--video", "x.mcap"], "mp4"),
        (["--picture", "x.gif"], "png"),
        (["--picture", "x.png", "--at", "-1"], "0 or more"),
        (["--picture", "x.png", "--video-show", "fan"], "did you mean 'fans'"),
    ],
)
def test_options_that_cannot_be_are_refused(kept: Kept, options: list[str], message: str) -> None:
    done = CliRunner().invoke(app, ["render", str(kept.log), *options])
    assert done.exit_code == 2
    assert message in done.stderr


def test_a_log_with_damage_inside_is_told_and_what_came_before_is_kept(kept: Kept) -> None:
    data = bytearray(kept.log.read_bytes())
    chunk = troupe.Log(kept.log)._reader.chunks[-1]
    data[chunk.at + 80] ^= 0xFF
    path, video = kept.folder / "damaged.mcap", kept.folder / "damaged.mp4"
    path.write_bytes(data)
    with pytest.raises(LogError, match="damaged"):
        render(path, Filmed(video, speed=4.0))


def test_there_must_be_something_to_be_made() -> None:
    with pytest.raises(UsageError, match="nothing to be made"):
        render(Path("no-such.mcap"), Filmed())


class Noted(Interrupts):
    """Somebody asks for the end when it has been looked for so often."""

    def __init__(self, after: int) -> None:
        self.left = after
        super().__init__()

    @property
    def noted(self) -> bool:
        self.left -= 1
        return self.left < 0

    @noted.setter
    def noted(self, value: bool) -> None:
        assert not value


def test_a_video_that_is_interrupted_ends_there_and_can_be_played(kept: Kept) -> None:
    video = kept.folder / "half.mp4"
    assert render(kept.log, Filmed(video, speed=4.0), interrupts=Noted(after=40)) is None
    assert 1 <= len(list(frames(video))) < len(list(frames(kept.video)))
