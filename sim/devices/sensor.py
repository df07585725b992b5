"""What the devices of sensors share: a sensor of one robot, and where its readings stand."""

from __future__ import annotations

from player import DeviceAddr
from sensors.laser import LaserSettings
from sensors.ranger import RangerSettings
from sensors.suite import Group
from sim.devices.device import Context, Values
from sim.devices.encoding import Encodings, GroupEncoder
from sim.robot import Robot

SENSOR_SIZE = (0.02, 0.02, 0.02)
"""Width, length, height in metres: what Stage says of an element; nothing depends on it."""

Size = tuple[float, float, float]


class SensorDevice:
    """A sensor on one of Player's interfaces. `sensor` is its number among its robot's own."""

    addr: DeviceAddr

    def __init__(self, context: Context, encodings: Encodings, robot: Robot, sensor: int) -> None:
        self.context = context
        self.encodings = encodings
        self.robot = robot
        self.sensor = sensor
        group, self.row = context.scenery.suite.place(robot.index, sensor)
        self.group: Group = group
        self.encoders: dict[str, GroupEncoder] = {}

    @property
    def mount(self) -> tuple[float, float, float]:
        """Where it is on the robot: metres and radians."""
        x, y, heading = self.group.settings.mount
        return (float(x), float(y), float(heading))

    @property
    def size(self) -> Size:
        """Width, length and height of its housing, m, where its settings know of one."""
        settings = self.group.settings
        if not isinstance(settings, LaserSettings | RangerSettings):
            return SENSOR_SIZE
        length, width = settings.housing
        return (width, length, SENSOR_SIZE[2])

    def encoder(self, message: str) -> GroupEncoder:
        """What encodes one of the messages that are encoded in batches."""
        encoder = self.encoders.get(message)
        if encoder is None:
            encoder = self.encoders[message] = self.encodings.encoder(self.group, message)
        return encoder

    def payload(self, message: str) -> bytes:
        """This tick's reading as such a message."""
        return self.encoder(message).payload(self.row, self.encodings.round)

    def command(self, name: str, values: Values) -> None:
        """There are no commands."""
