"""The engine: what happens within one tick, and in which order.

    wait -> command -> move -> mark the floor -> doors -> sense -> publish -> record

Nothing in a result depends on the wall clock, on which process answered first, or on whether
somebody watches.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from time import monotonic, perf_counter

import numpy as np

from player.server import Server
from sim.build import LoadedWorld
from sim.devices.device import Context
from sim.devices.switchboard import Switchboard
from sim.devices.things import chargers_of, named_things
from sim.ending import Ending
from sim.entry import Entry
from sim.fleet.clocks import Clocks
from sim.fleet.crew import Crew, Patience
from sim.fleet.drivers import Drivers
from sim.fleet.fleet import Fleet
from sim.fleet.functions import Controllers, FunctionError, Functions
from sim.fleet.routing import Router
from sim.fleet.sleeping import Sleeping
from sim.garbage import kept_objects
from sim.hands import Hands
from sim.pace import Pace
from sim.ports import Ports
from sim.result import Digest, DoorRecord, FloorRecord, Outcome, Result, Touch
from sim.robot import Robot
from sim.scenery import Scenery
from sim.sensing import Sensing
from sim.spray import Spraying, close
from sim.stage.doors import Doors

AT_REST = 1e-3
"""m/s and rad/s below which a robot whose controller has finished becomes a standing body."""
LONGEST_NAP = 0.1
"""Wall-clock seconds after which a run that is held to the clock looks whether the pace is new."""


@dataclass(frozen=True)
class Settings:
    """What a run is told besides its world. Times in seconds."""

    seed: int
    duration: float
    realtime: float | None = None  # simulated seconds per wall-clock second; None: flat out
    free: bool = False  # nobody waits for clients from outside, whatever the world file says
    listen: tuple[str, int] | None = None
    patience: float = 60.0  # wall-clock seconds; infinite: for ever
    fail_fast: bool = False  # the first controller that fails ends the run
    sense_all: bool = False  # also what nobody reads (for measurements)


@dataclass
class Engine:
    """One run of one world.

    `say` is given every line that is meant for people, and `warn`, or else `say`, what they
    must not overlook. `while_waiting(engine)` is called now and then while the world waits.
    `controllers`: True for those of the world, False for none; or by name whether one is started
    as in the world, or the function that drives its robots instead.

    `begin`, then `advance` until it returns False, then `result`; `run` does all of it, and ends
    the processes.
    """

    loaded: LoadedWorld
    settings: Settings
    fleet: Fleet
    say: Callable[[str], None]
    warn: Callable[[str], None] | None = None
    while_waiting: Callable[[Engine], None] | None = None
    controllers: Controllers = True
    ticks: int = 0
    began: float = 0.0
    ended: Outcome | None = None  # how the run has ended, once it has
    settling: set[int] = field(default_factory=set)
    touched: list[Touch] = field(default_factory=list)  # what somebody did by hand

    def __post_init__(self) -> None:
        world = self.loaded.world
        self.interval = world.clock.interval
        self.scenery = Scenery(self.loaded, self.settings.seed)
        self.server = Server()
        self.spraying = Spraying(self.scenery.floor)
        self.context = Context(
            self.scenery,
            self.interval,
            things=named_things(self.loaded.layout),
            chargers=chargers_of(world),
        )
        self.switchboard = Switchboard(self.context, self.say)
        self.sensing = Sensing(self.context, self.switchboard, everything=self.settings.sense_all)
        patience = Patience(self.settings.patience)
        self.robots = self.context.robots
        self.drivers = Drivers(
            self.robots,
            Clocks("free" if self.settings.free else world.player.clock),
            self.stop_robot,
            fail_fast=self.settings.fail_fast,
        )
        self.router = Router(self.switchboard, self.drivers, self.say, self.sensing.show_again)
        self.crew = Crew(
            self.context,
            self.server,
            self.fleet,
            self.drivers,
            self.router,
            patience=patience,
            say=self.say,
            while_waiting=self.while_waiting and partial(self.while_waiting, self),
        )
        self.hands = Hands(self.context, self.say)
        self.functions = Functions()
        self.ports = Ports(
            world.player,
            world.controllers,
            self.settings.listen,
            self.context,
            self.switchboard,
            self.server,
            patience=None if self.free else patience.entry,
            say=self.say,
            warn=self.warn or self.say,
        )
        self.entry = Entry(
            self.loaded,
            self.settings.seed,
            self.context,
            self.switchboard,
            self.sensing,
            self.spraying,
            self.ports,
            self.crew,
            self.controllers,
            self.functions,
        )
        self.doors = Doors(self.loaded.layout, world.models, self.interval)
        self.ending = Ending(
            self.loaded,
            self.settings.duration,
            self.interval,
            self.robots,
            self.drivers,
            self.crew,
            self.fleet,
            self.doors,
            self.scenery.stage,
        )
        self.digest = Digest()
        self.realtime = self.settings.realtime  # who watches may change it meanwhile
        self.pace = Pace(self.factor)
        if self.realtime is not None and not self.free:
            self.drivers.clocks.sleeping = Sleeping(self.say)
        self.stalled = b""  # a byte per robot

    @property
    def time(self) -> float:
        """Simulated seconds; a multiple of the interval, not a sum of steps."""
        return self.ticks * self.interval

    @property
    def free(self) -> bool:
        """Whether the world runs on by itself, and waits for no client from outside."""
        return self.drivers.clocks.mode == "free"

    @property
    def speed(self) -> float | None:
        """Simulated seconds per wall-clock second so far: for people, not for results."""
        passed = perf_counter() - self.began
        return self.time / passed if self.ticks and passed > 0 else None

    def run(self, each_tick: Callable[[Engine], None] | None = None) -> Result:
        """Run to the end; the result. Whatever happens, no process is left afterwards."""
        try:
            self.begin()
            while self.advance():
                if each_tick is not None:
                    each_tick(self)
                self.keep_pace()
            if self.ended == "interrupted":
                self.crew.tell_awaited()
            wall_time = perf_counter() - self.began
        finally:
            self.crew.dismiss()
        return self.result(self.ended or "interrupted", wall_time)

    def begin(self) -> None:
        """The robots of the start enter, and the clock begins."""
        self.began = perf_counter()
        self.enter_first()
        self.announce()
        self.pace.begin()

    def advance(self) -> bool:
        """One tick, after the wait for all controllers; False, without it, if the run is over."""
        self.ended = self.outcome()
        if self.ended is None and not self.alone:
            self.crew.wait()
            self.ended = self.outcome()
        if self.ended is not None:
            return False
        self.tick()
        if self.functions.robots:
            self.call_functions()
        return True

    @property
    def alone(self) -> bool:
        """Whether nobody could be heard or waited for: no process, no client, no open port."""
        return (
            not self.server.selector.get_map() and self.while_waiting is None and self.crew.ready()
        )

    def call_functions(self) -> None:
        """Call the controllers that are functions; raises FunctionError for the first that does."""
        try:
            done = self.functions.call(self.ticks, self.time)
        except FunctionError as error:
            error.result = self.result("interrupted", perf_counter() - self.began)
            raise
        for index in done:
            self.drivers.end(self.robots[index].driver, "finished", 0, None)

    def enter_first(self) -> None:
        """The robots that are there from the start enter; all perceive for the first time."""
        with kept_objects(len(self.loaded.robots)):
            for spec, pose in zip(self.loaded.robots, self.scenery.start_poses, strict=True):
                self.entry.enter(spec.name, spec.model, spec.controller, pose, 0.0)
        self.doors.begin(self.scenery.stage)
        self.sensing.sense(self.ticks, self.time)
        self.entry.serve_held()

    def announce(self) -> None:
        """Say what a world is going to do in which nobody drives."""
        robots = self.robots
        if self.loaded.layout.doors or any(robot.driver.kind != "none" for robot in robots):
            return
        who = "no robot here has a controller" if robots else "there are no robots in this world"
        guests = ", or as clients drive them" if robots and self.ports.open else ""
        moves = f": things move by themselves{guests}" if robots else ": nothing drives"
        self.say(f"{who}{moves}, for {self.settings.duration:g} simulated seconds")

    def tick(self) -> None:
        """One interval of simulated time, after the wait."""
        self.carry_out()
        if self.settling:
            self.settle()
        if self.context.resets:
            self.hands.reset()
        ways = self.scenery.stage.tick(self.spraying.carriers())
        self.ticks += 1
        self.context.time = time = self.time
        self.spraying.mark(ways)
        for go_on in self.context.each_tick:
            go_on()
        if self.doors.doors:
            self.open_doors()
        self.sensing.sense(self.ticks, time)
        self.switchboard.stamp(time)
        for connection, error in self.switchboard.publish(time, self.sensing.encodings.round):
            self.router.expel(connection, error)
        self.server.flush()
        self.crew.next_round()
        self.record()

    def carry_out(self) -> None:
        """Have done what clients have asked for; who asked for what cannot be done is expelled.

        That stops robots, before the tick as well. Robots are put where they shall be put first,
        all at once.
        """
        if self.context.puts or self.context.thing_puts:
            self.hands.put_all()
        while failed := self.context.carry_out():
            for client, error in failed:
                self.router.expel(client, error)

    def stop_robot(self, robot: Robot) -> None:
        """Nobody drives a robot any more: it brakes, its sprayers close."""
        self.context.later(robot, lambda: self.context.drive(robot, (0.0, 0.0, 0.0)))
        self.context.later(robot, lambda: close(robot))
        if not robot.driver.running:
            self.settling.add(robot.index)

    def settle(self) -> None:
        """Robots whose controllers have ended and that have come to rest become standing bodies."""
        for robot in sorted(self.settling):
            if np.abs(self.scenery.stage.velocities[robot]).max() < AT_REST:
                self.scenery.stage.settle(robot)
                self.settling.discard(robot)

    def open_doors(self) -> None:
        """Let in the robots whose step has come."""
        for door in self.doors.advance():
            cell = self.loaded.layout.doors[door]
            name = f"{cell.name}{len(self.doors.steps[door])}"
            pose = np.array([*cell.centre, cell.heading])
            self.entry.enter(name, cell.model, cell.controller, pose, self.time)
        self.doors.begin(self.scenery.stage)

    def record(self) -> None:
        """Digest and counters."""
        stage = self.scenery.stage
        self.digest.add(stage.poses)
        stalled = stage.stalls.tobytes()
        if stalled != self.stalled:
            before = self.stalled.ljust(len(stalled), b"\0")
            for robot, (now, then) in enumerate(zip(stalled, before, strict=True)):
                self.robots[robot].record.stalls += now > then
            self.stalled = stalled

    def keep_pace(self) -> None:
        """With --realtime, wait until the wall clock has caught up; requests are answered."""
        while True:
            self.pace.follow(self.factor, self.time)
            wait = self.pace.ahead(self.time)
            if wait <= 0 or self.crew.interrupted or self.drivers.failed:
                break
            self.crew.wait(min(wait, LONGEST_NAP))

    @property
    def factor(self) -> float | None:
        """The pace that is held now: those for whom nobody waits live in real time, unless told."""
        return self.realtime or (1.0 if self.free or self.crew.pushed_only else None)

    def behind(self, seconds: float) -> dict[str, float]:
        """Who has been waited for for so many wall-clock seconds, and since how many, by name."""
        now = monotonic()
        waits = {d.record.name: now - d.since for d in self.crew.behind.values()}
        return {name: wait for name, wait in waits.items() if wait >= seconds}

    def outcome(self) -> Outcome | None:
        """How the run has ended, None while it goes on."""
        return self.ending.outcome(self.time)

    def result(self, outcome: Outcome, wall_time: float) -> Result:
        """The run in numbers."""
        self.carry_out()  # what was said after the last tick counts as well
        stage, floor = self.scenery.stage, self.scenery.floor
        records = [robot.record for robot in self.robots]
        for robot, record in enumerate(records):
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
            robots=records,
            floor=FloorRecord(floor.coverage, floor.painted_area, floor.passes),
            doors=[
                DoorRecord(cell.name, len(steps), list(steps))
                for cell, steps in zip(self.loaded.layout.doors, self.doors.steps, strict=True)
            ],
            touched=list(self.touched),
        )


def label(path: Path) -> str:
    """How a result names its world: relative to the current folder where it lies below it."""
    with contextlib.suppress(ValueError):
        return str(path.resolve().relative_to(Path.cwd()))
    return str(path)
