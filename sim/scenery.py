"""The physical world of a run: stage, scene, sensors, odometry and floor, joined by robot index."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sensors.eyes import eyes
from sensors.noise import random_color
from sensors.odometry import Odometry
from sensors.scene import Scene
from sensors.suite import Suite
from sensors.view import Contacts
from sim.build import LoadedWorld
from sim.robot import Robot
from sim.stage.floor import FloorPaint
from sim.stage.geometry import faces
from sim.stage.layout import Layout
from sim.stage.stage import Stage
from sim.worldfile.schema import Model
from sim.worldfile.values import RANDOM

Floats = NDArray[np.float64]


class Scenery:
    """All that moves, is seen and is painted. Robots keep the index at which they entered."""

    def __init__(self, loaded: LoadedWorld, seed: int) -> None:
        world, layout = loaded.world, loaded.layout
        self.stage = Stage(layout, world.models, world.clock)
        self.scene = Scene()
        self.suite = Suite(self.scene, seed)
        self.odometry = Odometry(seed)
        self.floor = FloorPaint(layout, world.floor.resolution)
        self.start_poses: Floats = loaded.place(seed)
        self._entities: NDArray[np.int64] = np.zeros(8, np.int64)  # with room for more robots
        self.add_walls(layout)
        self.movables = np.array(
            [
                self.add_body(movable.body, movable.body.fiducial or 0, movable.pose)
                for movable in layout.movables
            ],
            np.int64,
        )
        for landmark in layout.landmarks:
            self.add_body(landmark.body, landmark.body.fiducial, landmark.pose)

    def add_walls(self, layout: Layout) -> None:
        """One entity for what stands and looks alike."""
        scene, entities = self.scene, {}
        rounds = [
            (solid, solid.circle)
            for solid in layout.solids
            if solid.circle is not None and not solid.landmark
        ]
        for look in dict.fromkeys([*layout.looks, *(solid.look for solid, _ in rounds)]):
            entities[look] = scene.add_entity(
                color=look.color,
                height=look.height,
                solid=look.solid,
                seen_by=look.seen_by,
                bottom=look.z,
            )
        for number, look in enumerate(layout.looks):
            scene.add_segments(entities[look], layout.segments[layout.segment_looks == number])
        for solid in layout.insides:
            scene.add_solid(entities[solid.look], solid.vertices)
        for solid, (x, y, radius) in rounds:
            scene.add_circle(entities[solid.look], radius, (x, y))

    def add_body(self, body: Any, fiducial: int, pose: Any, color: int | None = None) -> int:
        """A body of the schema that sensors see, with a fiducial or 0; its entity.

        color: 0xRRGGBB, in place of the body's own.
        """
        entity = self.scene.add_entity(
            color=body.color if color is None else color,
            height=body.height,
            fiducial=fiducial,
            pose=tuple(map(float, pose)),
            solid=body.solid,
            seen_by=eyes(body.seen_by),
            bottom=body.z,
        )
        for vertices, circle in faces(body):
            if circle is not None:
                self.scene.add_circle(entity, circle[2], circle[:2])
            else:
                self.scene.add_polygon(entity, vertices)
        return entity

    def add_robot(self, name: str, model_name: str, model: Model, pose: Floats) -> tuple[int, int]:
        """A robot enters: its body, what others see of it, its sensors and odometry.

        Its index, and its entity in the scene.
        """
        robot = self.stage.add_robot(model_name, pose)
        body = model.body
        color = random_color(self.suite.seed, name) if body.color == RANDOM else body.color
        entity = self.add_body(body, model.fiducial or 0, pose, color)
        if robot == len(self._entities):
            self._entities = np.concatenate([self._entities, np.zeros_like(self._entities)])
        self._entities[robot] = entity
        noise, origin = model.odometry_noise, model.odometry_origin
        self.suite.add_robot(entity, name, model.sensors)
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

    @property
    def entities(self) -> NDArray[np.int64]:
        """(n,) the entity in the scene of each robot."""
        return self._entities[: self.stage.count]

    def refresh(self) -> None:
        """Bring what can be seen and felt up to date with the bodies."""
        if len(self.entities):
            self.scene.move(self.entities, self.stage.poses)
        if len(self.movables):
            self.scene.move(self.movables, self.stage.movable_poses)
        self.scene.refresh()
        self.suite.contacts = Contacts(*self.stage.stretches)

    def put(self, poses: Mapping[int, tuple[float, float, float]]) -> list[int]:
        """Put robots at poses in the world by hand, all at once: no wheel turns.

        Returns those for whom there is no room: they stay where they are.
        """
        staying = self.stage.set_poses(poses)
        for robot, pose in poses.items():
            if robot not in staying:
                self.odometry.relocate(robot, pose)
        return staying

    def set_color(self, robot: Robot, color: int) -> None:
        """Give a robot's body another colour: cameras see it from the next reading on."""
        robot.color = color
        self.scene.colors[robot.entity] = color

    def set_fiducial(self, robot: Robot, fiducial: int) -> None:
        """Fiducial finders see a robot with another id from the next reading on."""
        self.scene.fiducials[robot.entity] = fiducial
