"""The plain summary that `troupe run` prints: a few lines, then a line for each robot."""

from __future__ import annotations

from pathlib import Path

from player.printable import printable
from sim.result import Result, RobotRecord

MOST_ROBOTS = 40
"""Robots listed one by one."""

OUTCOMES = {
    "completed": "completed",
    "time_limit": "ended at its time limit",
    "controller_failed": "a controller failed",
    "interrupted": "interrupted",
}


def summary(result: Result, video: Path | None = None, picture: Path | None = None) -> str:
    """The result for people."""
    lines = [
        printable(f"{result.world}, seed {result.seed}: {OUTCOMES[result.outcome]}"),
        f"{result.sim_time:.1f} s simulated in {result.wall_time:.2f} s: "
        f"{result.speed:.0f} x real time, {result.ticks} ticks",
    ]
    if result.floor.painted_area > 0:
        lines.append(
            f"floor: {result.floor.coverage:.2%} painted ({result.floor.painted_area:.1f} m2), "
            f"{result.floor.passes:.2f} passes"
        )
    for door in result.doors:
        last = f", the last at step {door.steps[-1]}" if door.steps else ""
        lines.append(f"door {door.name}: {counted(door.emitted, 'robot')} entered{last}")
    lines.append(result.digest)
    if video is not None:
        lines.append(f"video: {video}")
    if picture is not None:
        lines.append(f"picture: {picture}")
    if result.robots:
        width = max(len(record.name) for record in result.robots[:MOST_ROBOTS])
        lines.append("")
        lines += [robot_line(record, width) for record in result.robots[:MOST_ROBOTS]]
    if len(result.robots) > MOST_ROBOTS:
        lines.append(f"... and {len(result.robots) - MOST_ROBOTS} more (--json lists them all)")
    return "\n".join(lines)


def counted(number: int, what: str) -> str:
    """`1 stall`, `2 stalls`."""
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


def robot_line(record: RobotRecord, width: int) -> str:
    """One robot on one line."""
    x, y, _ = record.pose
    state = record.state
    if record.state == "failed" and record.exit_code is not None:
        state = f"failed ({record.exit_code})"  # type: ignore[assignment]
    said = f"  {record.said[-1][1]!r}" if record.said else ""
    return (
        f"{record.name:{width}}  {state:12} at ({x:.2f}, {y:.2f})  {record.distance:7.1f} m  "
        f"{counted(record.contacts, 'contact')}, {counted(record.stalls, 'stall')}{said}"
    )
