"""Reads a log: its index at once, chunks when they are asked for, many messages in one array."""

from __future__ import annotations

import struct
import zlib
from collections import OrderedDict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from mcap import records as mcap
from mcap.opcode import Opcode
from numpy.typing import NDArray

from sim.log.cdr import decode
from sim.log.container import MAGIC
from sim.log.errors import LogError
from sim.log.page import ENTRY, PLACE, PREFIX
from sim.log.source import DAMAGES, Source, check_ours, each_record, parsed, unpack

FOOT = struct.Struct("<BQQQI")
INDEX_HEAD = struct.Struct("<HI")
"""How a MessageIndex record begins: channel, bytes of its entries."""
KEPT = 4
"""Unpacked chunks that are kept."""


class ChunkPlace(NamedTuple):
    """A chunk in the file: from when to when (ns), where it lies, where its indexes are."""

    start: int
    end: int
    at: int
    places: NDArray[Any]


@dataclass(frozen=True)
class Run:
    """Messages of one size: log times (k,) in ns, and data (k, size) with CDR's head."""

    times: NDArray[np.uint64]
    messages: NDArray[np.uint8]


class LogReader:
    """An open log. Raises LogError for what is no log, is cut, or is of a later version."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.topics: dict[str, tuple[int, str]] = {}
        """By topic: its channel, and its type such as `troupe_msgs/State`."""
        self.counts: dict[int, int] = {}
        self.chunks: list[ChunkPlace] = []
        self.header: mcap.Header | None = None
        self._attachments: dict[str, mcap.AttachmentIndex] = {}
        self._metadata: dict[str, mcap.MetadataIndex] = {}
        self._unpacked: OrderedDict[int, bytes] = OrderedDict()
        self._source = Source(path)
        try:
            self._read_summary()
        except LogError:
            raise
        except DAMAGES as error:
            raise self.damaged(error) from None
        self.about = self.metadata("troupe")
        check_ours(path, self.about, self.header.library if self.header else "")

    @property
    def size(self) -> int:
        """Bytes of the file."""
        return self._source.size

    def damaged(self, error: Exception | str) -> LogError:
        """What is said of a file that is broken inside."""
        if isinstance(error, LogError):
            return error
        return LogError(
            f"{self.path}: the log is damaged ({error}): "
            f"`troupe log recover` saves what can be read of it"
        )

    def _read_summary(self) -> None:
        read = self._source.read
        end = self._source.size - len(MAGIC)
        if end < len(MAGIC) + FOOT.size or read(end, len(MAGIC)) != MAGIC:
            raise LogError(
                f"{self.path}: the log was cut off before its end: "
                "`troupe log recover` makes a whole one of it"
            )
        self.header = self._record(len(MAGIC), Opcode.HEADER, mcap.Header)
        foot = read(end - FOOT.size, FOOT.size)
        opcode, length, start, _, crc = FOOT.unpack(foot)
        if opcode != Opcode.FOOTER or length != 20 or not 0 < start < end:
            raise LogError(
                f"{self.path}: the log has no summary: `troupe log recover` makes it anew"
            )
        data = read(start, end - FOOT.size - start)
        if crc and zlib.crc32(foot[:-4], zlib.crc32(data)) != crc:
            raise ValueError("the checksum of its summary is wrong")
        schemas: dict[int, str] = {}
        for opcode, record in each_record(data):
            if opcode == Opcode.CHUNK_INDEX:
                self.chunks.append(chunk_place(record))
            elif opcode == Opcode.SCHEMA:
                one = parsed(mcap.Schema, record)
                schemas[one.id] = one.name.replace("/msg/", "/")
            elif opcode == Opcode.CHANNEL:
                topic = parsed(mcap.Channel, record)
                self.topics[topic.topic] = topic.id, schemas.get(topic.schema_id, "")
            elif opcode == Opcode.STATISTICS:
                self.counts = parsed(mcap.Statistics, record).channel_message_counts
            elif opcode == Opcode.ATTACHMENT_INDEX:
                found = parsed(mcap.AttachmentIndex, record)
                self._attachments[found.name] = found
            elif opcode == Opcode.METADATA_INDEX:
                note = parsed(mcap.MetadataIndex, record)
                self._metadata[note.name] = note
        self.chunks.sort(key=lambda chunk: (chunk.start, chunk.at))

    def _record(self, at: int, opcode: int, kind: Any) -> Any:
        return parsed(kind, memoryview(self._source.record(at, opcode)))

    # --- what is beside the messages

    def whole(self, name: str) -> int:
        """A number that the log tells of its run, such as its seed."""
        try:
            return int(self.about[name])
        except (KeyError, ValueError):
            raise self.damaged(f"its {name} cannot be read") from None

    def number(self, name: str) -> float:
        """Likewise a number that need not be whole; above 0."""
        try:
            found = float(self.about[name])
        except (KeyError, ValueError):
            found = 0.0
        if not 0.0 < found < float("inf"):
            raise self.damaged(f"its {name} cannot be read")
        return found

    def metadata(self, name: str) -> dict[str, str]:
        """The texts of a metadata record; none where there is no such record."""
        place = self._metadata.get(name)
        if place is None:
            return {}
        try:
            found: dict[str, str] = self._record(
                place.offset, Opcode.METADATA, mcap.Metadata
            ).metadata
        except DAMAGES as error:
            raise self.damaged(error) from None
        return found

    def attachments(self) -> dict[str, bytes]:
        """All attachments by name."""
        return {name: self.attachment(name) or b"" for name in self._attachments}

    def attachment(self, name: str) -> bytes | None:
        """The content of an attachment; None where there is none of that name."""
        place = self._attachments.get(name)
        if place is None:
            return None
        try:
            found: bytes = self._record(place.offset, Opcode.ATTACHMENT, mcap.Attachment).data
        except DAMAGES as error:
            raise self.damaged(error) from None
        return found

    # --- messages

    def count(self, topic: str) -> int:
        """Messages on a topic."""
        return self.counts.get(self.topics[topic][0], 0) if topic in self.topics else 0

    def entries(self, topic: str) -> list[tuple[ChunkPlace, NDArray[Any]]]:
        """By chunk, the times and offsets (ENTRY) of a topic's messages; nothing is unpacked."""
        if topic not in self.topics:
            return []
        return [(chunk, self._entries(chunk, self.topics[topic][0])) for chunk in self.chunks]

    def runs(self, topic: str, start: int | None = None, end: int | None = None) -> Iterator[Run]:
        """A topic's messages with start <= log time < end (ns), in order, those alike together."""
        if topic not in self.topics:
            return
        for chunk in self.chunks:
            if (start is not None and chunk.end < start) or (
                end is not None and chunk.start >= end
            ):
                continue
            yield from self.runs_of(chunk, topic, start, end)

    def runs_of(
        self, chunk: ChunkPlace, topic: str, start: int | None = None, end: int | None = None
    ) -> Iterator[Run]:
        """The same of one chunk."""
        try:
            yield from self._runs(chunk, self.topics[topic][0], start, end)
        except DAMAGES as error:
            raise self.damaged(error) from None

    def messages(
        self, topic: str, start: int | None = None, end: int | None = None
    ) -> Iterator[tuple[int, dict[str, Any]]]:
        """Log times (ns) and decoded messages of a topic, one by one."""
        if topic not in self.topics:
            return
        kind = self.topics[topic][1]
        for run in self.runs(topic, start, end):
            for time, data in zip(run.times.tolist(), run.messages, strict=True):
                try:
                    yield time, decode(kind, data.tobytes())
                except DAMAGES as error:
                    raise self.damaged(error) from None

    def _entries(self, chunk: ChunkPlace, channel: int) -> NDArray[Any]:
        which = np.flatnonzero(chunk.places["channel"] == channel)
        if not len(which):
            return np.zeros(0, ENTRY)
        at = int(chunk.places["offset"][which[0]])
        try:
            data = self._source.record(at, Opcode.MESSAGE_INDEX)
            found, size = INDEX_HEAD.unpack_from(data)
            if found != channel or size != len(data) - INDEX_HEAD.size:
                raise ValueError("an index is not where it should be")
        except DAMAGES as error:
            raise self.damaged(error) from None
        return np.frombuffer(data, ENTRY, offset=INDEX_HEAD.size)

    def _runs(
        self, chunk: ChunkPlace, channel: int, start: int | None, end: int | None
    ) -> Iterator[Run]:
        entries = self._entries(chunk, channel)
        if start is not None:
            entries = entries[entries["time"] >= start]
        if end is not None:
            entries = entries[entries["time"] < end]
        if not len(entries):
            return
        data = np.frombuffer(self.unpacked(chunk), np.uint8)
        offsets = entries["offset"].astype(np.int64)
        if offsets.max() + PREFIX.itemsize > len(data):
            raise ValueError("an index points outside of its chunk")
        prefixes = data[offsets[:, None] + np.arange(9)]
        sizes = np.ascontiguousarray(prefixes[:, 1:]).view("<u8")[:, 0].astype(np.int64) - 22
        if sizes.min() < 4 or (offsets + PREFIX.itemsize + sizes).max() > len(data):
            raise ValueError("a message is longer than its chunk")
        breaks = np.flatnonzero(np.diff(sizes)) + 1
        for which in np.split(np.arange(len(sizes)), breaks):
            places = offsets[which] + PREFIX.itemsize
            size = int(sizes[which[0]])
            step = int(places[1] - places[0]) if len(places) > 1 else size
            if step >= size and (np.diff(places) == step).all():
                rows = np.lib.stride_tricks.as_strided(
                    data[places[0] :], (len(places), size), (step, 1), writeable=False
                )
            else:
                rows = data[places[:, None] + np.arange(size)]
            yield Run(entries["time"][which], rows)

    def unpacked(self, chunk: ChunkPlace) -> bytes:
        """A chunk's records."""
        if chunk.at in self._unpacked:
            self._unpacked.move_to_end(chunk.at)
            return self._unpacked[chunk.at]
        data = unpack(self._source.record(chunk.at, Opcode.CHUNK))
        self._unpacked[chunk.at] = data
        if len(self._unpacked) > KEPT:
            self._unpacked.popitem(last=False)
        return data


def chunk_place(record: memoryview) -> ChunkPlace:
    """A ChunkIndex record."""
    start, end, place, _, length = struct.unpack_from("<QQQQI", record)
    if 36 + length > len(record):
        raise ValueError("a chunk's index is longer than its record")
    return ChunkPlace(start, end, place, np.frombuffer(record[36 : 36 + length], PLACE))
