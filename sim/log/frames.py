"""What robots' frames and topics are called: ROS takes fewer characters than Troupe."""

from __future__ import annotations

import re
from collections.abc import Container

WORLD = "map"
"""The frame of the world: metres from its lower left corner."""


def ros_name(name: str, taken: Container[str]) -> str:
    """A robot's name as part of topics and frames; a number is added where it is taken."""
    plain = re.sub(r"[^A-Za-z0-9_]", "_", name)
    if not plain[:1].isalpha():
        plain = f"robot_{plain}"
    found, number = plain, 2
    while found in taken:
        found, number = f"{plain}_{number}", number + 1
    return found


def base(name: str) -> str:
    """The frame of a robot's body."""
    return f"{name}/base_link"
