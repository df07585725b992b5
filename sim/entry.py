"""A robot enters: its body, its devices, the port where they are served, its controller."""

from __future__ import annotations

import errno
import ipaddress
import math
from collections.abc import Callable
from dataclasses import InitVar, dataclass, field

import numpy as np
from numpy.typing import NDArray

from player.codes import DEFAULT_PORT, DeviceAddr
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
from sim.robot import Robot, Sprayer
from sim.scenery import Scenery
from sim.spray import Spraying
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
    spraying: Spraying
    crew: Crew
    server: Server
    say: Callable[[str], None]
    warn: Callable[[str], None]
    shared: Port | None = None  # of all robots, where they share one
    simulation: Simulation = field(init=False)  # of that port
    encoders: Encoders = field(default_factory=Encoders)
    states: StateEncoder = field(default_factory=StateEncoder)
    flags: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, bool))
    warned: bool = False  # of an address that others can reach
    awaited_told: bool = False  # how to drive a robot by hand
    awaited: int = 0  # robots whose clients are waited for at ports that nobody has chosen

    def __post_init__(self, listen: tuple[str, int] | None) -> None:
        player = self.loaded.world.player
        self.host, self.base = listen or (player.host, player.port)
        self.open = self.base is not None

    def enter(
        self,
        name: str,
        model_name: str,
        controller: str | None,
        pose: NDArray[np.float64],
        time: float,
    ) -> Robot:
        """A robot enters at a pose (x, y, yaw) and its controller is started."""
        world = self.loaded.world
        model = world.models[model_name]
        kind = kind_of(controller, world.controllers)
        number, entity = self.scenery.add_robot(name, model_name, model, pose)
        start = (float(pose[0]), float(pose[1]), float(pose[2]))
        record = RobotRecord(
            name, model_name, time, start, start, "none" if kind == "none" else "running"
        )
        robot = Robot(
            number,
            name,
            model_name,
            model,
            entity,
            record,
            driver=Driver(number, kind, record, drives=model.drive is not None),
            port=self.switchboard.add_port(),
            color=model.body.color,
            fiducial=model.fiducial or 0,
            sprayers=[Sprayer(mount) for mount in model.actuators],
        )
        self.context.admit(robot)
        self.spraying.admit(robot)
        index = self.connect(robot)
        self.crew.enter(robot)
        self.server.max_connections = CONNECTIONS + CONNECTIONS_PER_ROBOT * (number + 1)
        port_number = self.serve(robot, index)
        if robot.driver.launched:
            assert controller is not None
            fields = {
                "host": reachable(self.host),
                "port": str(port_number),
                "name": name,
                "index": str(index),
                "seed": str(self.seed),
            }
            launch = launch_of(controller, world.controllers, self.loaded.folder, fields)
            variables = environment(name, self.seed, fields["host"], port_number, number + 1)
            if kind == "command":
                variables["PLAYER_INDEX"] = fields["index"]
            inherits = kind == "program"
            self.crew.launch(robot.driver, launch, variables, robot.port if inherits else None)
        return robot

    def connect(self, robot: Robot) -> int:
        """Put the robot's devices at its own port (whether or not that is opened).

        The index at which clients over TCP find its drive, or else its first device: other than
        0 only where all robots share a port.
        """
        devices = robot_devices(
            self.context, self.encoders, self.states, robot, body_size(robot.model)
        )
        found = robot.port.serve(devices)
        robot.port.directory.time = self.context.time
        if self.loaded.world.player.layout == "shared":
            found = self.share(devices, robot, full=robot.model.simulation == "full")
        return found[devices[0]].index

    def share(self, devices: list[Device], robot: Robot, full: bool) -> dict[Device, DeviceAddr]:
        """The robot's devices at the port of all robots, where there is one simulation:0."""
        if self.shared is None:
            self.shared = self.switchboard.add_port()
            self.simulation = Simulation(self.context, robot, full)
            self.shared.serve([self.simulation])
        self.simulation.admit(robot, full)
        self.shared.directory.time = self.context.time
        return self.shared.serve(d for d in devices if not isinstance(d, Simulation))

    def serve(self, robot: Robot, index: int) -> int | None:
        """Open the robot's port, if it is to be reached from outside; the port's number."""
        driver = robot.driver
        if not self.open and driver.kind not in ("command", "external"):
            return None
        if self.shared is not None:
            number = self.shared.directory.port
            if not number:
                if self.base is None:
                    number = self.bind_free(self.shared)
                else:
                    number = self.bind(self.base, self.shared)
                self.say(f"robots are served at {self.host}:{number}, by index")
        else:
            if self.base is None:
                number = self.bind_free(robot.port, driver)
            else:
                number = self.bind(self.base + robot.index if self.base else 0, robot.port)
            if not self.base or robot.index < TOLD:
                self.say(f"{robot.name} is served at {self.host}:{number}")
            elif robot.index == TOLD:
                self.say(f"further robots are served at {self.host}:{number} and the ports above")
        if driver.kind == "external":
            what = f"position2d:{index}" if driver.drives else "its devices"
            self.say(
                f"{robot.name}: waiting for a Player client at {self.host}:{number} "
                f"that subscribes {what} ({told(self.crew.patience.entry)})"
            )
            if driver.drives and index == 0 and not self.awaited_told:
                self.awaited_told = True
                self.say(
                    f"  by hand: python -m controllers.keyboard {reachable(self.host)}:{number}"
                )
        return number

    def bind_free(self, port: Port, driver: Driver | None = None) -> int:
        """Listen at a port that nobody has chosen; its number.

        Programs are told it. A client from outside, such as `controllers.keyboard`, looks for its
        robot at Player's own port unless it is told another: so the first of the robots that wait
        for one is served there, and the next at the next ports, where these are free.
        """
        controllers = self.loaded.world.controllers.values()
        if driver is None and not any(controller.external for controller in controllers):
            return self.bind(0, port)
        if driver is not None and driver.kind != "external":
            return self.bind(0, port)
        wanted = DEFAULT_PORT + self.awaited
        self.awaited += 1
        try:
            return self.bind(wanted, port)
        except OSError as error:
            if error.errno != errno.EADDRINUSE:
                raise
            self.say(f"{error.strerror}: a free port is taken instead")
            return self.bind(0, port)

    def bind(self, wanted: int, port: Port) -> int:
        """Listen at a port, 0 for any free one; its number.

        While a run is going on, the port of a robot that enters may have been taken by somebody
        else: then it gets a free one.
        """
        if not is_loopback(self.host) and not self.warned:
            self.warned = True
            self.warn(
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

    def wanted(self) -> NDArray[np.bool_]:
        """For every sensor of every robot, whether somebody reads it."""
        suite = self.scenery.suite
        if self.switchboard.changed or len(self.flags) != suite.slots:
            self.flags = np.zeros(suite.slots, bool)
            for device in self.switchboard.wanted():
                sensor = getattr(device, "sensor", None)
                if sensor is not None:
                    self.flags[suite.first_slot[device.robot.index] + sensor] = True
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


def told(patience: float) -> str:
    """How long somebody is waited for."""
    return "for ever" if patience == math.inf else f"for {patience:g} s at the most"


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach that address."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
