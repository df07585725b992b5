"""The MP4 of a run: what it shows, when, how it ends, and what may go wrong."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import av
import cv2
import numpy as np
import pytest
from video_arenas import SQUARE, walled

from sim.video import Backdrop, Snapshot, encode
from sim.video.errors import VideoError
from sim.video.recorder import Recorder
from sim.video.sink import Sink
from sim.video.writer import REPEATS, WAITING, FrameWriter

GREEN, BLUE = 0x00FF00, 0x0000FF
SIZE = (320, 416)


def drive(time: float) -> np.ndarray:
    """Poses of two robots: one drives to the right, one upwards."""
    return np.array([[2 + 0.5 * time, 4.0, 0.0], [12.0, 3 + 0.5 * time, np.pi / 2]])


def film(path: Path, backdrop: Backdrop, seconds: float = 20.0, **options: object) -> Recorder:
    """A video of that many simulated seconds, with a snapshot every 0.1 s as in a run."""
    with Recorder(path, backdrop, **({"size": SIZE} | options)) as recorder:  # type: ignore[arg-type]
        recorder.add_robot("r1", SQUARE)
        recorder.add_robot("r2", 0.5)
        for tick in range(round(seconds * 10) + 1):
            time = tick * 0.1
            if recorder.wants(time):
                recorder.frame(Snapshot(time, drive(time), [GREEN, BLUE], 0.25))
    return recorder


def decoded(path: Path) -> Iterator[np.ndarray]:
    with av.open(str(path)) as container:
        for frame in container.decode(video=0):
            yield frame.to_ndarray(format="bgr24")


def place_of(recorder: Recorder, image: np.ndarray, channel: int) -> np.ndarray:
    """The middle, in metres, of the pixels in which one colour channel stands out."""
    others = [c for c in range(3) if c != channel]
    strong = image[..., channel].astype(int) - image[..., others].max(axis=2) > 60
    rows, columns = np.nonzero(strong)
    p = recorder.picture.projection
    left, right = columns.min(), columns.max() + 1
    top, bottom = rows.min(), rows.max() + 1
    return np.array([((left + right) / 2 - p.left), p.bottom - (top + bottom) / 2]) / p.scale


def test_the_file_has_the_size_rate_and_length_that_were_asked_for(
    arena: Backdrop, tmp_path: Path
) -> None:
    recorder = film(tmp_path / "run.mp4", arena, 20.0, fps=20, speed=5, size=(322, 418))
    assert recorder.error is None
    with av.open(str(tmp_path / "run.mp4")) as container:
        stream = container.streams.video[0]
        assert (stream.width, stream.height) == (322, 418)
        assert stream.average_rate == 20
        assert stream.codec_context.name == "h264"
        assert stream.codec_context.pix_fmt == "yuv420p"
        # Frames at 0, 0.25, ..., 20 simulated seconds.
        assert stream.frames == recorder.frames == 81
        assert float(stream.duration * stream.time_base) == pytest.approx(81 / 20)
        assert container.metadata["title"] == "A test"
    assert sum(1 for _ in decoded(tmp_path / "run.mp4")) == 81


def test_a_default_video_is_ten_times_as_fast_as_life(arena: Backdrop, tmp_path: Path) -> None:
    recorder = film(tmp_path / "run.mp4", arena, 20.0, size=None)
    with av.open(str(tmp_path / "run.mp4")) as container:
        stream = container.streams.video[0]
        assert (stream.width, stream.height) == (640, 840)
        assert float(stream.duration * stream.time_base) == pytest.approx(51 / 25)
    assert recorder.fps == 25


def test_robots_are_where_they_should_be_in_every_frame(arena: Backdrop, tmp_path: Path) -> None:
    recorder = film(tmp_path / "run.mp4", arena)
    count = 0
    for index, image in enumerate(decoded(tmp_path / "run.mp4")):
        time = np.ceil(index * 4 - 1e-9) / 10  # 10 / 25 s of simulated time from frame to frame
        first, second = drive(time)[:, :2]
        # Colours have half the resolution in H.264: 2 pixels of 1 / 18 m, and the tip of the arrow
        # may hide one more.
        assert place_of(recorder, image, 1) == pytest.approx(first, abs=0.17)
        assert place_of(recorder, image, 0) == pytest.approx(second, abs=0.17)
        count += 1
    assert count == 51


def test_colours_survive_the_encoding(arena: Backdrop, tmp_path: Path) -> None:
    recorder = film(tmp_path / "run.mp4", arena, 0.0, size=None)
    drawn = recorder.picture.draw(Snapshot(0.0, drive(0.0), [GREEN, BLUE], 0.25))
    shown = next(decoded(tmp_path / "run.mp4"))
    # Compression and halved colour resolution smear edges; inside of an area the colour stays
    # within 8 of 255, which is what limited range (219 steps) and quantisation leave.
    for x, y in ((8.5, 10.5), (1.72, 4.28), (12, -0.1), (12.0, 2.8)):
        column, row = recorder.picture.projection.edges(np.array([x, y], float)).astype(int)
        assert shown[row, column].astype(int) == pytest.approx(drawn[row, column], abs=8)


def test_the_same_run_makes_the_same_file(arena: Backdrop, tmp_path: Path) -> None:
    film(tmp_path / "a.mp4", arena)
    film(tmp_path / "b.mp4", arena)
    assert (tmp_path / "a.mp4").read_bytes() == (tmp_path / "b.mp4").read_bytes()


def test_slow_motion_repeats_frames_so_that_time_stays_true(
    arena: Backdrop, tmp_path: Path
) -> None:
    recorder = film(tmp_path / "run.mp4", arena, 2.0, fps=25, speed=1)
    images = list(decoded(tmp_path / "run.mp4"))
    assert len(images) == recorder.frames == 51
    # A tick lasts 2.5 frames, and frame k shows the first tick at or after k / 25 s.
    for index in (0, 1, 25, 26, 50):
        time = np.ceil(index / 2.5 - 1e-9) / 10
        assert place_of(recorder, images[index], 1)[0] == pytest.approx(2 + time / 2, abs=0.12)


def test_frames_are_wanted_when_due_and_only_then(arena: Backdrop, tmp_path: Path) -> None:
    with Recorder(tmp_path / "run.mp4", arena, fps=10, speed=5, size=SIZE) as recorder:
        snapshot = Snapshot(0.0, np.empty((0, 3)), [])
        due = []
        for tick in range(21):
            snapshot.time = tick * 0.1
            if recorder.wants(snapshot.time):
                due.append(tick)
            recorder.frame(snapshot)
    assert due == [0, 5, 10, 15, 20]
    assert recorder.frames == 5


def test_the_last_frame_shows_how_the_run_ended(arena: Backdrop, tmp_path: Path) -> None:
    with Recorder(tmp_path / "run.mp4", arena, size=SIZE) as recorder:
        recorder.add_robot("r1", SQUARE)
        recorder.add_robot("r2", 0.5)
        recorder.frame(Snapshot(0.0, drive(0.0), [GREEN, BLUE]))
        for _ in range(2):
            recorder.frame(Snapshot(0.3, drive(5.0), [GREEN, BLUE]), last=True)
    images = list(decoded(tmp_path / "run.mp4"))
    assert len(images) == 2
    assert place_of(recorder, images[1], 1)[0] == pytest.approx(4.5, abs=0.12)


def test_the_index_stands_in_front_and_nothing_is_left_beside_the_file(
    arena: Backdrop, tmp_path: Path
) -> None:
    film(tmp_path / "run.mp4", arena)
    data = (tmp_path / "run.mp4").read_bytes()
    assert 0 < data.find(b"moov") < data.find(b"mdat")
    assert b"moof" not in data
    assert [path.name for path in tmp_path.iterdir()] == ["run.mp4"]


def test_a_run_that_fails_leaves_a_video_up_to_there(arena: Backdrop, tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "run.mp4", arena, size=SIZE)

    def run() -> None:
        with recorder:
            for tick in range(30):
                recorder.frame(Snapshot(tick * 0.4, np.empty((0, 3)), []))
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run()
    assert sum(1 for _ in decoded(tmp_path / "run.mp4")) == 30


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


def test_an_interrupted_run_does_not_wait_for_the_frames_of_a_slow_film(
    arena: Backdrop, tmp_path: Path
) -> None:
    asked = 0

    def going_on() -> bool:
        nonlocal asked
        asked += 1
        return asked < 3

    with Recorder(tmp_path / "run.mp4", arena, fps=240, speed=0.01, size=SIZE) as recorder:
        snapshot = Snapshot(10.0, np.empty((0, 3)), [])
        recorder.frame(snapshot, going_on=going_on)  # 240,001 frames are due
    assert recorder.frames == 3 * REPEATS
    assert sum(1 for _ in decoded(tmp_path / "run.mp4")) == 3 * REPEATS


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full here")
def test_a_full_disk_stops_the_video_but_not_the_run(arena: Backdrop, tmp_path: Path) -> None:
    path = tmp_path / "run.mp4"
    path.symlink_to("/dev/full")
    recorder = film(path, arena, 200.0)
    assert recorder.error is not None
    assert "No space left on device" in recorder.error
    assert str(path) in recorder.error
    assert not recorder.wants(1e9)


def test_after_an_encoders_error_frames_are_dropped_and_nothing_waits() -> None:
    class Broken:
        written = 0

        def write(self, image: np.ndarray, times: int) -> None:
            self.written += 1
            raise OSError(28, "No space left on device")

        def close(self) -> None:
            raise OSError(5, "Input/output error")

    encoder = Broken()
    writer = FrameWriter(encoder, (4, 4, 3))
    for _ in range(10 * WAITING):
        writer.put(writer.buffer())
    writer.close()
    assert encoder.written == 1
    assert isinstance(writer.error, OSError)
    assert writer.error.errno == 28


def test_frames_are_encoded_in_order_and_never_overwritten_while_they_wait() -> None:
    class Slow:
        def __init__(self) -> None:
            self.seen: list[tuple[int, int]] = []

        def write(self, image: np.ndarray, times: int) -> None:
            first = int(image[0, 0, 0])
            assert (image == first).all()
            self.seen.append((first, times))

        def close(self) -> None:
            pass

    encoder = Slow()
    writer = FrameWriter(encoder, (50, 50, 3))
    for number in range(200):
        image = writer.buffer()
        image[:] = number
        writer.put(image, number % 3 + 1)
    writer.close()
    assert writer.error is None
    assert encoder.seen == [(number, number % 3 + 1) for number in range(200)]


def test_many_frames_of_one_image_are_encoded_in_parts_and_none_is_lost() -> None:
    class Counting:
        seen: list[tuple[int, int]] = []  # noqa: RUF012

        def write(self, image: np.ndarray, times: int) -> None:
            self.seen.append((int(image[0, 0, 0]), times))

        def close(self) -> None:
            pass

    encoder = Counting()
    writer = FrameWriter(encoder, (4, 4, 3))
    for number in range(1, 40):
        image = writer.buffer()
        image[:] = number
        assert writer.put(image, 5 * number) == 5 * number
    writer.close()
    assert max(times for _, times in encoder.seen) <= REPEATS
    for number in range(1, 40):
        assert sum(times for shown, times in encoder.seen if shown == number) == 5 * number


def test_without_pyav_opencv_makes_the_video_and_says_so(
    arena: Backdrop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "av", None)
    recorder = film(tmp_path / "run.mp4", arena)
    monkeypatch.undo()
    assert recorder.error is None
    assert recorder.notice is not None
    assert "pip install av" in recorder.notice
    assert "\n" not in recorder.notice
    reader = cv2.VideoCapture(str(tmp_path / "run.mp4"))
    assert reader.get(cv2.CAP_PROP_FPS) == 25
    assert (reader.get(3), reader.get(4)) == SIZE
    images = []
    while (frame := reader.read())[0]:
        images.append(frame[1])
    assert len(images) == 51
    assert place_of(recorder, images[50], 1) == pytest.approx([12, 4], abs=0.12)


def test_with_pyav_there_is_nothing_to_say(arena: Backdrop, tmp_path: Path) -> None:
    assert film(tmp_path / "run.mp4", arena, 0.0).notice is None


def test_a_run_without_video_loads_neither_opencv_nor_the_encoder() -> None:
    code = "import sys, sim.video; sys.exit('cv2' in sys.modules or 'av' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_robots_may_enter_while_the_video_runs(tmp_path: Path) -> None:
    with Recorder(tmp_path / "run.mp4", walled(16, 21), size=SIZE) as recorder:
        for count in range(5):
            recorder.frame(Snapshot(count * 0.4, np.full((count, 3), 5.0), [GREEN] * count))
            recorder.add_robot(f"r{count}", 0.4)
    assert sum(1 for _ in decoded(tmp_path / "run.mp4")) == 5


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


def test_a_sink_keeps_the_first_error_and_swallows_the_rest(tmp_path: Path) -> None:
    sink = Sink(tmp_path / "file")
    assert sink.write(b"abc") == 3
    sink._file.close()
    (tmp_path / "file").unlink()
    sink._file = (tmp_path / "other").open("xb", buffering=0)
    os.close(sink._file.fileno())
    assert sink.write(b"defg") == 4
    assert sink.seek(1) == 7
    sink.close()
    with pytest.raises(OSError, match="Bad file descriptor"):
        sink.check()


@pytest.mark.parametrize("wide", [True, False])
def test_x264_is_kept_from_avx_512_where_there_is_any(
    monkeypatch: pytest.MonkeyPatch, wide: bool
) -> None:
    monkeypatch.setattr("llvmlite.binding.get_host_cpu_features", lambda: {"avx512f": wide})
    assert ("asm=" in encode.tuning()) is wide
