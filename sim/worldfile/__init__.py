"""World files: reading with line marks, schema, checks."""

from sim.worldfile.loading import LoadedWorld, load
from sim.worldfile.mistakes import Mistake, WorldError
from sim.worldfile.robots import RobotSpec
from sim.worldfile.schema import World

__all__ = ["LoadedWorld", "Mistake", "RobotSpec", "World", "WorldError", "load"]
