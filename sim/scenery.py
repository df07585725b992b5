"""The physical world of a run: stage, scene, sensors, odometry and floor, joined by robot index."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sensors.odometry import Odometry
from sensors.scene import Scene
from sensors.suite import Suite
from sensors.view import Contacts
from sim.build import LoadedWorld
from sim.robot import Robot
from sim.stage.floor import FloorPaint
from sim.stage.geometry import outline
from sim.stage.layout import Layout
from sim.stage.stage import Stage
from sim.worldfile.schema import Model

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
                self.add_body(movable.body, movable.color, movable.height, 0, movable.pose)
                for movable in layout.movables
            ],
            np.int64,
        )

    def add_walls(self, layout: Layout) -> None:
        """One entity for what stands of each colour and height."""
        scene, entities = self.scene, {}
        faces = list(zip(layout.segment_colors, layout.segment_heights, strict=True))
        rounds = [(solid, solid.circle) for solid in layout.solids if solid.circle is not None]
        for look in dict.fromkeys([*faces, *((solid.color, solid.height) for solid, _ in rounds)]):
            color, height = look
            entity = scene.add_entity(color=int(color), height=float(height))
            entities[look] = entity
            same = (layout.segment_colors == color) & (layout.segment_heights == height)
            scene.add_segments(entity, layout.segments[same])
        for solid in layout.insides:
            scene.add_solid(entities[solid.color, solid.height], solid.vertices)
        for solid, (x, y, radius) in rounds:
            scene.add_circle(entities[solid.color, solid.height], radius, (x, y))

    def add_body(self, body: Any, color: int, height: float, fiducial: int, pose: Any) -> int:
        """A body that sensors see; its entity."""
        entity = self.scene.add_entity(
            color=color, height=height, fiducial=fiducial, pose=tuple(map(float, pose))
        )
        if body.shape == "circle":
            self.scene.add_circle(entity, body.radius)
        else:
            self.scene.add_polygon(entity, outline(body))
        return entity

    def add_robot(self, name: str, model_name: str, model: Model, pose: Floats) -> tuple[int, int]:
        """A robot enters: its body, what others see of it, its sensors and odometry.

        Its index, and its entity in the scene.
        """
        robot = self.stage.add_robot(model_name, pose)
        body = model.body
        entity = self.add_body(body, body.color, body.height, model.fiducial or 0, pose)
        if robot == len(self._entities):
            self._entities = np.concatenate([self._entities, np.zeros_like(self._entities)])
        self._entities[robot] = entity
        noise = model.odometry_noise
        self.suite.add_robot(entity, name, model.sensors)
        self.odometry.add_robot(
            name,
            tuple(map(float, pose)),
            gps=model.localization == "gps",
            slip=noise.slip if noise else 0.0,
            turn=noise.turn if noise else 0.0,
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
