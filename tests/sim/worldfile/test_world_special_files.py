"""What a world names may be any file: pipes, devices, sockets, folders, damaged and huge images."""

from __future__ import annotations

import os
import resource
import socket
import subprocess
import sys
import zlib
from collections.abc import Callable
from pathlib import Path
from struct import pack

import cv2
import numpy as np
import pytest
from world_texts import mistakes_in

from sim.stage.imagemap import read_image_map
from sim.stage.imagesize import image_size
from tests import started
from tests.processes import environment

LONGEST = 600
"""Seconds, only against hanging for ever."""


def make_fifo(path: Path) -> None:
    os.mkfifo(path)


def make_socket(path: Path) -> None:
    here = Path.cwd()
    os.chdir(path.parent)  # the name of a socket is short
    try:
        with socket.socket(socket.AF_UNIX) as server:
            server.bind(path.name)
    finally:
        os.chdir(here)


SPECIAL: dict[str, tuple[Callable[[Path], None], str]] = {
    "pipe": (make_fifo, "is a pipe"),
    "zeros": (lambda path: path.symlink_to("/dev/zero"), "is a device"),
    "socket": (make_socket, "is a socket"),
    "folder": (Path.mkdir, "is a folder"),
    "loop": (lambda path: path.symlink_to(path), "cannot be read"),
}
USES = {
    "map: {file: %s, resolution: 0.1}": "1:13: map.file",
    "map: {file: %s, cell: 1}": "1:13: map.file",
    "size: [5, 5]\ninclude: %s": "2:10: include",
    "size: [5, 5]\ncontrollers: {a: {program: ./%s}}": "2:28: controllers.a.program",
    "size: [5, 5]\ncontrollers: {a: {command: [./%s]}}": "2:29: controllers.a.command.0",
    "size: [5, 5]\nmodels: {r: {body: {shape: circle, radius: 1}, sensors: [{type: ./%s}]}}": (
        "2:65: models.r.sensors.0.type"
    ),
}


@pytest.mark.parametrize("use", USES)
@pytest.mark.parametrize("kind", SPECIAL)
def test_a_special_file_is_refused_at_its_place_whatever_it_is_used_as(
    tmp_path: Path, kind: str, use: str
) -> None:
    make, what = SPECIAL[kind]
    name = f"{kind}.py" if "program" in use or "type" in use else kind
    make(tmp_path / name)
    (tmp_path / "world.yaml").write_text(use % name)
    done = check(tmp_path / "world.yaml")
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert f"world.yaml:{USES[use]}: " in line
    if "include" in use or "map" in use:
        assert what in line


def check(path: Path, most: int | None = None) -> subprocess.CompletedProcess[str]:
    """`troupe check`; with at most so many bytes of memory, in a process of its own."""
    if most is None:
        return started.troupe("check", path)

    def limited() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (most, most))

    return subprocess.run(
        [sys.executable, "-m", "troupe", "check", str(path)],
        env=environment(OPENBLAS_NUM_THREADS="1"), capture_output=True, text=True, check=False,
        timeout=LONGEST, preexec_fn=limited,
    )  # fmt: skip


