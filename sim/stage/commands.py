"""What robots are told to do: commands cut to the drives' limits and written to the records."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.stage.records import CAR, HEADING, OMNIDIRECTIONAL, POSITION, STEERING, TWIST


def _finite(what: str, *values: float) -> None:
    if not all(math.isfinite(value) for value in values):
        raise ValueError(f"{what} must be finite numbers, not {', '.join(map(repr, values))}")


def command_twists(records: NDArray[Any], twists: ArrayLike) -> None:
    """Write twists (k, 3) to the records (k,); see `Stage.command`."""
    wanted = np.asarray(twists, dtype=np.float64).reshape(-1, 3)
    if len(wanted) != len(records):
        raise ValueError(f"{len(wanted)} twists for {len(records)} robots")
    if not np.isfinite(wanted).all():
        raise ValueError("a commanded velocity must be a finite number")
    kind = records["kind"]
    vx, vy, wz = wanted.T.copy()
    vy[kind != OMNIDIRECTIONAL] = 0.0
    scale = np.minimum(1.0, records["max_speed"] / np.maximum(np.hypot(vx, vy), 1e-300))
    bend = np.zeros(len(records))
    car = kind == CAR
    np.divide(wz, vx, out=bend, where=car & (vx != 0.0))
    most = records["max_curvature"]
    records["curvature"] = np.clip(bend, -most, most)
    records["vx"], records["vy"] = vx * scale, vy * scale
    records["wz"] = np.clip(wz, -records["max_turn_rate"], records["max_turn_rate"])
    records["mode"] = np.where(car, STEERING, TWIST)


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
