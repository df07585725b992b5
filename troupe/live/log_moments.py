"""What a run was at, as a moment: read from its log, with what robots perceived sensed again."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from sim.log.playback import Playback
from sim.log.states import State
from sim.showing import thing_poses
from sim.view import figure
from sim.view.moment import SETTLED, STALLED, Moment, Robot
from troupe.live.readings import Shown, described
from troupe.live.scene import MOST_FANS, MOST_SAID, MOST_TOLD
from troupe.live.timeline import Timeline
from troupe.live.told import Card, Status


class Clock(NamedTuple):
    """How the log is played. `ways`: those that led to where time jumped for the `jumps`-th time
    (see `Moment`)."""

    paused: bool
    pace: float | None
    ways: Any
    jumps: int


class LogMoments:
    """Makes moments of one log."""

    def __init__(self, playback: Playback, timeline: Timeline) -> None:
        self.playback, self.timeline = playback, timeline
        self._floor: tuple[int, Any] = (-1, None)
        self._robots = [Robot(entry.name, entry.model) for entry in playback.entries]

    def at(self, k: int, seen: frozenset[int], clock: Clock) -> Moment:
        """What there is to see after the k-th tick. `seen`: who is selected."""
        playback = self.playback
        present, state = playback.present(k), playback.states[k]
        count = len(present.poses)
        selected = sorted(robot for robot in seen if robot < count)
        states = SETTLED * present.settled + STALLED * present.stalls
        shown = self._look(state, present.settled, selected)
        status: Status = {
            "paused": clock.paused,
            "pace": clock.pace,
            "seed": playback.seed,
            "waiting": [],
            "running": playback.running(count),
            "coverage": None if present.coverage is None else round(present.coverage, 5),
            "contacts": int(state.contacts.sum()),
            "ended": int(present.settled.sum()),
            "outcome": None,
        }
        return Moment(
            time=present.time,
            tick=present.tick,
            poses=present.poses.astype(np.float32),
            colors=present.colors.astype(np.uint32),
            states=states.astype(np.uint8),
            robots=self._robots[:count],
            things=thing_poses(playback.layout, present.movable_poses).astype(np.float32),
            backdrop=present.backdrop,
            fans=shown.fans,
            cones=shown.cones,
            sights=shown.sights,
            marks=shown.marks,
            switches=shown.switches,
            paint=self._paint(present.floor),
            said=[(robot, *line) for robot, line in enumerate(present.said) if line],
            drawn=figure.told(playback.figures(count)),
            status=status,
            cards={robot: self._card(robot, state, shown) for robot in selected},
            ways=clock.ways,
            jumps=clock.jumps,
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
                    told: dict[str, Any] = {"type": "a sensor of one's own", "kind": "unknown"}
                    told["known"] = "a log runs no code"
                else:
                    told = described(*around.suite.place(robot, sensor))
                if told["kind"] == "bits":
                    told |= {"kind": "unknown", "known": self._touch(robot, state)}
                shown.sensors[robot].append(told)
        return shown

    def _touch(self, robot: int, state: State) -> str:
        """When and where a robot began to touch something last: of bumpers a log has no more."""
        touch = self.timeline.touch(robot, state.time)
        if touch is None:
            return "nothing touched so far"
        (x, y), (x0, y0, yaw) = touch.point, state.poses[robot].tolist()
        where = f"({x:.2f}, {y:.2f})"
        if touch.time >= state.time - 1e-9:
            bearing = math.degrees(math.remainder(math.atan2(y - y0, x - x0) - yaw, math.tau))
            where += f", {bearing:.0f}° from ahead"
        return f"last began to touch at {touch.time:.2f} s, {where}; a log has not how long"

    def _card(self, robot: int, state: State, shown: Shown) -> Card:
        """What the log knows of one robot at that time."""
        entry, line = self.playback.entries[robot], self.timeline
        time = state.time
        driver = line.driver(robot, time)
        believed, error = self._odometry(robot, state)
        return {
            "name": entry.name,
            "model": entry.model,
            "pose": state.poses[robot].tolist(),
            "twist": state.velocities[robot].tolist(),
            "odometry": believed,
            "error": error,
            "command": line.command(robot, time),
            "stalled": bool(state.stalls[robot]),
            "distance": None,
            "stalls": None,
            "contacts": int(state.contacts[robot]),
            "controller": {
                "kind": "",
                "state": self.playback.driver_state(robot),
                "exit_code": driver.exit_code if driver else None,
                "error": driver.error[-2000:] if driver and driver.error else None,
            },
            "waits": None,
            "drivable": False,
            "takable": False,
            "taken": False,
            "devices": None,
            "properties": line.properties_of(entry.name, time),
            "said": line.said_by(entry.name, time)[-MOST_SAID:],
            "output": line.printed_by(entry.name, time)[-MOST_TOLD:],
            "sensors": shown.sensors.get(robot, []),
        }

    def _odometry(self, robot: int, state: State) -> tuple[list[float] | None, list[float] | None]:
        """What odometry said then, where the log has that, and by how much it was wrong in the
        world (m, m, rad), counted from where the robot entered."""
        entry, model = self.playback.entries[robot], self.playback.models[robot]
        believed = self.timeline.odometry(robot, state.time)
        if believed is None:
            return None, None
        frame = entry.pose
        if model.localization == "gps":
            frame = (0.0, 0.0, 0.0)
        elif model.odometry_origin is not None:
            x, y, heading = model.odometry_origin
            frame = (x, y, math.radians(heading))
        (fx, fy, turn), (bx, by, byaw) = frame, believed
        cos, sin = math.cos(turn), math.sin(turn)
        x, y, yaw = state.poses[robot].tolist()
        wrong = [fx + cos * bx - sin * by - x, fy + sin * bx + cos * by - y]
        return believed, [*wrong, math.remainder(turn + byaw - yaw, math.tau)]
