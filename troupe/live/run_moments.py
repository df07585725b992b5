"""What a run is at, as a moment: read off the engine between two ticks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from time import monotonic
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.showing import Backdrops, thing_poses
from sim.view import figure
from sim.view.moment import AWAITED, SETTLED, STALLED, TOUCHING, Moment, Robot
from sim.view.present import ENDED
from troupe.live.hands import Hands, cannot_drive, driving
from troupe.live.readings import Eyes, Shown
from troupe.live.scene import MOST_SAID, MOST_TOLD
from troupe.live.told import Card, Status
from troupe.live.waits import Waits

if TYPE_CHECKING:
    from sim.engine import Engine

AWAITED_AFTER = 0.5
"""Wall-clock seconds of waiting after which a page tells for whom."""
MOST_AWAITED = 5


class RunMoments:
    """Makes moments of one run."""

    def __init__(self, engine: Engine, hands: Hands, waits: Waits) -> None:
        self.engine, self.hands, self.waits = engine, hands, waits
        self._eyes = Eyes(engine)
        self._backdrops = Backdrops(engine.loaded)
        self._robots: list[Robot] = []
        self._paint: tuple[tuple[float, float], Any] = ((0.0, 0.0), None)

    def now(self, selected: frozenset[int], *, stands: bool, outcome: str | None) -> Moment:
        """The moment of now. `stands`: whether it was paused; `outcome`: how the run has ended."""
        engine = self.engine
        stage, records = engine.scenery.stage, [robot.record for robot in engine.robots]
        self._robots += [Robot(r.name, r.model) for r in records[len(self._robots) :]]
        awaited = engine.behind(AWAITED_AFTER)
        settled = np.array([record.state in ENDED for record in records], bool)
        shown = self._eyes.look(engine, settled, selected)
        return Moment(
            time=engine.time,
            tick=engine.ticks,
            poses=stage.poses.astype(np.float32),
            colors=np.array([robot.color for robot in engine.robots], np.uint32),
            states=self._states(settled, awaited),
            robots=list(self._robots) if len(self._robots) < len(records) else self._robots,
            things=thing_poses(stage.layout, stage.movable_poses).astype(np.float32),
            backdrop=self._backdrops.of(stage.layout),
            fans=shown.fans,
            cones=shown.cones,
            sights=shown.sights,
            marks=shown.marks,
            switches=shown.switches,
            paint=self._floor(),
            said=[(k, *record.said[-1]) for k, record in enumerate(records) if record.said],
            drawn=figure.told([robot.drawings for robot in engine.robots]),
            status=self._status(awaited, settled, stands or engine.context.paused, outcome),
            cards={robot: self._card(robot, shown) for robot in selected if robot < len(records)},
        )

    def _states(self, settled: Any, awaited: Mapping[str, float]) -> Any:
        stage = self.engine.scenery.stage
        states = SETTLED * settled + STALLED * stage.stalls + TOUCHING * stage.touching
        for name in awaited:
            states[self.engine.context.by_name[name].index] += AWAITED
        return states.astype(np.uint8)

    def _floor(self) -> Any:
        """A copy of the paint; the last one while nothing is painted."""
        floor = self.engine.scenery.floor
        if floor.painted_area <= 0.0:
            return None
        worn = (floor.painted_area, floor.passes)  # every sweep changes one of them
        if worn != self._paint[0]:
            self._paint = worn, floor.owner.copy()
        return self._paint[1]

    def _status(
        self, awaited: Mapping[str, float], settled: Any, paused: bool, outcome: str | None
    ) -> Status:
        engine = self.engine
        floor = engine.scenery.floor
        late = sorted(awaited.items(), key=lambda item: -item[1])[:MOST_AWAITED]
        return {
            "paused": paused,
            "pace": engine.realtime,
            "seed": engine.settings.seed,
            "waiting": [[name, round(wait, 1)] for name, wait in late],
            "running": sum(robot.record.state == "running" for robot in engine.robots),
            "coverage": round(floor.coverage, 5) if floor.painted_area > 0.0 else None,
            "contacts": int(engine.scenery.stage.contact_counts.sum()),
            "ended": int(settled.sum()),
            "outcome": outcome,
        }

    def _card(self, robot: int, shown: Shown) -> Card:
        """What is known of one robot."""
        engine = self.engine
        scenery, one = engine.scenery, engine.robots[robot]
        stage, record, driver = scenery.stage, one.record, one.driver
        output = engine.fleet.outputs.get(robot)
        since = engine.crew.behind.get(robot)
        kind, wish = stage.command_of(robot)
        waits, longest = self.waits.of(robot)
        able = cannot_drive(engine, robot) is None
        return {
            "name": record.name,
            "model": record.model,
            "pose": stage.poses[robot].tolist(),
            "twist": stage.velocities[robot].tolist(),
            "odometry": scenery.odometry.poses[robot].tolist(),
            "error": self._odometry_error(robot),
            "command": [kind, list(wish)],
            "stalled": bool(stage.stalls[robot]),
            "distance": float(stage.distances[robot]),
            "stalls": record.stalls,
            "contacts": int(stage.contact_counts[robot]),
            "controller": {
                "kind": driver.kind,
                "state": record.state,
                "exit_code": record.exit_code,
                "error": None if record.error is None else record.error[-2000:],
            },
            "waits": None
            if driver.kind == "none"
            else {
                "now": None if since is None else monotonic() - since.since,
                "ticks": [round(1000 * wait, 2) for wait in waits],
                "longest": round(1000 * longest, 2),
            },
            "drivable": able and (robot in self.hands.taken or driving(one) is None),
            "takable": able and driving(one) is not None,
            "taken": robot in self.hands.taken,
            "devices": list(record.devices),
            "properties": dict(record.properties),
            "said": [list(line) for line in record.said[-MOST_SAID:]],
            "output": [] if output is None else list(output.tail)[-MOST_TOLD:],
            "sensors": shown.sensors.get(robot, []),
        }

    def _odometry_error(self, robot: int) -> list[float]:
        """By how much what odometry says is wrong, in the world: metres, metres, radians."""
        scenery = self.engine.scenery
        estimate = scenery.odometry.in_world(robot)
        x, y, yaw = scenery.stage.poses[robot].tolist()
        return [estimate[0] - x, estimate[1] - y, math.remainder(estimate[2] - yaw, math.tau)]
