"""A log's file as bytes: what is no log is refused, and a chunk's records are unpacked."""

from __future__ import annotations

import mmap
import stat
import struct
import zlib
from collections.abc import Mapping
from pathlib import Path

import zstandard
from mcap.exceptions import McapError
from mcap.opcode import Opcode

from sim.log.container import CHUNK, MAGIC
from sim.log.errors import LogError
from sim.log.writer import FORMAT, reason

DAMAGES = (
    McapError, struct.error, zstandard.ZstdError, zlib.error, ValueError, KeyError, IndexError,
    OverflowError, MemoryError, UnicodeDecodeError,
)  # fmt: skip
"""What comes of reading bytes that are not what they should be."""


def check_ours(path: Path, about: Mapping[str, str], library: str) -> None:
    """Raises LogError for a file of another program, or of a later version of ours.

    about: the texts of its metadata record `troupe`; library: what its header says wrote it.
    """
    if not about:
        raise LogError(
            f"{path}: this MCAP file was not written by Troupe but by "
            f"{library or 'another program'}: Foxglove, Lichtblick and Rerun open such files"
        )
    found = about.get("format", "")
    if not found.isdecimal() or int(found) > FORMAT:
        raise LogError(
            f"{path}: the log is of a later version of Troupe "
            f"({about.get('version', 'unknown')}; its format is {found or 'unknown'}, "
            f"this version reads {FORMAT}): read it with that version"
        )


NO_LOG = "is no log of a run: name a file that `troupe run --log FILE.mcap` wrote"


def mapped(path: Path) -> mmap.mmap:
    """A file's bytes; LogError for what cannot be read or is no MCAP file."""
    try:
        found = path.stat()
        if not stat.S_ISREG(found.st_mode):  # to open a pipe would wait for who writes into it
            what = "a folder" if stat.S_ISDIR(found.st_mode) else "not a file with an end"
            raise LogError(f"{path}: it is {what}, so it {NO_LOG}")
        if not found.st_size:
            raise LogError(f"{path}: the file is empty, so it {NO_LOG}")
        with path.open("rb") as file:
            if file.read(len(MAGIC)) != MAGIC:
                raise LogError(f"{path}: is not an MCAP file, so it {NO_LOG}")
            return mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
    except OSError as error:
        raise LogError(f"{path}: cannot be read: {reason(error)}") from None
    except ValueError as error:
        if isinstance(error, LogError):
            raise
        raise LogError(f"{path}: cannot be read: {error}") from None


MOST_UNPACKED = 1 << 31
"""Bytes: a chunk that claims more is not one of ours."""


def unpack(data: memoryview, at: int) -> bytes:
    """The records of the chunk at an offset; ValueError for what is not whole."""
    opcode, length, _, _, size, crc = CHUNK.unpack_from(data, at)
    end = at + 9 + length
    if opcode != Opcode.CHUNK or end > len(data) or size > MOST_UNPACKED:
        raise ValueError("a chunk is not where it should be")
    body = data[at + CHUNK.size : end]
    (name,) = struct.unpack_from("<I", body)
    kind = bytes(body[4 : 4 + name])
    (packed,) = struct.unpack_from("<Q", body, 4 + name)
    content = body[12 + name : 12 + name + packed]
    if kind == b"zstd":
        found = zstandard.ZstdDecompressor().decompress(content, max_output_size=size)
    elif kind == b"":
        found = bytes(content)
    else:
        raise ValueError(f"a chunk is packed in a way that Troupe never uses: {kind!r:.20}")
    if len(found) != size or (crc and zlib.crc32(found) != crc):
        raise ValueError("a chunk's checksum is wrong")
    return found