def zeros(block: int, count: int) -> bytes:
    """So many blocks of so many zeros, as zlib compresses them; without making them."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    one = packer.compress(bytes(block)) + packer.flush(zlib.Z_FULL_FLUSH)
    check = (block * count % 65521) << 16 | 1
    return b"\x78\xda" + one * count + b"\x03\0" + pack(">I", check)


def png(width: int, height: int, data: bytes = zlib.compress(b"")) -> bytes:
    """A PNG with this header and compressed rows; without them it ends early."""
    parts = [(b"IHDR", pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))]
    parts += [(b"IDAT", data), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        pack(">I", len(data)) + kind + data + pack(">I", zlib.crc32(kind + data))
        for kind, data in parts
    )


def test_an_image_is_refused_by_its_header_before_anything_is_made_of_it(tmp_path: Path) -> None:
    """900 million pixels, all there, in a file of a megabyte: with them 2 GB would be needed."""
    assert zlib.decompress(zeros(100, 3)) == bytes(300)
    (tmp_path / "huge.png").write_bytes(png(30000, 30000, zeros(30 * 30001, 1000)))
    (tmp_path / "world.yaml").write_text("map: {file: huge.png, resolution: 0.1}")
    # Of the 3 GB address space the libraries take 2 before they begin.
    done = check(tmp_path / "world.yaml", most=3_000_000_000)
    assert done.returncode == 2
    assert done.stderr.endswith(
        "world.yaml:1:13: map.file: the map is too large (given: 30000 x 30000 pixels; "
        "allowed: at most 64000000 pixels)\n"
    )


@pytest.mark.parametrize("ending", [".png", ".jpg", ".pgm", ".ppm", ".pbm", ".bmp", ".gif",
                                    ".tif", ".webp"])  # fmt: skip
@pytest.mark.parametrize("size", [(1, 1), (53, 37), (300, 2)])
def test_the_size_in_a_header_is_that_of_the_image(ending: str, size: tuple[int, int]) -> None:
    shape = (size[1], size[0]) if ending in (".pgm", ".pbm") else (size[1], size[0], 3)
    good, data = cv2.imencode(ending, np.zeros(shape, np.uint8))
    assert good
    assert image_size(data.tobytes()) == size


@pytest.mark.parametrize("ending", [".png", ".jpg", ".pgm", ".bmp", ".tif", ".webp"])
def test_an_image_that_ends_early_is_refused_wherever_it_ends(tmp_path: Path, ending: str) -> None:
    rng = np.random.default_rng(1)
    whole = cv2.imencode(ending, rng.integers(0, 256, (40, 50), np.uint8))[1].tobytes()
    for size in (0, 1, 2, 8, 12, 16, 20, 24, 30, 60, len(whole) // 2):
        (tmp_path / f"cut{ending}").write_bytes(whole[:size])
        (told,) = mistakes_in(tmp_path, f"map: {{file: cut{ending}, resolution: 0.1}}")
        assert "1:13: map.file: the map is" in told


@pytest.mark.parametrize(
    "data",
    [b"P2\n65535 65535\n255\n0 0", b"P5\n0 0\n255\n", b"P2\n-3 2\n255\n1", b"P2 99999999999 1 1 1",
     b"P2\n" + b" " * 100_000, b"P2\n" + b"#\n" * 100_000, b"P7\nWIDTH 3\n", b"BM" + b"\xff" * 60,
     b"GIF89a", b"II*\0\xff\xff\xff\xff", b"RIFF\0\0\0\0WEBPVP8X", b"\xff\xd8" + b"\xff" * 1000,
     png(0, 0), png(2**31 - 1, 2**31 - 1), png(3, 2**31 - 1), png(2**32 - 1, 1), png(7000, 7000)],
    ids=range(17),
)  # fmt: skip
def test_a_header_that_lies_is_refused(tmp_path: Path, data: bytes) -> None:
    (tmp_path / "map.png").write_bytes(data)
    (told,) = mistakes_in(tmp_path, "map: {file: map.png, resolution: 0.1}")
    assert told.startswith("1:13: map.file: the map is")


@pytest.mark.parametrize("end", ["\n", "", " ", "\r\n", "\n# the end"])
def test_an_image_in_digits_may_end_in_its_last_one(tmp_path: Path, end: str) -> None:
    for name, text in {
        "grey.pgm": "P2\n# made by hand\n3 2\n255\n0 255 0\n255 0 200",
        "bits.pbm": "P1\n3 2\n101\n010",
        "colours.ppm": "P3\n3 2\n255\n0 0 0 255 255 255 0 0 0\n255 255 255 0 0 0 200 200 200",
    }.items():
        path = tmp_path / name
        path.write_bytes((text + end).encode())
        assert read_image_map(path).tolist() == [[True, False, True], [False, True, False]]


@pytest.mark.parametrize("channels", [(), (3,), (4,)])
def test_of_sixteen_bits_the_upper_ones_count(tmp_path: Path, channels: tuple[int, ...]) -> None:
    rng = np.random.default_rng(1)
    pixels = rng.integers(0, 65536, (20, 30, *channels), np.uint16)
    cv2.imwrite(str(tmp_path / "fine.png"), pixels)
    cv2.imwrite(str(tmp_path / "coarse.png"), (pixels >> 8).astype(np.uint8))
    fine, coarse = (read_image_map(tmp_path / name) for name in ("fine.png", "coarse.png"))
    assert np.array_equal(fine, coarse)
    assert 0 < fine.sum() < fine.size


def test_a_photograph_is_no_map(tmp_path: Path) -> None:
    """A million grains would be a million bodies."""
    rng = np.random.default_rng(1)
    cv2.imwrite(str(tmp_path / "dust.png"), rng.integers(0, 256, (2000, 2000), np.uint8))
    (told,) = mistakes_in(tmp_path, "map: {file: dust.png, resolution: 0.1}")
    assert told.startswith("1:13: map.file: the map's walls have more than 250000 edges")


def test_a_binary_text_map_is_told_in_a_few_lines(tmp_path: Path) -> None:
    (tmp_path / "map.txt").write_bytes(b"\0\x1b[31m" * 1_000_000)
    told = mistakes_in(tmp_path, "map: {file: map.txt, cell: 1}")
    assert len(told) == 20
    assert all("unknown character in the map" in one for one in told)
