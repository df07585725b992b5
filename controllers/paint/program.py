"""The program that drives one painting robot: devices in, the brain's command out."""

from __future__ import annotations

import dataclasses
import sys

from player import (
    BlobfinderProxy,
    DioProxy,
    LaserProxy,
    PlayerClient,
    Position2dProxy,
    SimulationProxy,
    SpeechProxy,
)

from .brain import Brain, Reading
from .cycle import step
from .geometry import Pose
from .options import parse

FAILED = 1
"""Exit code when the robot gave up, or what it sees contradicts what it was told."""


def main() -> None:
    """Drive one robot until it has painted its strip, or the run is over."""
    settings = parse()
    with PlayerClient() as robot:
        base = Position2dProxy(robot)
        laser = LaserProxy(robot)
        camera = BlobfinderProxy(robot)
        sprayer = DioProxy(robot) if settings.paint else None
        speech = SpeechProxy(robot)
        simulation = SimulationProxy(robot)
        brain: Brain | None = None
        spraying = False
        last = 0.0
        while robot.read():
            if not (base.valid and laser.valid and camera.valid):
                continue
            if brain is None:
                brain = Brain(settings, robot.rng().random)
            elif robot.time > last:
                interval = min(max(robot.time - last, 0.02), 0.5)
                brain.settings = dataclasses.replace(
                    settings, limits=settings.limits._replace(interval=interval)
                )
            last = robot.time
            command = step(
                brain,
                Reading(
                    robot.time,
                    Pose(base.x, base.y, base.yaw),
                    laser.ranges,
                    laser.bearings,
                    laser.max_range,
                    camera.blobs,
                    camera.width,
                ),
            )
            for key, value in command.report.items():
                simulation.report(key, value)
            if command.say is not None:
                speech.say(command.say)
            if command.warning is not None:
                print(f"paint: {command.warning}", file=sys.stderr)
            if sprayer is not None and command.spray != spraying:
                spraying = command.spray
                sprayer.set_output(int(spraying))
            if command.failure is not None or command.finished:
                base.set_speed(0.0, 0.0)
                robot.read()
                if command.failure is not None:
                    print(f"paint: {command.failure}", file=sys.stderr)
                    sys.exit(FAILED)
                return
            base.set_speed(command.motion.ahead, command.motion.turn, vy=command.motion.left)
