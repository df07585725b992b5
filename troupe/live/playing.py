"""A log that is watched: a clock of its own goes through the ticks, as those who watch want it.

Like `watch.py` it makes moments and obeys wishes, of a run that is over: nothing can be moved or
driven in it, but one may go to any time of it.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from time import monotonic, thread_time
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.log.playback import Playback
from sim.view.moment import SETTLED, STALLED, Moment, Robot
from troupe.live.asks import Ask
from troupe.live.exchange import Exchange
from troupe.live.readings import Shown, described
from troupe.live.scene import MOST_FANS, scene_of
from troupe.live.timeline import Timeline, timeline_of

if TYPE_CHECKING:
    from sim.log.states import State
    from troupe.log import Log

FLAT_OUT = 100.0
"""Simulated seconds per second where no pace is wanted: as fast as one can look."""
AWAKE, ASLEEP = 1 / 60, 0.25
"""Wall-clock seconds between two looks at the clock: while it goes, and while it stands."""
APART = 0.4
"""Simulated seconds between two marks of a trail, as on the page."""
MARKS = 60
MOST_TOLD, MOST_SAID = 12, 20


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
        self._floor: tuple[int, Any] = (-1, None)
        self._robots = [Robot(entry.name, entry.model) for entry in self.playback.entries]

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

    # -- moments ----------------------------------------------------------------------------

    def _offer(self, k: int) -> None:
        began = thread_time()
        self._seen, self._shown = self.exchange.selected, k
        self.exchange.offer(self.moment(k), thread_time() - began, idle=True)

    def moment(self, k: int) -> Moment:
        """What there is to see after the k-th tick of the log."""
        playback = self.playback
        present, state = playback.present(k), playback.states[k]
        count = len(present.poses)
        selected = sorted(robot for robot in self._seen if robot < count)
        states = SETTLED * present.settled + STALLED * present.stalls
        shown = self._look(state, present.settled, selected)
        return Moment(
            time=present.time,
            tick=present.tick,
            poses=present.poses.astype(np.float32),
            colors=present.colors.astype(np.uint32),
            states=states.astype(np.uint8),
            robots=self._robots[:count],
            things=present.movable_poses.astype(np.float32),
            fans=shown.fans,
            cones=shown.cones,
            sights=shown.sights,
            marks=shown.marks,
            switches=shown.switches,
            paint=self._paint(present.floor),
            said=[(robot, *line) for robot, line in enumerate(present.said) if line],
            drawn=[
                {
                    "robot": robot,
                    "kind": figure.kind,
                    "points": figure.points.tolist(),
                    "color": figure.color,
                    "fill": figure.fill_color,
                }
                for robot, figures in enumerate(playback.figures(count))
                for figure in figures
                if np.isfinite(figure.points).all()
            ],
            status={
                "paused": self.paused,
                "pace": self.pace,
                "seed": playback.seed,
                "waiting": [],
                "coverage": None if present.coverage is None else round(present.coverage, 5),
                "running": playback.running(count),
                "outcome": None,
                "jumps": self.jumps,
            },
            cards={robot: self._card(robot, state, shown) for robot in selected},
            ways=self._ways,
            jumps=self.jumps,
        )

    def _paint(self, floor: Any) -> Any:
        """A copy of the paint; the last one while nothing is painted. Bare where it was wiped off
        by going back."""
        worn = self.playback.worn
        if worn != self._floor[0] or (floor is None) != (self._floor[1] is None):
            before = self._floor[1]
            if floor is None and before is not None:
                floor = np.zeros_like(before)
            self._floor = worn, None if floor is None else floor.copy()
        return self._floor[1]

    def _look(self, state: State, settled: Any, selected: Sequence[int]) -> Shown:
        """Readings: those that somebody read, and all of who is selected."""
        shown = Shown()
        around = self.playback.sense(state, everything=frozenset(selected))
        few = len(settled) <= MOST_FANS
        firsts = around.suite.first_slot
        for group in around.suite.groups:
            for row in group.rows.tolist():
                robot = int(group.robots[row])
                if group.kind != "bits" and (robot in selected or (few and not settled[robot])):
                    shown.add(group, row, int(group.slots[row]) - firsts[robot])
        for robot in selected:
            own = self.playback.own.get(self.playback.entries[robot].model, set())
            shown.sensors[robot] = []
            for sensor in range(around.sensors_of(robot)):
                if sensor in own:
                    told: dict[str, Any] = {"type": "a sensor of one's own", "kind": "scalars"}
                else:
                    told = described(*around.suite.place(robot, sensor))
                shown.sensors[robot].append(told)
        return shown

    def _card(self, robot: int, state: State, shown: Shown) -> dict[str, Any]:
        """What the log knows of one robot at that time."""
        entry, line = self.playback.entries[robot], self.timeline
        time = state.time
        driver = line.driver(robot, time)
        return {
            "name": entry.name,
            "model": entry.model,
            "pose": state.poses[robot].tolist(),
            "twist": state.velocities[robot].tolist(),
            "odometry": None,
            "error": None,
            "command": line.command(robot, time),
            "stalled": bool(state.stalls[robot]),
            "distance": None,
            "stalls": None,
            "contacts": int(state.contacts[robot]),
            "controller": {
                "kind": "",
                "state": driver.state if driver else "",
                "exit_code": driver.exit_code if driver else None,
                "error": driver.error[-2000:] if driver and driver.error else None,
                "waited": None,
                "last_wait": None,
                "longest_wait": None,
            },
            "drivable": False,
            "devices": [],
            "properties": line.properties_of(entry.name, time),
            "said": line.said_by(entry.name, time)[-MOST_SAID:],
            "output": line.printed_by(entry.name, time)[-MOST_TOLD:],
            "sensors": shown.sensors.get(robot, []),
        }
