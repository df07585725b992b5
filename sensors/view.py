"""What a sensor is given to sense with: which robots, where they stand, and the scene."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from sensors.compiled import compiled
from sensors.grid import Floats, Ints
from sensors.scene import Scene
from sensors.sight import Seen


@dataclass
class Contacts:
    """Where bodies touch something, in this tick: straight stretches of their outlines."""

    robots: Ints
    """(k,) robot indices, as `Suite.add_robot` gave them."""
    points: Floats
    """(k, 2) where each stretch begins; metres, in the world."""
    ends: Floats | None = None
    """(k, 2) where it ends; None where all of them are single points."""

    @classmethod
    def none(cls) -> Contacts:
        """Nobody touches anything."""
        return cls(np.zeros(0, np.int64), np.zeros((0, 2)))


Touching = Contacts | Callable[[], Contacts]
"""Where robots touch something, or a function that finds it when it is asked for."""


@dataclass
class View:
    """One batch of equal sensors, at one tick.

    Arrays have n rows, one per robot of the batch, as the readings do. Only `rows` are wanted;
    what a sensor writes into the others is not used.
    """

    scene: Scene
    rows: Ints
    """(m,) the rows that are wanted."""
    robots: Ints
    """(n,) the robots' indices."""
    entities: Ints
    """(n,) the robots' entities in the scene: what a sensor does not see."""
    origins: Floats
    """(n, 3) where the sensors are and look, in the world: x, y, heading in radians. The rows
    that are not wanted may be out of date."""
    keys: npt.NDArray[np.uint64]
    """(n,) the key of each sensor's own stream of noise: see `sensors.noise`."""
    tick: int
    time: float
    """Simulated seconds."""
    eye: int = 0
    """The kind of sensor, of `sensors.eyes.EYES`: some things are not seen by all kinds; 0: one
    that sees everything."""
    z: float | None = None
    """How high the sensors sit, in metres; None: they see things of all heights."""
    touching: Touching = field(default_factory=Contacts.none)

    @property
    def contacts(self) -> Contacts:
        """Where robots touch something."""
        return self.touching() if callable(self.touching) else self.touching

    @property
    def seen(self) -> Seen:
        """What of the scene these sensors see, for `sensors.cast`."""
        return self.scene.seen(self.eye, self.z)


@compiled
def mount_sensors(
    poses: Floats,
    entities: Ints,
    rows: Ints,
    mount: tuple[float, float, float],
    marks: tuple[tuple[Floats, Floats], ...],
    time: float,
) -> None:
    """Write where sensors are that are mounted on `entities` (n,), and when they sense.

    marks: per group of sensors their origins (n, 3) in the world and their times (n,), written.
    """
    for j in rows:
        heading = poses[entities[j], 2]
        cos, sin = np.cos(heading), np.sin(heading)
        x = poses[entities[j], 0] + cos * mount[0] - sin * mount[1]
        y = poses[entities[j], 1] + sin * mount[0] + cos * mount[1]
        for group in range(len(marks)):
            origins, times = marks[group]
            origins[j, 0], origins[j, 1], origins[j, 2] = x, y, heading + mount[2]
            times[j] = time


@compiled
def place_elements(origins: Floats, rows: Ints, elements: Floats) -> Floats:
    """Where elements (e, 3) of the sensors `rows` (m,) are, in the world: (m * e, 3)."""
    places = np.empty((rows.shape[0] * elements.shape[0], 3))
    k = 0
    for j in rows:
        cos, sin = np.cos(origins[j, 2]), np.sin(origins[j, 2])
        for e in range(elements.shape[0]):
            places[k, 0] = origins[j, 0] + cos * elements[e, 0] - sin * elements[e, 1]
            places[k, 1] = origins[j, 1] + sin * elements[e, 0] + cos * elements[e, 1]
            places[k, 2] = origins[j, 2] + elements[e, 2]
            k += 1
    return places
