"""A log's file as bytes: what is no log is refused, and a chunk's records are unpacked."""

from __future__ import annotations

import io
import os
import stat
import struct
import weakref
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import zstandard
from mcap import records as mcap
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError

from sim.log.container import CHUNK_HEAD, MAGIC
from sim.log.errors import LogError
from sim.log.writer import FORMAT, reason

DAMAGES = (
    McapError, struct.error, zstandard.ZstdError, zlib.error, ValueError, KeyError, IndexError,
    OverflowError, MemoryError, UnicodeDecodeError,
)  # fmt: skip
"""What comes of reading bytes that are not what they should be."""


RECORD = struct.Struct("<BQ")
"""A record begins with its opcode and the size of its content."""


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


class Source:
    """A log's file, of which parts are read; raises LogError for what is none.

    A mapping of the file would do as well, were it not that small parts of it have a disk fetch all
    that lies around them, and that a file which somebody cuts meanwhile ends the program.
    """

    def __init__(self, path: Path) -> None:
        try:
            found = path.stat()
            if not stat.S_ISREG(found.st_mode):  # to open a pipe would wait for who writes into it
                what = "a folder" if stat.S_ISDIR(found.st_mode) else "not a file with an end"
                raise LogError(f"{path}: it is {what}, so it {NO_LOG}")
            if not found.st_size:
                raise LogError(f"{path}: the file is empty, so it {NO_LOG}")
            self._descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
        except OSError as error:
            raise LogError(f"{path}: cannot be read: {reason(error)}") from None
        weakref.finalize(self, os.close, self._descriptor)
        self.size = os.fstat(self._descriptor).st_size
        if os.pread(self._descriptor, len(MAGIC), 0) != MAGIC:
            raise LogError(f"{path}: is not an MCAP file, so it {NO_LOG}")

    def read(self, at: int, size: int) -> bytes:
        """So many bytes from an offset on; ValueError where there are not so many."""
        parts = []
        while size > 0 and 0 <= at < self.size:
            part = os.pread(self._descriptor, size, at)
            if not part:
                break
            parts.append(part)
            at, size = at + len(part), size - len(part)
        if size:
            raise ValueError("the file ends too early")
        return parts[0] if len(parts) == 1 else b"".join(parts)

    def record(self, at: int, opcode: int) -> bytes:
        """The content of the record of a kind at an offset."""
        found, size = RECORD.unpack(self.read(at, RECORD.size))
        if found != opcode or size > self.size:
            raise ValueError("a record is not where it should be")
        return self.read(at + RECORD.size, size)


MOST_UNPACKED = 1 << 31
"""Bytes: a chunk that claims more is not one of ours."""


def unpack(data: bytes | memoryview) -> bytes:
    """The records of a Chunk record's content; ValueError for what is not whole."""
    _, _, size, crc = CHUNK_HEAD.unpack_from(data)
    if size > MOST_UNPACKED:
        raise ValueError("a chunk is larger than any of ours")
    body = memoryview(data)[CHUNK_HEAD.size :]
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


def each_record(data: bytes) -> Iterator[tuple[int, memoryview]]:
    """Opcodes and contents of records that follow each other."""
    view, at = memoryview(data), 0
    while at + RECORD.size <= len(data):
        opcode, size = RECORD.unpack_from(data, at)
        at += RECORD.size
        if at + size > len(data):
            raise ValueError("a record is longer than the file")
        yield opcode, view[at : at + size]
        at += size


def parsed(kind: Any, record: memoryview) -> Any:
    """A record's content, as the library `mcap` reads it; ValueError for a damaged attachment."""
    if kind is mcap.Attachment:
        (crc,) = struct.unpack("<I", record[-4:])
        if crc and zlib.crc32(record[:-4]) != crc:
            raise ValueError("the checksum of an attachment is wrong")
    return kind.read(ReadDataStream(io.BytesIO(record)))
