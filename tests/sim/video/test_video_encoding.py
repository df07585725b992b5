"""How frames are handed to the encoder, and which encoder that is."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest
from filmed import SIZE, decoded, film, place_of

from sim.video import Backdrop, Snapshot, encode
from sim.video.recorder import Recorder
from sim.video.sink import Sink
from sim.video.writer import REPEATS, WAITING, FrameWriter


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
