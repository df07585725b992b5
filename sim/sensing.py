"""What is perceived in a tick: which sensors are read, and the readings as messages.

Rules: only what somebody reads is computed. All robots perceive in one batch, from where all stand
at the end of the tick. A reading is encoded once for all who read it, when the first asks for it;
so perceiving twice within a tick gives the same twice.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from player.server import Connection
from sim.devices.build import robot_devices
from sim.devices.device import Context, Device
from sim.devices.encoding import Encodings
from sim.devices.switchboard import Switchboard
from sim.robot import Robot


class Sensing:
    """The perception of a run. `everything`: also what nobody reads."""

    def __init__(
        self, context: Context, switchboard: Switchboard, *, everything: bool = False
    ) -> None:
        self.context = context
        self.scenery = context.scenery
        self.switchboard = switchboard
        self.everything = everything
        self.encodings = Encodings()
        self.tick = 0
        self.flags: NDArray[np.bool_] = np.zeros(0, bool)  # by sensor
        self.asked: set[int] = set()  # slots of sensors that are read from Python
        self.logged: frozenset[str] = frozenset()  # types of sensors that a log reads, or `all`

    def devices(self, robot: Robot) -> list[Device]:
        """A robot's devices, whose readings are made here."""
        return robot_devices(self.context, self.encodings, robot)

    def sense(self, tick: int, time: float) -> None:
        """Bring what can be seen, felt and measured by wheels up to date, and perceive it."""
        self.scenery.refresh()
        self.scenery.odometry.update(self.scenery.stage.poses, self.context.interval, tick)
        self.perceive(tick, time)

    def perceive(self, tick: int, time: float) -> None:
        """All robots perceive what is read."""
        scenery, stage = self.scenery, self.scenery.stage
        wanted = None if self.everything else self.wanted()
        scenery.suite.sense(tick, time, wanted)
        self.tick = tick
        self.encodings.round += 1
        self.encodings.states.update(scenery.odometry.poses, stage.velocities, stage.stalls)

    def want(self, slots: NDArray[np.int64]) -> None:
        """Sensors, by their slots (k,), are read from Python from now on, and at once."""
        new = set(slots.tolist()) - self.asked
        if not new:
            return
        self.asked |= new
        self.switchboard.changed = True
        self.perceive(self.tick, self.context.time)

    def read(self, device: Device) -> None:
        """A device is read from Python from now on, and has its reading of this tick."""
        sensor = getattr(device, "sensor", None)
        if sensor is not None:
            suite = self.scenery.suite
            self.want(np.array([suite.first_slot[device.robot.index] + sensor]))

    def show_again(self, connection: Connection) -> None:
        """Hand a client the readings of the present moment, also of what it has just subscribed."""
        if self.switchboard.changed:
            self.perceive(self.tick, self.context.time)
        self.switchboard.show_again(connection, self.context.time)

    def look_again(self) -> None:
        """Something was moved by hand: bring what is read up to date within the tick."""
        self.scenery.refresh()
        self.perceive(self.tick, self.context.time)

    def wanted(self) -> NDArray[np.bool_]:
        """For every sensor of every robot, whether somebody reads it."""
        suite = self.scenery.suite
        if self.switchboard.changed or len(self.flags) != suite.slots:
            self.flags = np.zeros(suite.slots, bool)
            for device in self.switchboard.wanted():
                sensor = getattr(device, "sensor", None)
                if sensor is not None:
                    self.flags[suite.first_slot[device.robot.index] + sensor] = True
            self.flags[list(self.asked)] = True
            if self.logged:
                types = None if "all" in self.logged else self.logged
                self.flags[suite.slots_of(types)] = True
            self.switchboard.changed = False
        return self.flags
