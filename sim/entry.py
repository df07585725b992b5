"""A robot enters: its body, its devices, the port where they are served, its controller."""

from __future__ import annotations

import ipaddress
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from player.server import Server
from sim.devices.batch import Encoders
from sim.devices.build import robot_devices
from sim.devices.device import Context
from sim.devices.position2d import StateEncoder
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


class Entry:
    """Brings robots into a run, at its start and through doors."""

    def __init__(
        self,
        loaded: LoadedWorld,
        seed: int,
        listen: tuple[str, int] | None,
        scenery: Scenery,
        context: Context,
        switchboard: Switchboard,
        sprayers: Sprayers,
        crew: Crew,
        server: Server,
        say: Callable[[str], None],
    ) -> None:
        player = loaded.world.player
        self.loaded = loaded
        self.seed = seed
        self.scenery = scenery
        self.context = context
        self.switchboard = switchboard
        self.sprayers = sprayers
        self.crew = crew
        self.server = server
        self.say = say
        self.host, self.base = listen or (player.host, player.port)
        self.open = self.base is not None
        self.shared: Port | None = None
        self.encoders = Encoders()
        self.states = StateEncoder()
        self.flags: NDArray[np.bool_] = np.zeros(0, bool)
        if not is_loopback(self.host) and self.open:
            say(f"listening on {self.host}: anybody who reaches this address can drive the robots")

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
        port = self.add_port(robot, model)
        driver = Driver(robot, kind, record)
        self.crew.add(driver)
        number = self.listen(port, driver)
        if driver.launched:
            assert controller is not None
            fields = {
                "host": self.host,
                "port": str(number),
                "name": name,
                "index": "0",
                "seed": str(self.seed),
            }
            launch = launch_of(controller, world.controllers, self.loaded.folder, fields)
            variables = environment(name, self.seed, self.host, number)
            self.crew.launch(driver, launch, variables, port if kind == "program" else None)
        return robot

    def add_port(self, robot: int, model: Model) -> Port:
        """The robot's devices, at a port of their own (whether or not it is opened)."""
        devices = robot_devices(
            self.context, self.encoders, self.states, robot, model, body_size(model)
        )
        port = self.switchboard.add_port()
        port.serve(devices)
        port.directory.time = self.context.time
        if self.loaded.world.player.layout == "shared":
            if self.shared is None:
                self.shared = self.switchboard.add_port()
            self.shared.serve(devices)
        return port

    def listen(self, port: Port, driver: Driver) -> int | None:
        """Open the robot's port, if it is to be reached from outside; the port's number."""
        if not self.open and driver.kind not in ("command", "external"):
            return None
        if self.shared is not None:
            if not self.shared.directory.port:
                _, number = self.server.listen(self.host, self.base or 0, self.shared.directory)
                self.say(f"robots are served at {self.host}:{number}, by index")
            number = self.shared.directory.port
        else:
            wanted = self.base + driver.robot if self.base else 0
            _, number = self.server.listen(self.host, wanted, port.directory)
            if driver.kind != "command":
                self.say(f"{driver.record.name} is served at {self.host}:{number}")
        if driver.kind == "external":
            self.say(
                f"{driver.record.name}: waiting for a Player client at {self.host}:{number} "
                f"(for {self.crew.patience.entry:g} s at the most)"
            )
        return number

    def wanted(self) -> NDArray[np.bool_]:
        """For every sensor of every robot, whether somebody reads it."""
        suite = self.scenery.suite
        if self.switchboard.changed or len(self.flags) != suite.slots:
            self.flags = np.zeros(suite.slots, bool)
            for device in self.switchboard.wanted():
                sensor = getattr(device, "sensor", None)
                if sensor is not None:
                    self.flags[suite.first_slot[device.robot] + sensor] = True
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


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach that address."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
