"""What a model returns to others in Stage: to bodies, rangers, cameras and fiducial finders."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sensors.eyes import EYES
from troupe.importers.stage import values
from troupe.importers.stage.notes import Notes
from troupe.importers.stage.syntax import Entity


@dataclass(frozen=True)
class Returns:
    """Whether a model stops others, and which kinds of sensor do not see it."""

    solid: bool
    unseen: frozenset[str]
    fiducial: bool

    @classmethod
    def of(cls, entity: Entity, notes: Notes) -> Returns:
        """What the properties of a model say; the rest is Stage's default: it stops and is seen."""
        unseen: set[str] = set()
        if values.number(entity, "ranger_return", 1.0) < 0.0:
            unseen |= {"laser", "ranger"}
        if values.number(entity, "laser_return", 1.0) <= 0.0:
            unseen |= {"laser"}
        if values.number(entity, "blob_return", 1.0) == 0.0:
            unseen |= {"blobfinder"}
            notes.differs(
                entity.properties["blob_return"].place,
                "blob_return 0: no blobfinder sees it here (Stage 4 does not look at it)",
            )
        solid = values.number(entity, "obstacle_return", 1.0) != 0.0
        return cls(solid, frozenset(unseen), values.number(entity, "fiducial_return", 0.0) > 0.0)

    @property
    def data(self) -> dict[str, Any]:
        """`solid` and `seen_by` of a world file, where they are not the default."""
        found: dict[str, Any] = {} if self.solid else {"solid": False}
        if self.unseen:
            found["seen_by"] = [eye for eye in EYES if eye not in self.unseen]
        return found
