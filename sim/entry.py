"""A robot enters: its body, its devices, the port where they are served, its controller."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sim.build import LoadedWorld
from sim.devices.device import Context
from sim.devices.switchboard import Port, Switchboard
from sim.fleet.crew import Crew
from sim.fleet.driver import Driver, Kind
from sim.fleet.functions import Controller, Controllers, DirectClient, Functions
from sim.fleet.launching import environment, kind_of, launch_of, robot_seed
from sim.ports import Ports, reachable
from sim.result import RobotRecord
from sim.robot import MountedSprayer, Robot
from sim.sensing import Sensing
from sim.spray import Spraying
from sim.stage.geometry import wrapped


@dataclass
class Entry:
    """Brings robots into a run, at its start and through doors.

    Those that clients can reach are `held` at the start until all have entered: who connects is
    answered at once.
    """

    loaded: LoadedWorld
    seed: int
    context: Context
    switchboard: Switchboard
    sensing: Sensing
    spraying: Spraying
    ports: Ports
    crew: Crew
    controllers: Controllers
    functions: Functions
    held: list[tuple[Robot, str | None]] | None = field(default_factory=list)

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
        kind, function = self.driven_by(controller)
        index, entity = self.context.scenery.add_robot(name, model_name, model, pose)
        start = (float(pose[0]), float(pose[1]), float(wrapped(pose[2])))
        record = RobotRecord(
            name, model_name, time, start, start, "none" if kind == "none" else "running"
        )
        robot = Robot(
            index,
            name,
            model_name,
            model,
            entity,
            record,
            driver=Driver(index, kind, record, drives=model.drive is not None),
            open_port=self.open_port,
            color=int(self.context.scenery.scene.colors[entity]),
            fiducial=model.fiducial or 0,
            sprayers=[MountedSprayer(one) for one in model.actuators if one.type == "sprayer"],
        )
        self.context.admit(robot)
        self.spraying.admit(robot)
        grips = any(one.type == "gripper" for one in model.actuators)
        if self.ports.shares or grips or model.battery is not None:
            robot.port  # noqa: B018 - its devices take their places, paddles show, batteries drain
        self.crew.drivers.enter(robot)
        if function is not None:
            client = DirectClient(
                name,
                robot_seed(self.seed, name),
                robot.port,
                self.sensing.read,
                self.switchboard.note_answer,
                self.context,
            )
            self.functions.add(index, client, function)
        if self.held is not None and self.ports.serves(robot):
            self.held.append((robot, controller))
        else:
            self.serve(robot, controller)
        return robot

    def open_port(self, robot: Robot) -> Port:
        """A port with a robot's devices, whether or not anybody can come to it."""
        port = self.switchboard.add_port()
        self.ports.place(port, robot, self.sensing.devices(robot))
        return port

    def serve_held(self) -> None:
        """All robots of the start are there: let clients come, and later robots' at once."""
        held, self.held = self.held or [], None
        for robot, controller in held:
            self.serve(robot, controller)

    def serve(self, robot: Robot, controller: str | None) -> None:
        """Open a robot's port, if it is to have one, and start its controller."""
        number = self.ports.serve(robot)
        if number is not None or robot.driver.launched:
            self.switchboard.reach(robot.port, self.ports.shared)
        if robot.driver.launched:
            assert controller is not None
            self.launch(robot, controller, number)

    def driven_by(self, controller: str | None) -> tuple[Kind, Controller | None]:
        """How robots of a controller are driven in this run, and the function if one drives."""
        kind = kind_of(controller, self.loaded.world.controllers)
        if controller is None or isinstance(self.controllers, bool):
            return (kind if self.controllers else "none"), None
        told = self.controllers.get(controller, False)
        if callable(told):
            return "function", told
        return (kind if told else "none"), None

    def launch(self, robot: Robot, controller: str, number: int | None) -> None:
        """Start a robot's controller; clients over TCP find it at port `number`."""
        fields = {
            "host": reachable(self.ports.host),
            "port": str(number),
            "name": robot.name,
            "index": str(robot.port.first),
            "seed": str(self.seed),
        }
        controllers = self.loaded.world.controllers
        launch = launch_of(controller, controllers, self.loaded.folder, fields)
        variables = environment(robot.name, self.seed, fields["host"], number, robot.index + 1)
        by_command = robot.driver.kind == "command"
        if by_command:
            variables["PLAYER_INDEX"] = fields["index"]
        self.crew.launch(robot.driver, launch, variables, None if by_command else robot.port)
