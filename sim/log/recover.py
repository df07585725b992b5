"""Makes a whole log of one that was cut off: what is in it, with the index that readers need."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from mcap import records as mcap
from mcap.opcode import Opcode
from numpy.typing import NDArray

from sim.log.container import CHUNK_HEAD, MAGIC, LogFile
from sim.log.errors import LogError
from sim.log.page import PREFIX, message_indexes
from sim.log.source import DAMAGES, RECORD, Source, check_ours, parsed, unpack
from sim.log.writer import check_place, reason

COPIED = (Opcode.HEADER, Opcode.CHUNK, Opcode.ATTACHMENT, Opcode.METADATA)
"""Records that are taken over; indexes are made anew."""


@dataclass(frozen=True)
class Recovered:
    """What was saved: messages, up to which simulated time (s), and bytes that were of no use."""

    messages: int
    until: float
    lost: int


def recover(source: Path, target: Path) -> Recovered:
    """Write what can be read of a log to a new file. Raises LogError where nothing can be."""
    if target.exists():
        raise LogError(f"{target}: there is such a file already: name another with -o")
    check_place(target)
    data = Source(source)
    out: LogFile | None = None
    lost, at = 0, len(MAGIC)
    known: set[tuple[str, int]] = set()
    ours, library = False, ""
    try:
        while at + RECORD.size <= data.size:
            opcode, size = RECORD.unpack(data.read(at, RECORD.size))
            end = at + RECORD.size + size
            if end > data.size or opcode in (Opcode.DATA_END, Opcode.FOOTER, 0):
                break
            if opcode not in COPIED:
                at = end
                continue
            body = memoryview(data.read(at + RECORD.size, size))
            if opcode == Opcode.HEADER:
                library = parsed(mcap.Header, body).library
                out = LogFile(target, library)
                out.begin()
            elif out is None:
                break
            elif opcode == Opcode.CHUNK:
                if not ours:
                    break
                try:
                    copy_chunk(out, body, known)
                except DAMAGES:
                    lost += end - at
            elif opcode == Opcode.ATTACHMENT:
                try:
                    one = parsed(mcap.Attachment, body)
                    out.attach(one.name, one.media_type, one.data)
                except DAMAGES:
                    lost += end - at
            elif opcode == Opcode.METADATA:
                note = parsed(mcap.Metadata, body)
                if note.name == "troupe":
                    check_ours(source, note.metadata, library)
                    ours = True
                out.note(note.name, note.metadata)
            at = end
        if out is not None and not ours:
            check_ours(source, {}, library)
        if out is None or not out.tail.chunks:
            raise LogError(
                f"{source}: there is nothing in it that could be saved: run the world again"
            )
        out.finish()
    except LogError:
        target.unlink(missing_ok=True)
        raise
    except OSError as error:
        target.unlink(missing_ok=True)
        raise LogError(f"{target}: cannot be written: {reason(error)}") from None
    except DAMAGES as error:
        target.unlink(missing_ok=True)
        raise LogError(f"{source}: nothing could be saved of it ({error})") from None
    finally:
        if out is not None:
            out.close()
    return Recovered(int(out.tail.counts.sum()), out.tail.last / 1e9, lost)


def copy_chunk(out: LogFile, body: memoryview, known: set[tuple[str, int]]) -> None:
    """Copy a chunk as it is, with a new index; its schemas and channels go to the summary."""
    _, _, size, _ = CHUNK_HEAD.unpack_from(body)
    channels, times, offsets = messages(unpack(body), out, known)
    if not len(times):
        return
    indexes = message_indexes(channels, times, offsets)
    begin = out.append(RECORD.pack(Opcode.CHUNK, len(body)), body, indexes.records.data)
    packed = len(body) - CHUNK_HEAD.size - 16
    out.tail.chunk(indexes, begin, RECORD.size + len(body), packed, size)


def messages(
    records: bytes, out: LogFile, known: set[tuple[str, int]]
) -> tuple[NDArray[np.uint16], NDArray[np.uint64], NDArray[np.uint64]]:
    """Channels, times and offsets of a chunk's messages; tells `out` of what else is in it."""
    channels, times = [np.zeros(0, np.uint16)], [np.zeros(0, np.uint64)]
    offsets = [np.zeros(0, np.uint64)]
    view, at = memoryview(records), 0
    while at + RECORD.size <= len(records):
        opcode, size = RECORD.unpack_from(records, at)
        end = at + RECORD.size + size
        if end > len(records):
            raise ValueError("a record is longer than its chunk")
        if opcode == Opcode.MESSAGE:
            step = end - at
            count = alike(view[at:], step)
            end = at + count * step
            prefixes = np.ndarray((count,), PREFIX, records, at, (step,))
            channels.append(prefixes["channel"])
            times.append(prefixes["log_time"])
            offsets.append(np.arange(at, end, step).astype(np.uint64))
        elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
            kind: Any = mcap.Schema if opcode == Opcode.SCHEMA else mcap.Channel
            one = parsed(kind, view[at + RECORD.size : end])
            group = out.tail.schemas if opcode == Opcode.SCHEMA else out.tail.channels
            if (kind.__name__, one.id) not in known:
                known.add((kind.__name__, one.id))
                group.append(one)
        at = end
    return np.concatenate(channels), np.concatenate(times), np.concatenate(offsets)


def alike(records: memoryview, step: int) -> int:
    """How many records of `step` bytes and one kind follow each other at the beginning of some."""
    count, look = 1, 8
    while look and (count + look) * step <= len(records):
        part = np.frombuffer(records[count * step : (count + look) * step], np.uint8)
        same = part.reshape(look, step)[:, : RECORD.size] == np.frombuffer(
            records[: RECORD.size], np.uint8
        )
        others = np.flatnonzero(~same.all(axis=1))
        if len(others):
            return count + int(others[0])
        count, look = count + look, 2 * look
    return count
