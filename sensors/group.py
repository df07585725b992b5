"""The sensors of equal settings, with their readings: what is sensed in one batch."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sensors.eyes import EYE_OF_KIND
from sensors.grid import Floats, Ints
from sensors.noise import Keys
from sensors.readings import Fan, Readings
from sensors.registry import SensorType
from sensors.settings import SensorSettings


@dataclass
class Group:
    """The sensors of equal settings: one row of each array per sensor."""

    type: SensorType
    settings: SensorSettings
    readings: Readings
    """The batch: written in place by `Suite.sense`, row by row as below."""
    robots: Ints = field(default_factory=lambda: np.zeros(0, np.int64))
    """(n,) robot indices."""
    slots: Ints = field(default_factory=lambda: np.zeros(0, np.int64))
    """(n,) the sensors' numbers among all: the order of the flags in `wanted`."""
    entities: Ints = field(default_factory=lambda: np.zeros(0, np.int64))
    """(n,) the robots' entities."""
    keys: Keys = field(default_factory=lambda: np.zeros(0, np.uint64))
    """(n,) the keys of the sensors' streams of noise."""
    origins: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    """(n, 3) where each sensor was and looked when it last sensed."""
    times: Floats = field(default_factory=lambda: np.zeros(0))
    """(n,) the simulated time of each row's reading; -1 before the first."""
    rows: Ints = field(default_factory=lambda: np.zeros(0, np.int64))
    """(m,) the rows that the last `sense` computed."""
    everybody: Ints = field(default_factory=lambda: np.zeros(0, np.int64), repr=False)
    fan: Fan | None = field(default=None, repr=False)
    """The rays that are cast for the batch before it senses."""

    @property
    def eye(self) -> int:
        """The kind of sensor by which things may be seen or not, of `eyes.EYES`."""
        return EYE_OF_KIND[self.type.kind]

    @property
    def kind(self) -> str:
        """The kind of the readings: a key of `readings.KINDS`."""
        return self.readings.kind
