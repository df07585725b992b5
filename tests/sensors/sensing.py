"""A scene with robots for the tests of single sensors."""

from __future__ import annotations

import numpy as np

from sensors.registry import settings_for
from sensors.scene import Scene
from sensors.suite import Suite

RED, GREEN, BLUE = 0xFF0000, 0x00FF00, 0x0000FF
BOX = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])


class Stage:
    """A suite and its scene; things are added by short calls."""

    def __init__(self, seed: int = 1) -> None:
        self.scene = Scene()
        self.suite = Suite(self.scene, seed)
        self.robots = 0

    def box(self, x, y, heading=0.0, *, size=(1, 1), color=RED, height=1.0, fiducial=0):
        entity = self.scene.add_entity(
            color=color, height=height, fiducial=fiducial, pose=(x, y, heading)
        )
        self.scene.add_polygon(entity, BOX * size)
        return entity

    def wall(self, *segment, color=RED, height=1.0):
        entity = self.scene.add_entity(color=color, height=height)
        self.scene.add_segments(entity, [segment])
        return entity

    def robot(self, x, y, heading=0.0, *specs, color=GREEN, fiducial=0, name=None):
        """A box with sensors; returns the robot's index. Its entity is that of `entity(robot)`."""
        entity = self.box(x, y, heading, color=color, fiducial=fiducial)
        self.robots += 1
        settings = [settings_for(spec) for spec in specs]
        return self.suite.add_robot(entity, name or f"r{self.robots}", settings)

    def sense(self, tick=0, **kwargs):
        self.scene.refresh()
        self.suite.sense(tick, tick * 0.1, **kwargs)

    def data(self, robot=0, index=0):
        return self.suite.reading(robot, index).data
