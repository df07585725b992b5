"""Whether a run is over, and how it has ended."""

from __future__ import annotations

from dataclasses import dataclass

from sim.build import LoadedWorld
from sim.fleet.crew import Crew
from sim.fleet.drivers import Drivers
from sim.fleet.fleet import Fleet
from sim.result import Outcome
from sim.robot import Robot
from sim.stage.doors import Doors
from sim.stage.stage import Stage

ROUNDING = 1e-9
"""s by which sums of intervals in doubles may be off."""


@dataclass
class Ending:
    """The end of one run, which lasts `duration` seconds at the most.

    `enough`: somebody has told from outside that the run is complete.
    """

    loaded: LoadedWorld
    duration: float
    interval: float
    robots: list[Robot]
    drivers: Drivers
    crew: Crew
    fleet: Fleet
    doors: Doors
    stage: Stage
    enough: bool = False
    _looked: int = -1  # how many robots there were when was looked whether any has a controller
    _nobody: bool = True

    def outcome(self, time: float) -> Outcome | None:
        """How the run has ended at a time (s), None while it goes on."""
        if self.crew.interrupted:
            return "interrupted"
        if self.drivers.failed:
            return "controller_failed"
        if self.enough:
            return "completed"
        over = time + self.interval > self.duration + ROUNDING
        waits_for_time = self.waits_for_time
        if not over and (waits_for_time or self.drivers.any_running):
            return None
        entered = self.fleet.lost or self.doors_done()  # nobody else can be started, or has to be
        done = not waits_for_time and not self.drivers.any_running and entered
        if not over and not done:
            return None
        states = {robot.record.state for robot in self.robots}
        if states & {"failed", "hung", "lost"}:
            return "controller_failed"
        return "completed" if done or waits_for_time else "time_limit"

    @property
    def waits_for_time(self) -> bool:
        """Whether the run is complete when its duration is: told so, or nobody else can end it."""
        if self.loaded.world.until == "duration":
            return True
        if self._looked != len(self.robots):
            self._looked = len(self.robots)
            self._nobody = all(robot.driver.kind == "none" for robot in self.robots)
        return self._nobody and not any(door.controller for door in self.loaded.layout.doors)

    def doors_done(self) -> bool:
        """Whether every door's cell holds a robot whose controller has finished."""
        ended = [robot.index for robot in self.robots if robot.driver.kind != "none"]
        return self.doors.filled(self.stage, ended)
