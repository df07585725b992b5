"""The log while it is written: the run notes its ticks, a thread makes a file of them."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sim.log.container import LogFile
from sim.log.errors import LogError
from sim.log.floor import FloorMirror
from sim.log.moment import Event, Floor, Painted, Touched
from sim.log.page import Page
from sim.log.stretches import stretch
from sim.log.tape import Sheet, Tape
from sim.log.tick_messages import TickMessages
from sim.video.errors import VideoError
from sim.video.target import check_target

FORMAT = 2
"""Of what a log holds: a reader refuses later ones. 1 had a message of commands for each tick."""
WAIT = 0.4
"""Wall-clock seconds in which ticks are gathered for a chunk: with the time that it takes to
write one, everything that is older than a second is in the file."""
CHUNK_BYTES = 1 << 24
"""What a chunk holds, roughly and before it is compressed: a reader that seeks unpacks one."""
MOST_WAITING = 1 << 28
"""Bytes that may wait to be written; then the run waits too."""
FIRST_TAPE, TAPE, ROWS = 1 << 16, 1 << 20, 8
"""Bytes of the first tape of a sheet, and of the next ones; for how many rows one has room, where
these are not longer than a chunk."""

ENDING = ".mcap"
NO_MEMORY = np.empty(0, np.uint8)

Item = Tape | Event | Floor | Painted | Touched


def check_place(path: Path) -> None:
    """Raises LogError where no log can be written; nothing is written yet."""
    if path.suffix.lower() != ENDING:
        raise LogError(f"{path}: a log is an MCAP file: name it *{ENDING}")
    try:
        check_target(path, endings=(ENDING,), what="log")
    except VideoError as error:
        raise LogError(str(error)) from None


class LogWriter:
    """Writes a log on a thread of its own. The run's thread alone calls `put` and `tape`.

    After an error (a full disk) nothing more is written, and `error` says why; the run may go on.
    """

    def __init__(
        self, path: Path, library: str, about: Mapping[str, str], *, with_twists: bool = False
    ) -> None:
        """Opens the file; raises LogError where that cannot be. `about`: what ran, as texts."""
        try:
            self.file = LogFile(path, library)
            self.file.note("troupe", {"format": str(FORMAT), **about})
        except OSError as error:
            raise LogError(f"{path}: the log cannot be written: {reason(error)}") from None
        self.path = path
        self.messages = TickMessages(self.file, with_twists=with_twists)
        self.page, self.sensed = Page(), Page()
        self.error: str | None = None
        self.lost_from: float | None = None
        self.written = 0.0  # simulated seconds up to which all is in the file
        self._items: deque[tuple[Item, int]] = deque()
        self._tape: Tape | None = None  # which may still be written to
        self._done = 0  # bytes of it that are in the file
        self._last = 0  # ns of the last row
        self._free: deque[NDArray[np.uint8]] = deque()  # the memory of tapes that are in the file
        self._noting = 0  # bytes of the tape that the run writes to
        self._size = 0  # bytes that wait
        self._closing = False
        self._full = threading.Event()
        self._room = threading.Condition()
        self._failed: OSError | None = None
        self._thread = threading.Thread(target=self._work, name="troupe log", daemon=True)
        self._thread.start()

    def attach(self, name: str, kind: str, data: bytes) -> None:
        """Write an attachment, before the first `put` or after `stop`."""
        try:
            self.file.attach(name, kind, data)
        except OSError as error:
            self._fail(error)

    def put(self, item: Item, size: int = 0) -> None:
        """Hand over something to be written, which takes `size` bytes while it waits."""
        self._items.append((item, size))
        if size:
            self._wait_for_room(size)

    def tape(self, sheet: Sheet, before: Tape | None = None) -> Tape:
        """A tape for rows of a sheet from now on, in the place of the one before, if it is full."""
        row = Tape(sheet, NO_MEMORY).need()
        size = max(FIRST_TAPE if before is None else TAPE, row, min(row * ROWS, CHUNK_BYTES))
        found = None
        while found is None and self._free:
            memory = self._free.popleft()
            found = memory if size <= len(memory) <= 2 * size else None
        tape = Tape(sheet, np.empty(size, np.uint8) if found is None else found)
        # the one before is complete and waits from now on
        self.put(tape, self._noting)
        self._noting = tape.room
        return tape

    def _wait_for_room(self, size: int) -> None:
        with self._room:
            self._size += size
            if self._size > CHUNK_BYTES:
                self._full.set()
            self._room.wait_for(lambda: self._size <= MOST_WAITING or self.error is not None)

    def stop(self) -> None:
        """Write all that waits, and end the thread."""
        self._closing = True
        self._full.set()
        self._thread.join()

    def drop(self) -> None:
        """End the thread, and close the file as it stands: no run has come of it."""
        self.stop()
        self.file.close()

    def close(self, attachments: Mapping[str, bytes]) -> None:
        """Write what waits, the attachments (JSON, by name) and the summary; close the file."""
        self.stop()
        if self._failed is None:
            for name, data in attachments.items():
                self.attach(name, "application/json", data)
        try:
            self.file.finish()
        except OSError as error:
            self._fail(error)
        self.file.close()

    def _work(self) -> None:
        while not self._closing:
            self._full.wait(WAIT)
            self._full.clear()
            self.drain()
        self.drain()

    def drain(self) -> None:
        """Write all that waits."""
        items: list[tuple[Item, int]] = []
        while self._items:
            items.append(self._items.popleft())
        try:
            if self._failed is None and (items or self._unwritten):
                self.file.check_there()
                for item, size in items:
                    self._take(item)
                    self._release(size)
                self._take_rows()
                self.messages.whole_floor(self.page)
                self._flush()
                self.written = self._last / 1e9
        except OSError as error:
            self._fail(error)
        except Exception as error:  # the run is worth more than its log
            self._fail(OSError(f"{type(error).__name__}: {error}"))

    @property
    def _unwritten(self) -> bool:
        return self._tape is not None and self._tape.end != self._done

    def _take(self, item: Item) -> None:
        """Add an item to the pages."""
        if isinstance(item, Tape):
            self._take_rows()  # of the one before, which nobody writes to any more
            if self._tape is not None:
                self._free.append(self._tape.memory)
            self._tape, self._done = item, 0
            self._take_rows()
        elif isinstance(item, Event):
            self.messages.single(item, self.page)
        elif isinstance(item, Painted):
            self.messages.painted(item, self.page)
        elif isinstance(item, Touched):
            self.messages.touched(item, self.page)
        else:
            self.messages.floor = FloorMirror(item)

    def _take_rows(self) -> None:
        """Add the rows that are new to the pages."""
        tape = self._tape
        if tape is None or tape.end == self._done:
            return
        end = tape.end
        part = stretch(tape.base, self._done, end)
        self.messages.add(tape.sheet, part, self.page, self.sensed)
        self._done, self._last = end, part.last
        if self.page.size + self.sensed.size > CHUNK_BYTES:
            self._flush()

    def _flush(self) -> None:
        """Write the pages.

        What was sensed goes into chunks of its own: who looks for where all were need not unpack
        readings.
        """
        self.file.chunk(self.page)
        self.file.chunk(self.sensed, swift=True)

    def _release(self, size: int) -> None:
        """So many bytes wait no more."""
        if size:
            with self._room:
                self._size -= size
                self._room.notify_all()

    def _fail(self, error: OSError) -> None:
        if self._failed is None:
            self._failed = error
            self.lost_from = self.written
            self.error = (
                f"{self.path}: the log ends at {self.written:.1f} s of the run: {reason(error)}"
            )
        self._release(self._size)


def reason(error: OSError) -> str:
    """What an error says, in a few words."""
    return error.strerror or str(error)
