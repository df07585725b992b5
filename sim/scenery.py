"""The physical world of a run: stage, scene, sensors, odometry and floor, joined by robot index."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from sensors.odometry import Odometry
from sensors.view import Contacts
from sim.build import LoadedWorld
from sim.robot import Robot
from sim.stage.floor import FloorPaint
from sim.stage.stage import Stage
from sim.surroundings import Surroundings
from sim.worldfile.schema import Model

Floats = NDArray[np.float64]


class Scenery:
    """All that moves, is seen and is painted. Robots keep the index at which they entered."""

    def __init__(self, loaded: LoadedWorld, seed: int) -> None:
        world, layout = loaded.world, loaded.layout
        self.stage = Stage(layout, world.models, world.clock)
        self.surroundings = Surroundings(layout, seed)
        self.scene, self.suite = self.surroundings.scene, self.surroundings.suite
        self.odometry = Odometry(seed)
        self.suite.contacts = lambda: Contacts(*self.stage.stretches)
        self.floor = FloorPaint(layout, world.floor.resolution)
        self.start_poses: Floats = loaded.place(seed)

    def add_robot(self, name: str, model_name: str, model: Model, pose: Floats) -> tuple[int, int]:
        """A robot enters: its body, what others see of it, its sensors and odometry.

        Its index, and its entity in the scene.
        """
        robot = self.stage.add_robot(model_name, pose)
        entity = self.surroundings.add_robot(name, model, pose)
        noise, origin = model.odometry_noise, model.odometry_origin
        self.odometry.add_robot(
            name,
            tuple(map(float, pose)),
            gps=model.localization == "gps",
            slip=noise.slip if noise else 0.0,
            turn=noise.turn if noise else 0.0,
            bias=noise.bias if noise else (0.0, 0.0, 0.0),
            frame=None if origin is None else (*origin[:2], math.radians(origin[2])),
        )
        return robot, entity

    def refresh(self) -> None:
        """Bring what can be seen up to date with the bodies."""
        self.surroundings.refresh(self.stage.poses, self.stage.movable_poses)

    def put(self, poses: Mapping[int, tuple[float, float, float]]) -> list[int]:
        """Put robots at poses in the world by hand, all at once: no wheel turns.

        Returns those for whom there is no room: they stay where they are.
        """
        staying = self.stage.set_poses(poses)
        for robot, pose in poses.items():
            if robot not in staying:
                self.odometry.relocate(robot, pose)
        return staying

    def put_thing(self, number: int, pose: tuple[float, float, float]) -> bool:
        """Put a thing at a pose in the world by hand; False where there is no room for it.

        Things are the obstacles that can be pushed, and after them the layout's fixtures.
        """
        found = self.stage.put_thing(number, pose)
        fixture = number - len(self.surroundings.movables)
        if found and fixture >= 0:
            self.surroundings.put_fixture(fixture, pose)
        return found

    def set_color(self, robot: Robot, color: int) -> None:
        """Give a robot's body another colour: cameras see it from the next reading on."""
        robot.color = color
        self.scene.colors[robot.entity] = color

    def set_fiducial(self, robot: Robot, fiducial: int) -> None:
        """Fiducial finders see a robot with another id from the next reading on."""
        self.scene.fiducials[robot.entity] = fiducial
