"""The MP4 of a run: what it shows and when, and how it ends."""

from __future__ import annotations

from pathlib import Path

import av
import numpy as np
import pytest
from filmed import BLUE, GREEN, SIZE, decoded, drive, film, place_of
from video_arenas import SQUARE, walled

from sim.video import Backdrop, Snapshot
from sim.video.recorder import Recorder


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


def test_robots_may_enter_while_the_video_runs(tmp_path: Path) -> None:
    with Recorder(tmp_path / "run.mp4", walled(16, 21), size=SIZE) as recorder:
        for count in range(5):
            recorder.frame(Snapshot(count * 0.4, np.full((count, 3), 5.0), [GREEN] * count))
            recorder.add_robot(f"r{count}", 0.4)
    assert sum(1 for _ in decoded(tmp_path / "run.mp4")) == 5
