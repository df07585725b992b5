"""A robot enters: its body, its devices, the port where they are served, its controller."""

from __future__ import annotations

import ipaddress
from collections.abc import Callable
from dataclasses import InitVar, dataclass, field

import numpy as np
from numpy.typing import NDArray

from player.codes import DeviceAddr
from player.server import Server
from sim.devices.batch import Encoders
from sim.devices.build import robot_devices
from sim.devices.device import Context, Device
from sim.devices.position2d import StateEncoder
from sim.devices.simulation import Simulation
from sim.devices.switchboard import Port, Switchboard
from sim.fleet.crew import Crew
from sim.fleet.driver import Driver
from sim.fleet.launching import environment, kind_of, launch_of
from sim.result import RobotRecord
from sim.scenery import Scenery
from sim.spray import Sprayers
from sim.stage.geometry import outline
from sim.worldfile import LoadedWorld
from sim.worldfile.schema import Model

CONNECTIONS = 512
"""Connections over TCP at a time, whoever they are."""
CONNECTIONS_PER_ROBOT = 4
"""So many more for each robot: its controller, and some who look on."""
TOLD = 32
"""Robots whose ports are told one by one where they follow each other."""
LAST_PORT = 65535


@dataclass
class Entry:
    """Brings robots into a run, at its start and through doors.

    `listen`: host and port of the first robot, in place of the world file's.
    """

    loaded: LoadedWorld
    seed: int
    listen: InitVar[tuple[str, int] | None]
    scenery: Scenery
    context: Context
    switchboard: Switchboard
    sprayers: Sprayers
    crew: Crew
    server: Server
    say: Callable[[str], None]
    shared: Port | None = None  # of all robots, where they share one
    simulation: Simulation = field(init=False)  # of that port
    encoders: Encoders = field(default_factory=Encoders)
    states: StateEncoder = field(default_factory=StateEncoder)
    flags: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, bool))
    logged: frozenset[str] = frozenset()  # types of sensors that a log reads; "all": every one
    warned: bool = False  # of an address that others can reach

    def __post_init__(self, listen: tuple[str, int] | None) -> None:
        player = self.loaded.world.player
        self.host, self.base = listen or (player.host, player.port)
        self.open = self.base is not None
        self.context.remark = self.remark

    def enter(
        self,
        name: str,
        model_name: str,
        controller: str | None,
        pose: NDArray[np.float64],
        time: float,
    ) -> int:
        """A robot enters at a pose (x, y, yaw) and its controller is started; its index."""
        world = self.loaded.world
        model = world.models[model_name]
        kind = kind_of(controller, world.controllers)
        robot = self.scenery.add_robot(name, model_name, model, pose)
        start = (float(pose[0]), float(pose[1]), float(pose[2]))
        record = RobotRecord(
            name, model_name, time, start, start, "none" if kind == "none" else "running"
        )
        context = self.context
        context.models.append(model)
        context.records.append(record)
        context.robots[name] = robot
        context.colors.append(model.body.color)
        for index, sprayer in enumerate(model.actuators):
            self.sprayers.add(robot, index, sprayer)
            context.spraying[(robot, index)] = False
        context.fiducials.append(model.fiducial or 0)
        port, index = self.add_port(robot, model)
        driver = Driver(robot, kind, record, drives=model.drive is not None)
        self.crew.add(driver)
        self.server.max_connections = CONNECTIONS + CONNECTIONS_PER_ROBOT * (robot + 1)
        number = self.serve(port, driver, index)
        if driver.launched:
            assert controller is not None
            fields = {
                "host": reachable(self.host),
                "port": str(number),
                "name": name,
                "index": str(index),
                "seed": str(self.seed),
            }
            launch = launch_of(controller, world.controllers, self.loaded.folder, fields)
            variables = environment(name, self.seed, fields["host"], number, robot + 1)
            if kind == "command":
                variables["PLAYER_INDEX"] = fields["index"]
            self.crew.launch(driver, launch, variables, port if kind == "program" else None)
        return robot

    def add_port(self, robot: int, model: Model) -> tuple[Port, int]:
        """The robot's devices, at a port of their own (whether or not it is opened).

        Besides the index at which clients over TCP find its drive, or else its first device:
        other than 0 only where all robots share a port.
        """
        devices = robot_devices(
            self.context, self.encoders, self.states, robot, model, body_size(model)
        )
        port = self.switchboard.add_port()
        found = port.serve(devices)
        port.directory.time = self.context.time
        if self.loaded.world.player.layout == "shared":
            found = self.share(devices, robot, full=model.simulation == "full")
        return port, found[devices[0]].index

    def share(self, devices: list[Device], robot: int, full: bool) -> dict[Device, DeviceAddr]:
        """The robot's devices at the port of all robots, where there is one simulation:0."""
        if self.shared is None:
            self.shared = self.switchboard.add_port()
            self.simulation = Simulation(self.context, robot, full)
            self.shared.serve([self.simulation])
        self.simulation.admit(robot, full)
        self.shared.directory.time = self.context.time
        return self.shared.serve(d for d in devices if not isinstance(d, Simulation))

    def serve(self, port: Port, driver: Driver, index: int) -> int | None:
        """Open the robot's port, if it is to be reached from outside; the port's number."""
        if not self.open and driver.kind not in ("command", "external"):
            return None
        if self.shared is not None:
            number = self.shared.directory.port
            if not number:
                number = self.bind(self.base or 0, self.shared)
                self.say(f"robots are served at {self.host}:{number}, by index")
        else:
            number = self.bind(self.base + driver.robot if self.base else 0, port)
            if not self.base or driver.robot < TOLD:
                self.say(f"{driver.record.name} is served at {self.host}:{number}")
            elif driver.robot == TOLD:
                self.say(f"further robots are served at {self.host}:{number} and the ports above")
        if driver.kind == "external":
            what = f"position2d:{index}" if driver.drives else "its devices"
            self.say(
                f"{driver.record.name}: waiting for a Player client at {self.host}:{number} "
                f"that subscribes {what} (for {self.crew.patience.entry:g} s at the most)"
            )
        return number

    def bind(self, wanted: int, port: Port) -> int:
        """Listen at a port, 0 for any free one; its number.

        While a run is going on, the port of a robot that enters may have been taken by somebody
        else: then it gets a free one.
        """
        if not is_loopback(self.host) and not self.warned:
            self.warned = True
            self.say(
                f"listening on {self.host}: anybody who reaches this address can drive the robots"
            )
        if wanted > LAST_PORT:
            raise OSError(
                f"cannot listen on {self.host}:{wanted}: the robots' ports begin at {self.base}, "
                f"and {LAST_PORT} is the last one there is. Begin lower, or use "
                "`player: {layout: shared}` in the world file"
            )
        try:
            _, number = self.server.listen(self.host, wanted, port.directory)
        except OSError as error:
            if self.context.time == 0.0:
                raise
            self.say(f"{error}: a free port is taken instead")
            _, number = self.server.listen(self.host, 0, port.directory)
        return number

    def remark(self, robot: int, fiducial: int) -> None:
        """Fiducial finders see a robot with another id from the next reading on."""
        self.scenery.scene.fiducials[self.scenery.entities[robot]] = fiducial

    def wanted(self) -> NDArray[np.bool_]:
        """For every sensor of every robot, whether somebody reads it."""
        suite = self.scenery.suite
        if self.switchboard.changed or len(self.flags) != suite.slots:
            self.flags = np.zeros(suite.slots, bool)
            for device in self.switchboard.wanted():
                sensor = getattr(device, "sensor", None)
                if sensor is not None:
                    self.flags[suite.first_slot[device.robot] + sensor] = True
            for group in suite.groups if self.logged else ():
                if group.type.name in self.logged or "all" in self.logged:
                    self.flags[group.slots] = True
            self.switchboard.changed = False
        return self.flags

    def encode(self, tick: int) -> None:
        """A new tick: readings are encoded anew, when they are asked for."""
        self.encoders.tick = tick
        stage = self.scenery.stage
        self.states.update(self.scenery.odometry.poses, stage.velocities, stage.stalls)


def body_size(model: Model) -> tuple[float, float, float]:
    """Length, width and height of a model's body in metres."""
    body = model.body
    if body.shape == "circle":
        return (2 * body.radius, 2 * body.radius, body.height)
    vertices = outline(body)
    length, width = vertices.max(axis=0) - vertices.min(axis=0)
    return (float(length), float(width), body.height)


def reachable(host: str) -> str:
    """The address by which programs on this machine reach a server that listens on `host`."""
    return {"0.0.0.0": "127.0.0.1", "::": "::1", "": "127.0.0.1"}.get(host, host)


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach that address."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
