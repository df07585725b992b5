"""Frames to MP4: H.264 by PyAV, or OpenCV's MPEG-4 where PyAV cannot be imported."""

from __future__ import annotations

import contextlib
import os
from fractions import Fraction
from pathlib import Path
from typing import Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.video.errors import VideoError
from sim.video.sink import Sink

PRESET = "veryfast"
TUNING = "bframes=0:subme=1:me=dia"
"""On flat drawings these halve the preset's time for a tenth more bytes: no reordered frames,
plain searches for motion."""
NARROW = "asm=SSE2,SSSE3,SSE4.2,AVX,FMA3,BMI2,AVX2"
"""x264's instructions on processors with AVX-512, which it is kept from: on a busy virtual machine
one film in ten came out with other bytes, from the same pictures, and none of seventy without."""
QUALITY = "23"
"""x264's constant rate factor; 23 is its default, 18 looks lossless at twice the size."""
KEYFRAME_SECONDS = 2
"""Seconds of video between key frames; what a killed run loses at most, and how far off the
mark a jump in a player lands."""

INDEX_BYTES, INDEX_BYTES_PER_FRAME = 8192, 40
"""Room for the index in front of the frames. A frame takes 4 bytes in stsz and, were it a chunk
and a key frame of its own length, 8 in co64, 12 in stsc, 8 in stts and 4 in stss (ISO/IEC
14496-12, 8.6 and 8.7)."""

# ITU-T H.273: what a player needs to know to show the colours that were drawn.
_MATRIX_BT601, _PRIMARIES_BT709, _TRANSFER_BT709, _RANGE_LIMITED = 6, 1, 1, 1


class Encoder(Protocol):
    """Writes frames of one size to one file."""

    def write(self, image: NDArray[np.uint8], times: int) -> None:
        """Adds a frame (height, width, 3) BGR, `times` times; raises VideoError or OSError."""

    def close(self) -> None:
        """Completes the file; raises VideoError or OSError."""


def tuning() -> str:
    """How x264 is set on this processor: the bytes are the same on all."""
    from llvmlite.binding import get_host_cpu_features  # noqa: PLC0415 - loaded with the kernels

    wide = get_host_cpu_features().get("avx512f", False)
    return f"{TUNING}:{NARROW}" if wide else TUNING


