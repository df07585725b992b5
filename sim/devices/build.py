"""Which devices a robot has: its model's sensors and actuators on Player's interfaces."""

from __future__ import annotations

from sim.devices.batch import Encoders
from sim.devices.bits import Graphics2d, Speech, Sprayer
from sim.devices.device import Context, Device
from sim.devices.feeling import AnalogInput, Bumper
from sim.devices.laser import Laser
from sim.devices.position2d import Position2d, StateEncoder
from sim.devices.ranging import Ranger, Sonar
from sim.devices.seeing import Blobfinder, FiducialFinder, Marker
from sim.devices.simulation import Simulation
from sim.robot import Robot
from sim.stage.geometry import size_of


def robot_devices(
    context: Context,
    encoders: Encoders,
    states: StateEncoder,
    robot: Robot,
) -> list[Device]:
    """A robot's devices, in the order in which they take their interface's indices.

    A laser is served as a ranger too,
    after the model's rangers, and a ranger of several elements as a sonar: old programs ask for
    the one, newer ones for the other.
    """
    model, size = robot.model, size_of(robot.model.body)
    devices: list[Device] = []
    twins: list[Device] = []
    if model.drive is not None:
        devices.append(Position2d(context, robot, states, size))
    for slot in range(len(model.sensors)):
        group, _ = context.scenery.suite.place(robot.index, slot)
        if group.kind == "scan":
            if group.type.name == "ranger":
                devices.append(Ranger(context, encoders, robot, slot))
            else:
                devices.append(Laser(context, encoders, robot, slot))
                twins.append(Ranger(context, encoders, robot, slot))
        elif group.kind == "elements":
            devices.append(Ranger(context, encoders, robot, slot))
            twins.append(Sonar(context, encoders, robot, slot))
        elif group.kind == "intensities":
            devices.append(Ranger(context, encoders, robot, slot))
        elif group.kind == "blobs":
            devices.append(Blobfinder(context, encoders, robot, slot))
        elif group.kind == "fiducials":
            devices.append(FiducialFinder(context, robot, slot))
        elif group.kind == "bits":
            devices.append(Bumper(context, robot, slot, size))
        else:
            devices.append(AnalogInput(context, robot, slot))
    if model.fiducial and not any(isinstance(device, FiducialFinder) for device in devices):
        devices.append(Marker(context, robot, size))
    devices += twins
    devices += [Sprayer(context, robot, index) for index in range(len(model.actuators))]
    devices += [
        Speech(context, robot),
        Graphics2d(context, robot),
        Simulation(context, robot, model.simulation == "full"),
    ]
    return devices
