"""The engine: what happens within one tick, and in which order.

    wait -> command -> move -> mark the floor -> doors -> sense -> publish -> record

Nothing in a result depends on the wall clock, on which process answered first, or on whether
somebody watches.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter

import numpy as np

from player.server import Server
from sim.devices.device import Context
from sim.devices.switchboard import Switchboard
from sim.entry import Entry
from sim.fleet.crew import Crew, Patience
from sim.fleet.fleet import Fleet
from sim.pace import Pace
from sim.result import Digest, DoorRecord, FloorRecord, Outcome, Result
from sim.scenery import Scenery
from sim.spray import Sprayers
from sim.stage.doors import Doors
from sim.worldfile import LoadedWorld

AT_REST = 1e-3
"""m/s and rad/s below which a robot whose controller has finished becomes a standing body."""


@dataclass(frozen=True)
class Settings:
    """What a run is told besides its world. Times in seconds."""

    seed: int
    duration: float
    realtime: float | None = None  # simulated seconds per wall-clock second; None: flat out
    listen: tuple[str, int] | None = None
    patience: float = 60.0
    sense_all: bool = False  # also what nobody reads (for measurements)


@dataclass
class Engine:
    """One run of one world. `say` is given every line that is meant for people."""

    loaded: LoadedWorld
    settings: Settings
    fleet: Fleet
    say: Callable[[str], None]
    ticks: int = 0
    interrupted: bool = False
    began: float = 0.0
    settling: set[int] = field(default_factory=set)

    def __post_init__(self) -> None:
        world = self.loaded.world
        self.interval = world.clock.interval
        self.scenery = Scenery(self.loaded, self.settings.seed)
        self.server = Server()
        self.sprayers = Sprayers()
        self.context = Context(
            self.scenery.stage,
            self.scenery.suite,
            self.scenery.odometry,
            self.scenery.floor,
            self.interval,
            put=self.scenery.put,
            repaint=self.scenery.set_color,
        )
        self.switchboard = Switchboard(self.context, self.say)
        self.crew = Crew(
            self.server,
            self.switchboard,
            self.fleet,
            patience=Patience(self.settings.patience),
            clock=world.player.clock,
            stop=self.stop_robot,
            say=self.say,
        )
        self.crew.paused = lambda: self.context.paused
        self.context.failed = self.crew.expel
        self.entry = Entry(
            self.loaded,
            self.settings.seed,
            self.settings.listen,
            self.scenery,
            self.context,
            self.switchboard,
            self.sprayers,
            self.crew,
            self.server,
            self.say,
        )
        self.doors = Doors(self.loaded.layout, world.models, self.interval)
        self.digest = Digest()
        self.pace = Pace(self.settings.realtime)
        self.stalled = b""  # a byte per robot
        self.told_speed: tuple[int, float] = (0, 0.0)  # at which tick, and what

    @property
    def time(self) -> float:
        """Simulated seconds; a multiple of the interval, not a sum of steps."""
        return self.ticks * self.interval

    @property
    def speed(self) -> float | None:
        """Simulated seconds per wall-clock second so far: for people, not for results.

        Whoever asks within a tick is told the same, so that a video and a log show one number.
        """
        if self.told_speed[0] != self.ticks:
            passed = perf_counter() - self.began
            self.told_speed = (self.ticks, self.time / passed if passed > 0 else 0.0)
        return self.told_speed[1] or None

    def run(self, each_tick: Callable[[Engine], None] | None = None) -> Result:
        """Run to the end; the result. Whatever happens, no process is left afterwards."""
        self.began = perf_counter()
        outcome: Outcome = "interrupted"
        try:
            self.enter_first()
            self.pace.begin()
            while (ended := self.outcome()) is None:
                self.crew.wait()
                if (ended := self.outcome()) is not None:
                    break
                self.tick()
                if each_tick is not None:
                    each_tick(self)
                self.keep_pace()
            outcome = ended
            wall_time = perf_counter() - self.began
        finally:
            self.crew.dismiss()
        return self.result(outcome, wall_time)

    def enter_first(self) -> None:
        """The robots that are there from the start enter; all perceive for the first time."""
        for spec, pose in zip(self.loaded.robots, self.scenery.start_poses, strict=True):
            self.entry.enter(spec.name, spec.model, spec.controller, pose, 0.0)
        self.doors.begin(self.scenery.stage)
        self.sense()

    def tick(self) -> None:
        """One interval of simulated time, after the wait."""
        self.context.carry_out()
        self.settle()
        self.reset()
        ways = self.scenery.stage.tick(self.sprayers.carriers(self.context))
        self.ticks += 1
        self.context.time = self.time
        self.sprayers.mark(self.context, ways)
        self.open_doors()
        self.sense()
        self.switchboard.stamp(self.time)
        for connection, error in self.switchboard.publish(self.time):
            self.crew.expel(connection, error)
        self.server.flush()
        self.crew.next_round()
        self.record()

    def stop_robot(self, robot: int) -> None:
        """Nobody drives a robot any more: it brakes, its sprayers close."""
        self.context.later(robot, lambda: self.context.drive(robot, (0.0, 0.0, 0.0)))
        self.context.later(robot, lambda: self.sprayers.close(self.context, robot))
        if not self.crew.drivers[robot].running:
            self.settling.add(robot)

    def settle(self) -> None:
        """Robots whose controllers have ended and that have come to rest become standing bodies."""
        for robot in sorted(self.settling):
            if np.abs(self.scenery.stage.velocities[robot]).max() < AT_REST:
                self.scenery.stage.settle(robot)
                self.settling.discard(robot)

    def reset(self) -> None:
        """Put all robots back where they entered, if a client with full access asked for it."""
        if not self.context.resets:
            return
        self.context.resets = 0
        for robot, record in enumerate(self.context.records):
            self.scenery.put(robot, record.start)
            self.scenery.odometry.reset(robot)

    def open_doors(self) -> None:
        """Let in the robots whose step has come."""
        for door in self.doors.advance():
            cell = self.loaded.layout.doors[door]
            name = f"{cell.name}{len(self.doors.steps[door])}"
            pose = np.array([*cell.centre, cell.heading])
            self.entry.enter(name, cell.model, cell.controller, pose, self.time)
        self.doors.begin(self.scenery.stage)

    def sense(self) -> None:
        """All robots perceive, in one batch; only what somebody reads is computed."""
        self.scenery.refresh()
        self.scenery.odometry.update(self.scenery.stage.poses, self.interval, self.ticks)
        wanted = None if self.settings.sense_all else self.entry.wanted
        self.scenery.suite.sense(self.ticks, self.time, wanted)
        self.entry.encode(self.ticks)

    def record(self) -> None:
        """Digest and counters."""
        stage = self.scenery.stage
        self.digest.add(stage.poses)
        stalled = stage.stalls.tobytes()
        if stalled != self.stalled:
            before = self.stalled.ljust(len(stalled), b"\0")
            for robot, (now, then) in enumerate(zip(stalled, before, strict=True)):
                self.context.records[robot].stalls += now > then
            self.stalled = stalled

    def keep_pace(self) -> None:
        """With --realtime, wait until the wall clock has caught up; requests are answered."""
        if not self.settings.realtime:
            # clients that are pushed their data live in real time, if nothing else sets the pace
            self.pace.follow(1.0 if self.crew.pushed_only else None, self.time)
        wait = self.pace.ahead(self.time)
        if wait > 0:
            self.crew.wait(wait)

    def outcome(self) -> Outcome | None:
        """How the run has ended, None while it goes on."""
        if self.interrupted or self.crew.interrupted:
            return "interrupted"
        over = self.time >= self.settings.duration - 1e-9
        waits_for_time = self.waits_for_time
        entered = self.fleet.lost or self.doors_done()  # nobody can be started any more, or need be
        done = not waits_for_time and not self.crew.running and entered
        if not over and not done:
            return None
        states = {record.state for record in self.context.records}
        if states & {"failed", "hung", "lost"}:
            return "controller_failed"
        return "completed" if done or waits_for_time else "time_limit"

    @property
    def waits_for_time(self) -> bool:
        """Whether the run is complete when its duration is: told so, or nobody else can end it."""
        if self.loaded.world.until == "duration":
            return True
        nobody = all(driver.kind == "none" for driver in self.crew.drivers)
        return nobody and not any(door.controller for door in self.loaded.layout.doors)

    def doors_done(self) -> bool:
        """Whether every door's cell holds a robot whose controller has finished."""
        ended = [robot for robot, driver in enumerate(self.crew.drivers) if driver.kind != "none"]
        return self.doors.filled(self.scenery.stage, ended)

    def result(self, outcome: Outcome, wall_time: float) -> Result:
        """The run in numbers."""
        self.context.carry_out()  # what was said after the last tick counts as well
        stage, floor = self.scenery.stage, self.scenery.floor
        for robot, record in enumerate(self.context.records):
            x, y, yaw = map(float, stage.poses[robot])
            record.pose = (x, y, yaw)
            record.distance = float(stage.distances[robot])
            record.contacts = int(stage.contact_counts[robot])
        return Result(
            world=label(self.loaded.path),
            seed=self.settings.seed,
            outcome=outcome,
            sim_time=round(self.time, 9),
            wall_time=wall_time,
            ticks=self.ticks,
            digest=self.digest.text(),
            robots=self.context.records,
            floor=FloorRecord(floor.coverage, floor.painted_area, floor.passes),
            doors=[
                DoorRecord(cell.name, len(steps), list(steps))
                for cell, steps in zip(self.loaded.layout.doors, self.doors.steps, strict=True)
            ],
        )


def label(path: Path) -> str:
    """How a result names its world: relative to the current folder where it lies below it."""
    with contextlib.suppress(ValueError):
        return str(path.resolve().relative_to(Path.cwd()))
    return str(path)
