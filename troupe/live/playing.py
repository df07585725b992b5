"""A log that is watched: a clock of its own goes through the ticks, as those who watch want it.

Like `watch.py` it makes moments and obeys wishes, of a run that is over: nothing can be moved or
driven in it, but one may go to any time of it.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from time import monotonic, thread_time
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.log.playback import Playback
from sim.view.moment import Moment
from troupe.live.asks import Ask
from troupe.live.exchange import Exchange
from troupe.live.log_moments import Clock, LogMoments
from troupe.live.scene import scene_of
from troupe.live.timeline import Timeline, timeline_of

if TYPE_CHECKING:
    from troupe.log import Log

FLAT_OUT = 100.0
"""Simulated seconds per second where no pace is wanted: as fast as one can look."""
AWAKE, ASLEEP = 1 / 60, 0.25
"""Wall-clock seconds between two looks at the clock: while it goes, and while it stands."""
APART = 0.4
"""Simulated seconds between two marks of a trail, as on the page."""
MARKS = 60


class Playing:
    """Shows a log; `start`: at which second of it."""

    def __init__(self, log: Log, exchange: Exchange, *, start: float = 0.0) -> None:
        self.log = log
        self.playback = Playback(log._reader)
        self.exchange = exchange
        self.timeline: Timeline = timeline_of(log, self.playback)
        self.paused = True
        self.pace: float | None = 1.0
        self.time = start
        """Where the clock stands, in simulated seconds; what shows is the tick before."""
        self.jumps = 0
        self._wake = threading.Event()
        self._shown = -1
        self._seen: frozenset[int] = frozenset()
        self._looked = 0.0
        self._ways: Any = None
        self._moments = LogMoments(self.playback, self.timeline)

    def play(self, going_on: Callable[[], bool]) -> None:
        """Show it as long as somebody may want to see it."""
        self.exchange.wake = self._wake.set
        times = self.playback.states.times
        self.time = min(max(self.time, float(times[0])), float(times[-1]))
        scene = scene_of(
            self.playback.loaded,
            seed=self.playback.seed,
            duration=self.until,
            again=False,
            log=self.timeline.about,
        )
        self.exchange.show(scene)
        self._jump()
        self._looked = monotonic()
        while going_on():
            self.turn(monotonic())
            self._wake.wait(ASLEEP if self.paused else AWAKE)
            self._wake.clear()

    def turn(self, now: float) -> None:
        """Let the clock go on to `now` (wall-clock seconds), and obey; show what that brings."""
        passed, self._looked = now - self._looked, now
        changed = False
        if not self.paused:
            self.time += passed * (FLAT_OUT if self.pace is None else self.pace)
            if self.time >= self.until:
                self.time, self.paused, changed = self.until, True, True
        for ask in self.exchange.take():
            changed |= self._obey(ask)
        k = self.playback.states.at(self.time)
        changed |= self.exchange.selected != self._seen
        if changed or (k != self._shown and self.exchange.due):
            self._offer(k)

    @property
    def until(self) -> float:
        """The simulated second at which the log ends."""
        return float(self.playback.states.times[-1])

    def _obey(self, ask: Ask) -> bool:
        match ask.do:
            case "pause":
                self.paused = True
            case "go":
                if self.time >= self.until:  # once more, from the beginning
                    self._seek(float(self.playback.states.times[0]))
                self.paused = False
            case "pace":
                self.pace = ask.numbers[0] if ask.numbers else None
            case "step":
                states = self.playback.states
                k = min(states.at(self.time) + ask.count, len(states) - 1)
                self.time, self.paused = float(states.times[k]), True
            case "seek":
                self._seek(ask.numbers[0])
            case _:
                self.exchange.tell("this is a log: what was, was")
        return True

    def _seek(self, time: float) -> None:
        self.time = min(max(time, float(self.playback.states.times[0])), self.until)
        self._jump()

    def _jump(self) -> None:
        """Trails do not go on from where the clock was: those that led here are read."""
        states = self.playback.states
        self.jumps += 1
        moments = [self.time - APART * back for back in range(MARKS - 1, -1, -1)]
        marks = dict.fromkeys(states.at(time) for time in moments if time >= states.times[0])
        # robots come one after the other: of those who were not there yet the first place is shown
        ways = [states[k].poses for k in marks]
        count = len(ways[-1]) if ways else 0
        self._ways = np.full((len(ways), count, 3), np.nan, np.float32)
        for mark, poses in enumerate(ways):
            self._ways[mark, : len(poses)] = poses

    def _offer(self, k: int) -> None:
        began = thread_time()
        self._seen, self._shown = self.exchange.selected, k
        self.exchange.offer(self.moment(k), thread_time() - began, idle=True)

    def moment(self, k: int) -> Moment:
        """What there is to see after the k-th tick of the log."""
        clock = Clock(self.paused, self.pace, self._ways, self.jumps)
        return self._moments.at(k, self._seen, clock)
