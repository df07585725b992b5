"""What the stage knows of each moving body, as one numpy record per body."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

PASSIVE, DIFFERENTIAL, OMNIDIRECTIONAL, CAR = 0, 1, 2, 3
"""Kinds of drive. PASSIVE: a movable obstacle, or a robot without a drive."""

KINDS = {"differential": DIFFERENTIAL, "omnidirectional": OMNIDIRECTIONAL, "car": CAR}

TWIST, STEERING, POSITION, HEADING = 0, 1, 2, 3
"""What a robot was commanded last: a twist; a speed with a curvature; a pose; a heading."""

COMMANDS = ("twist", "steering", "position", "heading")
"""Their names."""

COMMAND_FIELDS = {
    "twist": ("vx", "vy", "wz"),
    "steering": ("vx", "curvature"),
    "position": ("goal_x", "goal_y", "goal_yaw"),
    "heading": ("vx", "goal_yaw"),
}
"""Where a command of each name stands in a record."""

MOVER = np.dtype(
    [
        # the model
        ("kind", np.int32),
        ("max_speed", np.float64),  # m/s
        ("max_turn_rate", np.float64),  # rad/s
        ("max_acceleration", np.float64),  # m/s2
        ("max_turn_acceleration", np.float64),  # rad/s2
        ("max_curvature", np.float64),  # 1/m, car only
        ("mass", np.float64),  # kg
        ("moment", np.float64),  # kg m2
        ("max_force", np.float64),  # N, of its drive, or of its friction with the floor
        ("max_torque", np.float64),  # N m
        ("shape", np.int32),  # its number among the outlines
        ("levels", np.uint32),  # bits: it meets only what shares one; 0 if it is not solid
        ("reach", np.float64),  # m, radius of the circle about the origin that holds the body
        ("girth", np.float64),  # m, half of its width where it is narrowest
        ("strength", np.float64),  # N, at most, with which its drive can press on something
        ("lever", np.float64),  # m, how far from the origin turning moves the outline; 0: circle
        # where Chipmunk keeps it: see `chipmunk.state_of`
        ("body", np.uint64),  # the address of its body's state
        ("leader", np.uint64),  # that of the body that leads it; 0: none does
        ("inside", np.bool_),  # whether it is in Chipmunk's space: else it can meet nobody
        ("driven", np.bool_),  # has a drive and is not settled
        ("standing", np.bool_),  # settled for good
        ("gripped", np.bool_),  # it holds something, or is held
        ("calm", np.int32),  # ticks since it last could have met anything
        # the command
        ("mode", np.int32),
        ("motors", np.bool_),
        ("vx", np.float64),
        ("vy", np.float64),
        ("wz", np.float64),
        ("curvature", np.float64),
        ("goal_x", np.float64),
        ("goal_y", np.float64),
        ("goal_yaw", np.float64),
        ("speed_limit", np.float64),  # m/s, of this command
        ("turn_limit", np.float64),  # rad/s, of this command
        # the wanted twist in the robot's frame, after the limits of acceleration
        ("wanted_x", np.float64),
        ("wanted_y", np.float64),
        ("wanted_turn", np.float64),
        ("axis_x", np.float64),  # the robot's x axis in the world, for which this was meant
        ("axis_y", np.float64),
        # where it was after the last step
        ("x", np.float64),
        ("y", np.float64),
        # sums: over the run, then over this tick
        ("distance", np.float64),
        ("asked", np.float64),  # m of wanted way
        ("done", np.float64),  # m of way in the wanted direction
        ("asked_turn", np.float64),  # rad
        ("done_turn", np.float64),  # rad
    ],
    align=True,
)


def mover(
    body: Any,
    drive: Any,
    *,
    moment: float,
    reach: float,
    girth: float,
    shape: int,
    levels: int,
    friction: tuple[float, float],
) -> Any:
    """A record for a body and a drive (or None) of the schema, at rest at no place yet.

    moment: moment of inertia in kg m2. reach: radius of the circle about its origin in metres.
    girth: half of its least width in metres. shape: the number of its outline. levels: the bits of
    the heights at which it meets others. friction: the force (N) and torque (N m) that the floor
    brakes it with, unless wheels do.
    """
    record = np.zeros(1, dtype=MOVER)[0]
    record["mass"], record["moment"] = body.mass, moment
    record["reach"], record["girth"] = reach, girth
    record["lever"] = 0.0 if body.shape == "circle" else reach
    record["shape"], record["levels"] = shape, levels
    record["motors"] = True
    record["axis_x"] = 1.0
    record["max_force"], record["max_torque"] = friction
    if drive is not None:
        record["kind"] = KINDS[drive.kind]
        record["driven"] = True
        record["max_speed"] = drive.max_speed
        record["max_turn_rate"] = math.radians(drive.max_turn_rate)
        record["max_acceleration"] = drive.max_acceleration
        record["max_turn_acceleration"] = math.radians(drive.max_turn_acceleration)
        record["max_force"], record["max_torque"] = drive.max_force, drive.max_torque
        # A turning body presses with its torque over the arm; the shortest counts.
        record["strength"] = max(drive.max_force, drive.max_torque / girth)
        if drive.kind == "car":
            record["max_curvature"] = math.tan(math.radians(drive.max_steering)) / drive.wheelbase
    return record
