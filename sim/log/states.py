"""The states of a log one by one: any tick's, wherever in the file it stands."""

from __future__ import annotations

from bisect import bisect_right
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.log.cdr import decode
from sim.log.contents import STATES
from sim.log.reader import LogReader, Run
from sim.log.tick_messages import STATE, state_layout


class State(NamedTuple):
    """All that moves at the end of a tick; arrays over the robots that have entered."""

    tick: int
    time: float
    """Simulated seconds."""
    coverage: float
    """The painted share of the floor; NaN where nothing is painted."""
    colors: NDArray[np.uint32]
    contacts: NDArray[np.uint32]
    stalls: NDArray[np.bool_]
    velocities: NDArray[np.float32]
    """(n, 3)"""
    poses: NDArray[np.float64]
    """(n, 3)"""
    movable_poses: NDArray[np.float64]
    """(m, 3)"""


class States:
    """The states in their order: `states[k]` is that after the k-th tick of the log, from 0."""

    def __init__(self, reader: LogReader, interval: float) -> None:
        self._reader = reader
        self._interval = interval
        self._chunks = [entry for entry in reader.entries(STATES) if len(entry[1])]
        counts = [len(entries) for _, entries in self._chunks]
        self._firsts = [0, *np.cumsum(counts).tolist()]
        stamps = [entries["time"] for _, entries in self._chunks]
        self.stamps: NDArray[np.uint64] = np.concatenate([np.zeros(0, np.uint64), *stamps])
        """(t,) simulated ns at the ends of the ticks."""
        self.ticks: NDArray[np.int64] = np.rint(self.stamps / (interval * 1e9)).astype(np.int64)
        """(t,) the ticks, from 1."""
        self.times = np.array(self.ticks * interval, np.float64)
        """(t,) simulated seconds, as the run counted them."""
        self._open: tuple[int, list[tuple[int, Run]]] = (-1, [])

    def __len__(self) -> int:
        return len(self.stamps)

    def at(self, time: float) -> int:
        """The last state at or before a time (s), or the first one."""
        return max(0, int(np.searchsorted(self.times, time + 1e-9, side="right")) - 1)

    def __getitem__(self, k: int) -> State:
        chunk = bisect_right(self._firsts, k) - 1
        if self._open[0] != chunk:
            self._open = chunk, self._runs(chunk)
        firsts = [first for first, _ in self._open[1]]
        first, run = self._open[1][bisect_right(firsts, k) - 1]
        row = k - first
        return state_of(decode(STATE, run.messages[row].tobytes()), self._interval)

    def _runs(self, chunk: int) -> list[tuple[int, Run]]:
        """The messages of a chunk that are alike, each with the number of its first state."""
        place, entries = self._chunks[chunk]
        first, found = self._firsts[chunk], []
        start, end = int(entries["time"][0]), int(entries["time"][-1]) + 1
        for run in self._reader.runs_of(place, STATES, start, end):
            layout = state_layout(*counted(run))
            if layout.size != run.messages.shape[1]:
                raise self._reader.damaged("a state is not as it should be")
            found.append((first, run))
            first += len(run.times)
        return found


def counted(run: Run) -> tuple[int, int]:
    """Robots and things that can be pushed, in states that are alike."""
    one = decode(STATE, run.messages[0].tobytes())
    return len(one["colors"]), len(one["movable_poses"]) // 3


def state_of(told: dict[str, Any], interval: float) -> State:
    """A message of the type State."""
    return State(
        told["tick"],
        told["tick"] * interval,
        told["coverage"],
        told["colors"],
        told["contacts"],
        told["stalls"],
        told["velocities"].reshape(-1, 3),
        told["poses"].reshape(-1, 3),
        told["movable_poses"].reshape(-1, 3),
    )
