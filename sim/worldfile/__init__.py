"""World files: reading with line marks, schema, checks. What is built of one is in `sim.build`."""

from sim.worldfile.checked import CheckedWorld, check_data, check_file
from sim.worldfile.mistakes import Mistake, WorldError
from sim.worldfile.robots import RobotSpec
from sim.worldfile.schema import World

__all__ = [
    "CheckedWorld",
    "Mistake",
    "RobotSpec",
    "World",
    "WorldError",
    "check_data",
    "check_file",
]
