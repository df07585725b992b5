"""speech: what a robot says is kept with the time, and shown in the video."""

from __future__ import annotations

from collections.abc import Iterable

from player import DeviceAddr
from player.codes import Interface
from sim.devices.device import Context, Refused, Values
from sim.robot import Robot

MAX_SAID = 10_000
"""Sentences kept of one robot."""
LONGEST_SAID = 1_000
"""Characters kept of one sentence."""


class Speech:
    """What a robot says: kept with the time, shown in the video."""

    def __init__(self, context: Context, robot: Robot) -> None:
        self.context = context
        self.robot = robot
        self.addr = DeviceAddr(Interface.SPEECH, 0)
        self.count = 0  # of what is said, or is going to be

    def publish(self) -> Iterable[tuple[int, bytes]]:
        return ()

    def command(self, name: str, values: Values) -> None:
        if name == "say" and self.count < MAX_SAID:
            self.count += 1
            text = values["text"][:LONGEST_SAID]
            self.context.later(self.robot, lambda: self.say(text))

    def say(self, text: str) -> None:
        self.robot.record.said.append((self.context.time, text))

    def request(self, name: str, values: Values) -> Values | None:
        raise Refused


def devices(context: Context, robot: Robot) -> Iterable[Speech]:
    """Every robot can speak."""
    return [Speech(context, robot)]
