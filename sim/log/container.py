"""The MCAP file itself: header, attachments, chunks with their indexes, the summary at the end."""

from __future__ import annotations

import io
import os
import struct
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import zstandard
from mcap import records as mcap
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from numpy.typing import NDArray

from sim.log.definitions import whole
from sim.log.page import Indexes, Page, message_indexes

MAGIC = b"\x89MCAP0\r\n"
CHUNK_HEAD = struct.Struct("<QQQI")
"""How a Chunk record begins: first and last time (ns), bytes of its records, their CRC32."""
LEVEL = 1
"""Of zstd; higher ones cost more than they save (a hundredth at 3)."""
TABLE = 12
"""Bits of zstd's table of what it has seen: one of 16 KiB stays in a core's nearest memory, which
makes it a tenth faster than its own choice of 64."""
STRIDE = 2
"""How much sooner than by itself zstd leaves alone what does not compress, where that is asked for:
readings, which are floats that nothing foretells, take a tenth more room and half of the time."""
NO_CRC = 0


class Vanished(OSError):
    """The file has been removed while it was written."""


@dataclass
class Channels:
    """Topics with their types, numbered from 1 as they come."""

    schemas: dict[str, int] = field(default_factory=dict)
    topics: dict[str, tuple[int, str]] = field(default_factory=dict)
    new: list[mcap.McapRecord] = field(default_factory=list)
    """Records that no chunk holds yet."""

    def channel(self, topic: str, kind: str) -> int:
        """The number of a topic, whose messages are of a type."""
        known = self.topics.get(topic)
        if known is not None:
            return known[0]
        if kind not in self.schemas:
            self.schemas[kind] = len(self.schemas) + 1
            self.new.append(schema(self.schemas[kind], kind))
        number = len(self.topics) + 1
        self.topics[topic] = number, kind
        self.new.append(channel(number, topic, self.schemas[kind]))
        return number


def schema(number: int, kind: str) -> mcap.Schema:
    """A type such as `troupe_msgs/State` under ROS 2's name of it."""
    package, _, name = kind.partition("/")
    return mcap.Schema(number, whole(kind).encode(), "ros2msg", f"{package}/msg/{name}")


def channel(number: int, topic: str, schema: int) -> mcap.Channel:
    return mcap.Channel(number, topic, "cdr", {}, schema)


@dataclass
class Tail:
    """What the summary at a file's end says of what stands before it."""

    schemas: list[mcap.McapRecord] = field(default_factory=list)
    channels: list[mcap.McapRecord] = field(default_factory=list)
    chunks: list[bytes] = field(default_factory=list)
    attachments: list[mcap.McapRecord] = field(default_factory=list)
    metadata: list[mcap.McapRecord] = field(default_factory=list)
    counts: NDArray[np.int64] = field(default_factory=lambda: np.zeros(64, np.int64))
    """Messages by channel."""
    first: int | None = None  # ns
    last: int = 0

    def chunk(self, indexes: Indexes, at: int, length: int, packed: int, size: int) -> None:
        """Note a chunk of `length` bytes at an offset, its indexes behind it.

        packed, size: bytes of its records.
        """
        start, end = indexes.start, indexes.end
        places = indexes.places.copy()
        places["offset"] += at + length
        body = (
            struct.pack("<QQQQI", start, end, at, length, places.nbytes)
            + places.tobytes()
            + struct.pack("<QI4sQQ", len(indexes.records), 4, b"zstd", packed, size)
        )
        self.chunks.append(struct.pack("<BQ", Opcode.CHUNK_INDEX, len(body)) + body)
        most = int(places["channel"].max()) + 1
        if most > len(self.counts):
            more = np.zeros(max(most, 2 * len(self.counts)) - len(self.counts), np.int64)
            self.counts = np.concatenate([self.counts, more])
        self.counts[places["channel"]] += indexes.counts
        self.first = start if self.first is None else min(start, self.first)
        self.last = max(end, self.last)

    def bytes(self, at: int) -> bytes:
        """The end of a file from offset `at` on: DataEnd, summary, footer, magic."""
        out = RecordBuilder()
        mcap.DataEnd(0).write(out)
        ended: bytes = out.end()  # type: ignore[no-untyped-call]
        start = at + len(ended)
        body, offsets = io.BytesIO(), RecordBuilder()
        statistics = mcap.Statistics(
            attachment_count=len(self.attachments),
            channel_count=len(self.channels),
            channel_message_counts={
                number: count for number, count in enumerate(self.counts.tolist()) if count
            },
            chunk_count=len(self.chunks),
            message_count=int(self.counts.sum()),
            message_end_time=self.last,
            message_start_time=self.first or 0,
            metadata_count=len(self.metadata),
            schema_count=len(self.schemas),
        )
        groups: Sequence[tuple[Opcode, Sequence[mcap.McapRecord | bytes]]] = (
            (Opcode.SCHEMA, self.schemas),
            (Opcode.CHANNEL, self.channels),
            (Opcode.STATISTICS, [statistics]),
            (Opcode.CHUNK_INDEX, self.chunks),
            (Opcode.ATTACHMENT_INDEX, self.attachments),
            (Opcode.METADATA_INDEX, self.metadata),
        )
        for opcode, group in groups:
            begin = body.tell()
            for record in group:
                body.write(record if isinstance(record, bytes) else written(record))
            if group:
                place = mcap.SummaryOffset(opcode, start + begin, body.tell() - begin)
                place.write(offsets)
        summary = body.getvalue()
        table: bytes = offsets.end()  # type: ignore[no-untyped-call]
        foot = struct.pack("<BQQQ", Opcode.FOOTER, 20, start, start + len(summary))
        crc = zlib.crc32(summary + table + foot)
        return ended + summary + table + foot + struct.pack("<I", crc) + MAGIC


