"""A world that is moved and sensed in this process: no controllers, no sockets."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sim.build import load
from sim.scenery import Scenery


class Moved:
    """The physical world of a file's text; its robots do what they are told here."""

    def __init__(self, folder: Path, text: str, **files: str) -> None:
        for name, content in files.items():
            (folder / name).write_text(content)
        path = folder / "world.yaml"
        path.write_text(text)
        loaded = load(path)
        self.scenery = Scenery(loaded, 1)
        for spec, pose in zip(loaded.robots, self.scenery.start_poses, strict=True):
            self.scenery.add_robot(spec.name, spec.model, loaded.world.models[spec.model], pose)
        self.names = [spec.name for spec in loaded.robots]
        self.interval = loaded.world.clock.interval
        self.ticks = 0

    @property
    def poses(self) -> Any:
        """(n, 3) x, y, heading."""
        return self.scenery.stage.poses

    def drive(self, twists: Sequence[Sequence[float]], seconds: float) -> None:
        """Let every robot drive with its twist (vx, vy, wz) for so long, then sense."""
        for _ in range(round(seconds / self.interval)):
            self.scenery.stage.command(np.arange(len(twists)), twists)
            self.scenery.stage.tick()
            self.ticks += 1
        self.scenery.refresh()
        self.scenery.suite.sense(self.ticks, self.ticks * self.interval)

    def data(self, robot: int, index: int) -> Any:
        """The reading of a robot's sensor."""
        return self.scenery.suite.reading(robot, index).data
