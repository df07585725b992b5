"""What robots are told to do: commands cut to the drives' limits and written to the records."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.stage.compiled import bare, compiled
from sim.stage.records import CAR, HEADING, OMNIDIRECTIONAL, POSITION, STEERING, TWIST


def _finite(what: str, *values: float) -> None:
    if not all(math.isfinite(value) for value in values):
        raise ValueError(f"{what} must be finite numbers, not {', '.join(map(repr, values))}")


def command_twists(
    movers: NDArray[Any], first: int, robots: NDArray[np.int64], twists: NDArray[np.float64]
) -> None:
    """Write twists (k, 3) to the records of robots (k,); see `Stage.command`.

    The records of the robots begin at `first`.
    """
    if len(twists) != len(robots):
        raise ValueError(f"{len(twists)} twists for {len(robots)} robots")
    if len(robots) and not 0 <= robots.min() <= robots.max() < len(movers) - first:
        raise IndexError(f"there are {len(movers) - first} robots, not all of {robots.tolist()}")
    if not _write_twists(movers, first, robots, twists):
        raise ValueError("a commanded velocity must be a finite number")


@compiled
def _write_twists(
    movers: Any, first: int, robots: NDArray[np.int64], twists: NDArray[np.float64]
) -> bool:
    """False, and nothing is written, if a twist is not finite."""
    if not np.isfinite(twists).all():
        return False
    movers = bare(movers)
    for k in range(robots.size):
        mover = movers[first + robots[k]]
        vx, vy, wz = twists[k, 0], twists[k, 1], twists[k, 2]
        if mover.kind != OMNIDIRECTIONAL:
            vy = 0.0
        scale = min(1.0, mover.max_speed / max(math.hypot(vx, vy), 1e-300))
        bend = 0.0
        mover.mode = TWIST
        if mover.kind == CAR:
            mover.mode = STEERING
            if vx != 0.0:
                bend = wz / vx
        mover.curvature = min(mover.max_curvature, max(-mover.max_curvature, bend))
        mover.vx, mover.vy = vx * scale, vy * scale
        mover.wz = min(mover.max_turn_rate, max(-mover.max_turn_rate, wz))
    return True


def command_steering(record: Any, speed: float, steering: float, wheelbase: float) -> None:
    """Write a car's speed and steering angle; see `Stage.command_car`."""
    _finite("speed and steering angle", speed, steering)
    angle = min(math.pi / 2, max(-math.pi / 2, steering))
    most = float(record["max_curvature"])
    record["mode"] = STEERING
    record["vx"] = min(record["max_speed"], max(-record["max_speed"], speed))
    record["vy"], record["wz"] = 0.0, 0.0
    record["curvature"] = min(most, max(-most, math.tan(angle) / wheelbase))


def command_pose(
    record: Any, goal: tuple[float, float, float], speed: float, turn_rate: float
) -> None:
    """Write a goal; see `Stage.command_position`."""
    _finite("speed and turn rate", speed, turn_rate)
    record["mode"] = POSITION
    record["goal_x"], record["goal_y"], record["goal_yaw"] = goal
    record["speed_limit"] = min(abs(speed) or math.inf, float(record["max_speed"]))
    record["turn_limit"] = min(abs(turn_rate) or math.inf, float(record["max_turn_rate"]))
    record["vx"], record["vy"], record["wz"] = 0.0, 0.0, 0.0


def command_heading(record: Any, speed: float, heading: float) -> None:
    """Write a speed and a heading to hold; see `Stage.command_heading`."""
    _finite("speed and heading", speed, heading)
    record["mode"] = HEADING
    record["goal_yaw"] = heading
    record["turn_limit"] = record["max_turn_rate"]
    record["vx"] = min(record["max_speed"], max(-record["max_speed"], speed))
    record["vy"], record["wz"] = 0.0, 0.0
