"""What robots perceive of a world: all that stands and moves, and the sensors that look at it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sensors.eyes import eyes
from sensors.noise import random_color
from sensors.scene import Scene
from sensors.suite import Suite
from sim.stage.geometry import carried, faces
from sim.worldfile.values import RANDOM

if TYPE_CHECKING:
    from sim.stage.layout import Layout
    from sim.stage.standing import Look
    from sim.worldfile.schema import Model

Floats = NDArray[np.float64]


class Surroundings:
    """The sensors' scene of a world, and the sensors of its robots, by robot index.

    What is perceived follows from where all stand, the seed and the tick alone: whoever has these
    perceives what the run's robots did.
    """

    def __init__(self, layout: Layout, seed: int) -> None:
        self.scene = Scene()
        self.suite = Suite(self.scene, seed)
        self.count = 0
        """Robots that have entered."""
        self._faces: dict[int, tuple[Any, list[Any]]] = {}  # by id of the body, which it holds
        self._fixtures = layout.fixtures
        self._owners = self._add_walls(layout)  # of fixtures made of walls, by their groups
        self.movables = np.array(
            [
                self._add_body(movable.body, movable.body.fiducial or 0, movable.pose)
                for movable in layout.movables
            ],
            np.int64,
        )
        landmarks = [
            self._add_body(landmark.body, landmark.body.fiducial, landmark.pose)
            for landmark in layout.landmarks
        ]
        self._landmarks = [next(iter(landmarks[one.landmarks]), None) for one in layout.fixtures]
        self._first = len(self.scene)  # robots' entities come one after the other

    def add_robot(self, name: str, model: Model, pose: Any) -> int:
        """A robot enters: what others see of it, and its sensors. Its entity in the scene."""
        body = model.body
        color = random_color(self.suite.seed, name) if body.color == RANDOM else body.color
        entity = self._add_body(body, model.fiducial or 0, pose, color)
        self.count += 1
        self.suite.add_robot(entity, name, model.sensors)
        return entity

    @property
    def entities(self) -> NDArray[np.int64]:
        """(n,) the entity in the scene of each robot."""
        return np.arange(self._first, self._first + self.count)

    def sensors_of(self, robot: int) -> int:
        """How many sensors a robot has."""
        firsts = [*self.suite.first_slot[robot : robot + 2], self.suite.slots]
        return firsts[1] - firsts[0]

    def refresh(self, poses: Floats, movable_poses: Floats) -> None:
        """What can be seen is where it is now: poses of robots (n, 3) and of movables (m, 3)."""
        self.scene.poses[self._first : self._first + self.count] = poses
        if len(self.movables):
            self.scene.move(self.movables, movable_poses)
        self.scene.refresh()

    def put_fixture(self, number: int, pose: tuple[float, float, float]) -> None:
        """What stands is seen at another pose from the next refresh on."""
        one, entity = self._fixtures[number], self._landmarks[number]
        if entity is None:
            entity, pose = self._owners[one.group], carried(one.start, pose)
        self.scene.move([entity], [pose])

    def _add_walls(self, layout: Layout) -> dict[int, int]:
        """One entity for what stands and looks alike, and one for each fixture, by its group."""
        scene, entities, owners = self.scene, {}, {}
        rounds = [
            (solid, solid.circle)
            for solid in layout.solids
            if solid.circle is not None and not solid.landmark
        ]

        def add(look: Look) -> int:
            return scene.add_entity(
                color=look.color,
                height=look.height,
                solid=look.solid,
                seen_by=look.seen_by,
                bottom=look.z,
            )

        for look in dict.fromkeys([*layout.looks, *(solid.look for solid, _ in rounds)]):
            entities[look] = add(look)
        whose = np.full(len(layout.segments), -1)
        for one in layout.fixtures:
            if one.landmarks.start == one.landmarks.stop:
                owners[one.group] = add(layout.solids[one.solids][0].look)
                whose[one.segments] = owners[one.group]
        for number, look in enumerate(layout.looks):
            rows = np.flatnonzero(layout.segment_looks == number)
            ends = np.flatnonzero(np.diff(whose[rows])) + 1  # in their order, which settles draws
            for run in np.split(rows, ends):
                owner = int(whose[run[0]])
                scene.add_segments(entities[look] if owner < 0 else owner, layout.segments[run])
        for solid in layout.insides:
            scene.add_solid(owners.get(solid.group, entities[solid.look]), solid.vertices)
        for solid, (x, y, radius) in rounds:
            scene.add_circle(owners.get(solid.group, entities[solid.look]), radius, (x, y))
        return owners

    def _add_body(self, body: Any, fiducial: int, pose: Any, color: int | None = None) -> int:
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
        known = self._faces.get(id(body))
        if known is None:
            known = self._faces[id(body)] = body, list(faces(body))
        for vertices, circle in known[1]:
            if circle is not None:
                self.scene.add_circle(entity, circle[2], circle[:2])
            else:
                self.scene.add_polygon(entity, vertices)
        return entity
