"""Which devices a robot has: its model's sensors and actuators on Player's interfaces."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from importlib import import_module

from sensors.suite import Group
from sim.devices.aio import Aio
from sim.devices.blobfinder import Blobfinder
from sim.devices.bumper import Bumper
from sim.devices.device import Context, Device
from sim.devices.encoding import Encodings
from sim.devices.fiducial import FiducialFinder, Marker
from sim.devices.laser import Laser
from sim.devices.position2d import Position2d
from sim.devices.ranger import Ranger
from sim.devices.sonar import Sonar
from sim.robot import Robot

SensorMaker = Callable[[Context, Encodings, Robot, int], Device]
Maker = Callable[[Context, Robot], Iterable[Device]]

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


OTHERS = (
    "dio",
    "gripper",
    "power",
    "speech",
    "graphics2d",
    "simulation",
)
"""The devices that are no sensors: each is a module of this folder, whose `devices(context, robot)`
gives those that a robot has. A new one is a file here and its line above."""

MAKERS: list[Maker] = [import_module(f"sim.devices.{name}").devices for name in OTHERS]


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
        *(device for make in MAKERS for device in make(context, robot)),
    ]
