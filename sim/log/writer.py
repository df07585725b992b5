"""The log while it is written: the run hands over states, a thread makes a file of them."""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from pathlib import Path

from sim.log.blocks import Block
from sim.log.container import LogFile
from sim.log.errors import LogError
from sim.log.floor import FloorMirror
from sim.log.moment import Event, Floor, TickState
from sim.log.scene import paint_event
from sim.log.tick_blocks import TickBlocks

FORMAT = 1
"""Of what a log holds: a reader refuses later ones."""
WAIT = 0.4
"""Wall-clock seconds in which states are gathered for a chunk: with the time that it takes to
write one, everything that is older than a second is in the file."""
CHUNK_BYTES = 1 << 23
"""What a chunk holds, roughly and before it is compressed: a reader that seeks unpacks one."""
MOST_WAITING = 1 << 28
"""Bytes of states that may wait to be written; then the run waits too."""

Item = TickState | Event | Sequence[str] | Floor
"""States and events; the names of all robots (as ROS takes them) before states that have new
ones; the floor before the first states with paint."""


class LogWriter:
    """Writes a log on a thread of its own. `put` may be called by one other thread.

    After an error (a full disk) nothing more is written, and `error` says why; the run may go on.
    """

    def __init__(self, path: Path, library: str, about: Mapping[str, str]) -> None:
        """Opens the file; raises LogError where that cannot be. `about`: what ran, as texts."""
        try:
            self.file = LogFile(path, library)
            self.file.note("troupe", {"format": str(FORMAT), **about})
        except OSError as error:
            raise LogError(f"{path}: the log cannot be written: {reason(error)}") from None
        self.path = path
        self.tick_blocks = TickBlocks(self.file.channels)
        self.error: str | None = None
        self.lost_from: float | None = None
        self.written = 0.0  # simulated seconds up to which all is in the file
        self._waiting: list[Item] = []
        self._size = 0
        self._closing = False
        self._wake = threading.Event()
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

    def put(self, item: Item, size: int) -> None:
        """Hand over something to be written, which takes `size` bytes while it waits."""
        self._waiting.append(item)
        self._size += size
        if not self._wake.is_set():
            self._wake.set()
        if self._size > CHUNK_BYTES:
            self._full.set()
            if self._size > MOST_WAITING:
                with self._room:
                    self._room.wait_for(lambda: self._size <= MOST_WAITING)

    def stop(self) -> None:
        """Write all that waits, and end the thread."""
        self._closing = True
        self._wake.set()
        self._full.set()
        self._thread.join()

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
            self._wake.wait()
            self._full.wait(WAIT)
            self._wake.clear()
            self._full.clear()
            self._drain()
        self._drain()

    def _drain(self) -> None:
        waiting, self._waiting = self._waiting, []
        with self._room:
            size, self._size = self._size, 0
            self._room.notify_all()
        if not waiting or self._failed is not None:
            return
        try:
            self.file.check_there()
            self._write(waiting, size)
        except OSError as error:
            self._fail(error)
        except Exception as error:  # the run is worth more than its log
            self._fail(OSError(f"{type(error).__name__}: {error}"))

    def _write(self, waiting: list[Item], size: int) -> None:
        """Items as chunks of about CHUNK_BYTES."""
        most = max(1, len(waiting) * CHUNK_BYTES // max(size, 1))
        for first in range(0, len(waiting), most):
            part = waiting[first : first + most]
            for blocks in self._blocks(part):
                self.file.chunk(blocks)
            times = [one.time for one in part if isinstance(one, TickState)]
            if times:
                self.written = times[-1]

    def _blocks(self, items: list[Item]) -> tuple[list[Block], list[Block]]:
        """The blocks of items, and of what was sensed; states that are alike go together.

        They go into chunks of their own: who looks for where all were need not unpack readings.
        """
        tick_blocks = self.tick_blocks
        found: list[Block] = []
        sensed: list[Block] = []
        alike: list[TickState] = []

        def gather() -> None:
            found.extend(tick_blocks.blocks(alike))
            sensed.extend(tick_blocks.sensed_blocks(alike))
            alike.clear()

        for item in items:
            if isinstance(item, TickState):
                if alike and alike[-1].robots != item.robots:
                    gather()
                alike.append(item)
                found += [tick_blocks.single(event) for event in item.events]
            elif isinstance(item, Event):
                found.append(tick_blocks.single(item))
            elif isinstance(item, Floor):
                tick_blocks.floor = FloorMirror(item)
            else:
                gather()
                tick_blocks.names = list(item)
        gather()
        floor = tick_blocks.floor
        if floor is not None and floor.changed:
            floor.changed = False
            time = max((one.time for one in items if isinstance(one, TickState)), default=0.0)
            found.append(tick_blocks.single(paint_event(floor, time)))
        return found, sensed

    def _fail(self, error: OSError) -> None:
        if self._failed is None:
            self._failed = error
            self.lost_from = self.written
            self.error = (
                f"{self.path}: the log ends at {self.written:.1f} s of the run: {reason(error)}"
            )


def reason(error: OSError) -> str:
    """What an error says, in a few words."""
    return error.strerror or str(error)
