"""What stands on a stage, wherever hands have put it: for bodies that meet it or look for room."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from sim.stage.distance_field import DistanceField, nearer
from sim.stage.geometry import Floats, carried
from sim.stage.layout import Layout
from sim.stage.physics import Physics
from sim.stage.putting import Places
from sim.stage.standing import Fixture, Pose


class Fixtures:
    """The layout as it stands now, and how far all places are from it, at least.

    Where a fixture has stood at the start stays near to something that stands: robots there are
    looked at a little more closely than they need be, and nothing is surveyed anew.
    """

    def __init__(self, layout: Layout, physics: Physics) -> None:
        self.layout = layout
        self._begun = layout
        self._physics = physics
        self.distances: DistanceField = layout.distances

    @cached_property
    def places(self) -> Places:
        """Where bodies can be put."""
        return Places(self.layout)

    def fits(self, number: int, pose: Pose, bodies: Sequence[Any], poses: Floats) -> bool:
        """Whether a fixture can be put at a pose among bodies that move, at theirs (n, 3)."""
        body = self.layout.fixtures[number].body
        return self.places.free_for_fixture(body, pose, bodies, poses)

    def put(self, number: int, pose: Pose) -> None:
        """Let a fixture stand at a pose, where there is known to be room for it."""
        self.layout = self.layout.moved({number: pose})
        one = self.layout.fixtures[number]
        self._physics.stand(one.group, carried(one.start, pose))
        away = [one for one in self.layout.fixtures if one.pose != one.start and one.body.solid]
        self.distances = nearer(self._begun.distances, map(self._outline, away))
        if "places" in self.__dict__:
            self.places.stand(self.layout)

    def _outline(self, fixture: Fixture) -> Floats:
        """The corners (k, 2) of all parts of a fixture in the world."""
        return np.concatenate([one.vertices for one in self.layout.solids[fixture.solids]])