def written(record: mcap.McapRecord) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    data: bytes = builder.end()  # type: ignore[no-untyped-call]
    return data


def compressor(stride: int) -> zstandard.ZstdCompressor:
    """With zstd's own checksum: CRC32 takes longer than to compress what compresses well."""
    parameters = zstandard.ZstdCompressionParameters.from_level(
        LEVEL, hash_log=TABLE, target_length=stride, write_checksum=True
    )
    return zstandard.ZstdCompressor(compression_params=parameters)


class LogFile:
    """A file that is being written. Whatever call it dies in, all that it has written stands.

    Until it has begun, with its first chunk, what stood in the file before stands there.
    """

    def __init__(self, path: Path, library: str) -> None:
        self.path = path
        self.was_there = path.exists()
        self.descriptor = os.open(path, os.O_WRONLY | os.O_CREAT, 0o666)
        self.at = 0
        self.begun = False
        self.beginning = bytearray()
        """What is written first."""
        self.tail = Tail()
        self.channels = Channels()
        self.dense, self.swift = compressor(0), compressor(STRIDE)
        self.append(MAGIC + written(mcap.Header("ros2", library)))

    def append(self, *parts: bytes | memoryview) -> int:
        """Write at the end, all or nothing; where it begins. Raises OSError."""
        start = self.at
        if self.begun:
            self._write(start, *parts)
        else:
            for part in parts:
                self.beginning += part
        self.at += sum(map(len, parts))
        return start

    def begin(self) -> None:
        """Write in the place of what stood in the file from now on. Raises OSError."""
        if not self.begun:
            os.ftruncate(self.descriptor, 0)
            self._write(0, self.beginning)
            self.begun = True

    def _write(self, start: int, *parts: bytes | bytearray | memoryview) -> None:
        """Write at the file's end, which is at `start`; what cannot be written whole is not."""
        try:
            for part in parts:
                view = memoryview(part)
                while view:
                    view = view[os.write(self.descriptor, view) :]
        except OSError:
            os.ftruncate(self.descriptor, start)
            os.lseek(self.descriptor, start, os.SEEK_SET)
            raise

    def attach(self, name: str, kind: str, data: bytes) -> None:
        """Write an attachment, such as the world."""
        record = written(mcap.Attachment(0, 0, name, kind, data))
        start = self.append(record)
        self.tail.attachments.append(
            mcap.AttachmentIndex(start, len(record), 0, 0, len(data), name, kind)
        )

    def note(self, name: str, values: Mapping[str, str]) -> None:
        """Write a metadata record."""
        record = written(mcap.Metadata(name, dict(values)))
        start = self.append(record)
        self.tail.metadata.append(mcap.MetadataIndex(start, len(record), name))

    def declare(self, page: Page) -> None:
        """Add to a page what no page has told of topics yet: it stands before their messages."""
        for record in self.channels.new:
            page.record(written(record))
            kind = self.tail.schemas if isinstance(record, mcap.Schema) else self.tail.channels
            kind.append(record)
        self.channels.new.clear()

    def chunk(self, page: Page, *, swift: bool = False) -> None:
        """Write the messages of a page as one chunk with its indexes, at once, and empty it.

        swift: in less time, and more room.
        """
        if not page.count:
            return
        self.begin()
        notes = page.notes[: page.count]
        indexes = message_indexes(notes["channel"], notes["time"], notes["offset"])
        data = page.memory[: page.size].data
        packed = (self.swift if swift else self.dense).compress(data)
        prefix = (
            CHUNK_HEAD.pack(indexes.start, indexes.end, page.size, NO_CRC)
            + b"\x04\0\0\0zstd"
            + struct.pack("<Q", len(packed))
        )
        length = len(prefix) + len(packed)
        prefix = struct.pack("<BQ", Opcode.CHUNK, length) + prefix
        at = self.append(prefix, packed, indexes.records.data)
        self.tail.chunk(indexes, at, 9 + length, len(packed), page.size)
        page.clear()

    def check_there(self) -> None:
        """Raises Vanished if the file has been removed: what is written goes nowhere."""
        try:
            same = os.path.samestat(os.stat(self.path), os.fstat(self.descriptor))
        except FileNotFoundError:
            same = False
        if not same:
            raise Vanished("the file has been removed")

    def finish(self) -> None:
        """Write the summary; the file is whole. Raises OSError."""
        self.begin()
        self.append(self.tail.bytes(self.at))

    def close(self) -> None:
        """Close the file. One that has not begun is as it was before, or gone if there was none."""
        os.close(self.descriptor)
        if not (self.begun or self.was_there):
            self.path.unlink(missing_ok=True)
