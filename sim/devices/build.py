"""Which devices a robot has: its model's sensors and actuators on Player's interfaces."""

from __future__ import annotations

from collections.abc import Callable

from sensors.suite import Group
from sim.devices.aio import Aio
from sim.devices.blobfinder import Blobfinder
from sim.devices.bumper import Bumper
from sim.devices.device import Context, Device
from sim.devices.dio import Dio
from sim.devices.encoding import Encodings
from sim.devices.fiducial import FiducialFinder, Marker
from sim.devices.graphics2d import Graphics2d
from sim.devices.laser import Laser
from sim.devices.position2d import Position2d
from sim.devices.ranger import Ranger
from sim.devices.simulation import Simulation
from sim.devices.sonar import Sonar
from sim.devices.speech import Speech
from sim.robot import Robot

SensorMaker = Callable[[Context, Encodings, Robot, int], Device]

SENSORS: dict[str, tuple[SensorMaker, ...]] = {
    "scan": (Laser, Ranger),
    "elements": (Ranger, Sonar),
    "intensities": (Ranger,),
    "blobs": (Blobfinder,),
    "fiducials": (FiducialFinder,),
    "bits": (Bumper,),
    "scalars": (Aio,),
}
"""The devices of a sensor, by the kind of its readings: its own, and its twins for programs that
ask for an older or a newer interface."""


def served_as(group: Group) -> tuple[SensorMaker, ...]:
    """The devices of a group's sensors: a scan that is called a ranger is no laser."""
    makers = SENSORS[group.kind]
    return makers[1:] if group.type.name == "ranger" and group.kind == "scan" else makers


def robot_devices(context: Context, encodings: Encodings, robot: Robot) -> list[Device]:
    """A robot's devices, in the order in which they take their interface's indices.

    A sensor's twins come after all sensors' own devices: the model's first ranger is ranger:0,
    whether or not it also has a laser.
    """
    model = robot.model
    devices: list[Device] = []
    twins: list[Device] = []
    if model.drive is not None:
        devices.append(Position2d(context, encodings, robot))
    for sensor in range(len(model.sensors)):
        group, _ = context.scenery.suite.place(robot.index, sensor)
        own, *others = (make(context, encodings, robot, sensor) for make in served_as(group))
        devices.append(own)
        twins += others
    if model.fiducial and not any(isinstance(device, FiducialFinder) for device in devices):
        devices.append(Marker(context, robot))
    return [
        *devices,
        *twins,
        *(Dio(context, robot, index) for index in range(len(model.actuators))),
        Speech(context, robot),
        Graphics2d(context, robot),
        Simulation(context, robot, model.simulation == "full"),
    ]
