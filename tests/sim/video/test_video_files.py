"""Where a video is written, what is left there, and what is refused before anything is lost."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from filmed import decoded, film

from sim.video import Backdrop
from sim.video.errors import VideoError
from sim.video.recorder import Recorder
from sim.video.writer import WAITING


def test_the_index_stands_in_front_and_nothing_is_left_beside_the_file(
    arena: Backdrop, tmp_path: Path
) -> None:
    film(tmp_path / "run.mp4", arena)
    data = (tmp_path / "run.mp4").read_bytes()
    assert 0 < data.find(b"moov") < data.find(b"mdat")
    assert b"moof" not in data
    assert [path.name for path in tmp_path.iterdir()] == ["run.mp4"]


KILLED = """
import sys
import numpy as np
from sim.video import Backdrop, Snapshot
from sim.video.recorder import Recorder

recorder = Recorder(sys.argv[1], Backdrop((16, 21)), size=(160, 210))
for tick in range(300):
    recorder.frame(Snapshot(tick * 0.4, np.empty((0, 3)), []))
print("drawn", flush=True)
sys.stdin.read()
"""


def test_a_killed_run_leaves_a_video_that_can_be_played(tmp_path: Path) -> None:
    path = tmp_path / "run.mp4"
    with subprocess.Popen(
        [sys.executable, "-c", KILLED, str(path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as child:
        assert child.stdout is not None
        assert child.stdout.readline() == "drawn\n"
        child.kill()
    # All but the piece of two seconds (50 frames) that was being written, what the encoder
    # looks ahead (10) and what waited for it.
    assert sum(1 for _ in decoded(path)) >= 300 - 2 * 50 - 10 - WAITING


def test_a_video_without_frames_leaves_no_file(arena: Backdrop, tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "run.mp4", arena)
    assert recorder.close() == tmp_path / "run.mp4"
    assert recorder.close() == tmp_path / "run.mp4"
    assert recorder.error is None
    assert list(tmp_path.iterdir()) == []


def test_a_link_is_followed_not_replaced(arena: Backdrop, tmp_path: Path) -> None:
    (tmp_path / "link.mp4").symlink_to(tmp_path / "real.mp4")
    film(tmp_path / "link.mp4", arena, 1.0)
    assert (tmp_path / "link.mp4").is_symlink()
    assert sum(1 for _ in decoded(tmp_path / "real.mp4")) == 3


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("run.avi", r"must end in \.mp4"),
        ("run", r"must end in \.mp4"),
        ("nowhere/run.mp4", "no folder .*nowhere"),
        ("folder.mp4", "is a folder"),
        ("file.txt/run.mp4", "no folder .*file.txt"),
    ],
)
def test_a_path_that_cannot_be_written_is_refused_at_once(
    arena: Backdrop, tmp_path: Path, name: str, message: str
) -> None:
    (tmp_path / "folder.mp4").mkdir()
    (tmp_path / "file.txt").touch()
    with pytest.raises(VideoError, match=message):
        Recorder(tmp_path / name, arena)
    assert {path.name for path in tmp_path.iterdir()} == {"folder.mp4", "file.txt"}


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_without_the_right_to_write_is_refused_at_once(
    arena: Backdrop, tmp_path: Path
) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(VideoError, match="Permission denied"):
        Recorder(tmp_path / "run.mp4", arena)


@pytest.mark.parametrize(
    "options",
    [
        {"fps": 0},
        {"fps": 1000},
        {"fps": float("nan")},
        {"speed": 0},
        {"speed": -1},
        {"speed": 1e-9},
        {"speed": 1e9},
        {"size": (3, 4)},
    ],
)
def test_settings_that_cannot_be_are_refused_before_the_file_is_touched(
    arena: Backdrop, tmp_path: Path, options: dict[str, float]
) -> None:
    path = tmp_path / "run.mp4"
    path.write_bytes(b"yesterday's video")
    with pytest.raises(VideoError, match=r"video (fps|speed|size)"):
        Recorder(path, arena, **options)  # type: ignore[arg-type]
    assert path.read_bytes() == b"yesterday's video"


def test_a_link_to_itself_is_refused(arena: Backdrop, tmp_path: Path) -> None:
    (tmp_path / "a.mp4").symlink_to("b.mp4")
    (tmp_path / "b.mp4").symlink_to("a.mp4")
    for path in (tmp_path / "a.mp4", tmp_path / "b.mp4" / "run.mp4"):
        with pytest.raises(VideoError, match="leads back to itself"):
            Recorder(path, arena)


def test_a_pipe_without_a_reader_is_refused_at_once(arena: Backdrop, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "run.mp4")
    with pytest.raises(VideoError, match=r"run\.mp4: is no plain file"):
        Recorder(tmp_path / "run.mp4", arena)


def test_a_name_that_is_too_long_is_refused(arena: Backdrop, tmp_path: Path) -> None:
    with pytest.raises(VideoError, match="cannot be written"):
        Recorder(tmp_path / f"{'x' * 300}.mp4", arena)
    with pytest.raises(VideoError, match="cannot be written"):
        Recorder(tmp_path / "null\0.mp4", arena)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full here")
def test_a_full_disk_stops_the_video_but_not_the_run(arena: Backdrop, tmp_path: Path) -> None:
    path = tmp_path / "run.mp4"
    path.symlink_to("/dev/full")
    recorder = film(path, arena, 200.0)
    assert recorder.error is not None
    assert "No space left on device" in recorder.error
    assert str(path) in recorder.error
    assert not recorder.wants(1e9)


def test_where_no_second_file_can_be_made_the_pieces_stay_and_play(
    arena: Backdrop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*arguments: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("sim.video.encode.put_index_in_front", full)
    recorder = film(tmp_path / "run.mp4", arena)
    assert recorder.error is None
    assert sum(1 for _ in decoded(tmp_path / "run.mp4")) == 51
    assert b"moof" in (tmp_path / "run.mp4").read_bytes()