class H264Encoder:
    """libx264 in MP4.

    While it writes, the file is fragmented: a key frame starts a piece that can be played
    whatever happens afterwards, even if the process is killed. `close` rewrites the pieces, without
    encoding anew, as a plain file with its index in front, which players can seek in and
    browsers start at once.
    """

    def __init__(self, path: Path, size: tuple[int, int], fps: float, title: str = "") -> None:
        import av  # noqa: PLC0415 - the one place that needs it; absent on some machines

        self._path = path
        self._title = title
        self._index = 0
        self._sink = Sink(path)
        fragments = {"movflags": "frag_keyframe+empty_moov+default_base_moof", "flush_packets": "1"}
        self._container = av.open(self._sink, "w", format="mp4", options=fragments)
        rate = Fraction(fps).limit_denominator(1001)
        stream = self._container.add_stream("libx264", rate=rate)
        stream.width, stream.height = size
        stream.pix_fmt = "yuv420p"
        stream.options = {"preset": PRESET, "crf": QUALITY, "x264-params": tuning()}
        context = stream.codec_context
        context.gop_size = max(1, round(KEYFRAME_SECONDS * fps))
        context.time_base = 1 / rate
        # A fixed number of threads: their number changes the encoded bytes.
        context.thread_count = 1
        context.colorspace = _MATRIX_BT601
        context.color_primaries = _PRIMARIES_BT709
        context.color_trc = _TRANSFER_BT709
        context.color_range = _RANGE_LIMITED
        self._stream = stream
        # x264 copies what it is given, so one frame serves for all. A new one each time would
        # cost more than the copy: the system has to hand out its pages.
        self._frame = av.VideoFrame(*size, "yuv420p")
        self._planes = [
            np.frombuffer(plane, np.uint8).reshape(plane.height, plane.line_size)[:, : plane.width]  # type: ignore[call-overload]
            for plane in self._frame.planes
        ]
        self._packed = np.empty((size[1] * 3 // 2, size[0]), np.uint8)

    def write(self, image: NDArray[np.uint8], times: int) -> None:
        """Adds a frame (height, width, 3) BGR, `times` times."""
        cv2.cvtColor(image, cv2.COLOR_BGR2YUV_I420, dst=self._packed)
        start, packed = 0, self._packed.reshape(-1)
        for plane in self._planes:
            plane[:] = packed[start : start + plane.size].reshape(plane.shape)
            start += plane.size
        for _ in range(times):
            self._frame.pts = self._index
            self._index += 1
            for packet in self._stream.encode(self._frame):
                self._container.mux(packet)
        self._sink.check()

    def close(self) -> None:
        """Completes the file and puts its index in front; a video of no frames leaves no file."""
        try:
            if self._index:
                for packet in self._stream.encode(None):
                    self._container.mux(packet)
            self._container.close()
        finally:
            self._sink.close()
        self._sink.check()
        if self._index == 0:
            self._path.unlink(missing_ok=True)
        elif not self._path.exists():
            raise VideoError("the file was removed while it was written")
        elif self._path.is_file():
            # Where no second file can be made, for want of room or of rights, the pieces stay:
            # they are complete, and play too.
            with contextlib.suppress(OSError, ValueError):
                put_index_in_front(self._path, self._index, self._title)


def put_index_in_front(path: Path, frames: int, title: str = "") -> None:
    """Rewrites a fragmented MP4 of so many frames as a plain one, `moov` before the frames.

    The old file stays until the new one is complete and can be read. Raises OSError or, for
    a file that is no video, ValueError.
    """
    import av  # noqa: PLC0415

    finished = draft_of(path)
    room = {"moov_size": str(INDEX_BYTES + INDEX_BYTES_PER_FRAME * frames)}
    sink = Sink(finished)
    try:
        with av.open(str(path)) as source, av.open(sink, "w", format="mp4", options=room) as target:
            if title:
                target.metadata["title"] = title
            stream = source.streams.video[0]
            copied = target.add_stream_from_template(stream)
            for packet in source.demux(stream):
                if packet.dts is not None:
                    packet.stream = copied
                    target.mux(packet)
        sink.close()
        sink.check()
        with av.open(str(finished)) as result:  # PyAV before 15.1 copies a wrong header
            next(result.decode(video=0))
        finished.chmod(path.stat().st_mode)
        finished.replace(path)
    finally:
        sink.close()
        finished.unlink(missing_ok=True)


def draft_of(path: Path) -> Path:
    """Where a video is rewritten, beside the file that it takes the place of."""
    return path.with_name(f".{path.name}.{os.getpid()}")


def abandon(path: Path) -> None:
    """Leave at `path` a video that plays, or nothing: to be called when nobody will complete it."""
    draft_of(path).unlink(missing_ok=True)
    if path.suffix.lower() != ".mp4" or not path.is_file():
        return
    with path.open("rb") as file:
        head = file.read(1 << 16)
    if b"moof" not in head and not (b"moov" in head and b"mdat" in head):
        path.unlink()


class Mpeg4Encoder:
    """OpenCV's `mp4v`: plays in VLC and mpv, in no browser."""

    def __init__(self, path: Path, size: tuple[int, int], fps: float) -> None:
        self._path = path
        self._count = 0
        codec = cv2.VideoWriter.fourcc(*"mp4v")
        self._writer = cv2.VideoWriter(str(path), codec, float(fps), size)
        if not self._writer.isOpened():
            raise VideoError(f"{path}: OpenCV cannot write MPEG-4 video here")

    def write(self, image: NDArray[np.uint8], times: int) -> None:
        """Adds a frame (height, width, 3) BGR, `times` times."""
        for _ in range(times):
            self._writer.write(image)
            self._count += 1

    def close(self) -> None:
        """Completes the file; raises VideoError where OpenCV lost frames without a word."""
        self._writer.release()
        if self._count == 0:
            return
        reader = cv2.VideoCapture(str(self._path))
        readable = int(reader.get(cv2.CAP_PROP_FRAME_COUNT)) if reader.isOpened() else 0
        reader.release()
        if readable < self._count:
            raise VideoError(
                f"{self._path}: only {readable} of {self._count} frames could be written; "
                "is the disk full?"
            )


def open_encoder(
    path: Path, size: tuple[int, int], fps: float, title: str = ""
) -> tuple[Encoder, str | None]:
    """The best encoder at hand, and a line for the user where it is not the best there is.

    Raises VideoError where the file cannot be opened.
    """
    try:
        return H264Encoder(path, size, fps, title), None
    except ImportError as error:
        missing = f"PyAV cannot be imported ({error})"
    except OSError as error:
        raise VideoError(f"{path}: cannot be written ({error.strerror or error})") from error
    except ValueError as error:  # PyAV's UnknownCodecError
        missing = f"PyAV has no libx264 here ({error})"
    notice = (
        f"{missing}: the video is MPEG-4 part 2, which no browser plays. "
        "`pip install av` makes it H.264."
    )
    return Mpeg4Encoder(path, size, fps), notice
