"""Figures of Paint's runs: starts and goals, phases over time, and strips of a video's frames."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import cv2
import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from sim.result import Result, RobotRecord

WIDTH, HEIGHT = 16.0, 21.0
COLORS = {
    "looking": "#bbbbbb", "observing": "#9ecae1", "going": "#4292c6", "waiting": "#fdae6b",
    "at goal": "#08519c", "painting": "#74c476", "painted": "#c7e9c0", "done": "#ffffff",
}  # fmt: skip


def orientation(robot: RobotRecord) -> str:
    """P for a robot that has the world's axes, N for one whose axes are turned by 180 degrees."""
    return "P" if math.cos(robot.start[2]) > 0.0 else "N"


def starts_and_goals(tests: Mapping[str, Sequence[Result]], path: Path) -> None:
    """The paper's figures 5 and 6, of runs that end at the goals: a panel per test, a row per case.

    Where the robots started and where they stood at the end, by their true poses.
    """
    columns = max(len(results) for results in tests.values())
    figure, panels = plt.subplots(
        len(tests), columns, figsize=(2.2 * columns, 2.9 * len(tests)), squeeze=False
    )
    for row, (name, results) in zip(panels, tests.items(), strict=True):
        for panel in row[len(results) :]:
            panel.axis("off")
        for number, (panel, result) in enumerate(zip(row, results, strict=False), 1):
            strips = len(result.robots)
            for k in range(1, strips):
                panel.axhline(k * HEIGHT / strips, color="#cccccc", lw=0.7)
            for i, robot in enumerate(result.robots):
                x, y, yaw = robot.start
                ahead = math.cos(yaw)
                panel.add_patch(Rectangle((x - 0.5, y - 0.5), 1, 1, fill=False, ec=f"C{i}", lw=1.2))
                panel.plot([x, x + 1.1 * ahead], [y, y], color=f"C{i}", lw=1.2)
                panel.annotate(orientation(robot), (x, y), fontsize=6, ha="center", va="center")
                gx, gy = robot.pose[:2]
                panel.plot([x, x, gx], [y, gy, gy], ":", color=f"C{i}", lw=0.8)
                panel.plot(gx, gy, "o", color=f"C{i}", ms=4)
            panel.set(xlim=(0, WIDTH), ylim=(0, HEIGHT), xticks=(0, 8, 16), aspect="equal")
            panel.set_yticks((0, 7, 14, 21))
            panel.tick_params(labelsize=6, length=2)
            panel.set_title(f"{name}, test {number}", fontsize=7)
            for spine in panel.spines.values():
                spine.set_color("red")
    save(figure, path)


def phases(robot: RobotRecord, end: float) -> list[tuple[str, float, float]]:
    """What a robot was about: (phase, from, to) in s, from what it said."""
    found = []
    for k, (time, text) in enumerate(robot.said):
        until = robot.said[k + 1][0] if k + 1 < len(robot.said) else end
        phase = next((name for name in COLORS if text.startswith(name)), None)
        if phase is not None and until > time:
            found.append((phase, time, until))
    return found


def timelines(results: Mapping[str, Result], path: Path) -> None:
    """Phases of each robot over time, one panel per run."""
    figure, panels = plt.subplots(len(results), 1, figsize=(8, 1.6 * len(results)), squeeze=False)
    for panel, (name, result) in zip(panels[:, 0], results.items(), strict=True):
        for i, robot in enumerate(result.robots):
            for phase, start, end in phases(robot, result.sim_time):
                panel.barh(i, end - start, left=start, color=COLORS[phase], height=0.7)
        panel.set(yticks=range(len(result.robots)), xlim=(0, result.sim_time))
        names = [f"{robot.name} ({orientation(robot)})" for robot in result.robots]
        panel.set_yticklabels(names, fontsize=7)
        panel.set_title(f"{name}, test 1", fontsize=8)
    panels[-1, 0].set_xlabel("s")
    shown = [phase for phase in COLORS if phase != "done"]
    handles = [Rectangle((0, 0), 1, 1, color=COLORS[phase]) for phase in shown]
    figure.legend(handles, shown, ncol=len(shown), fontsize=7, loc="upper center")
    save(figure, path)


def contact_sheet(video: Path, path: Path, frames: int = 6, width: int = 330) -> None:
    """Frames of a video at even times, in two rows, as one picture.

    Raises:
        ValueError: the video has no frames.
    """
    film = cv2.VideoCapture(str(video))
    pictures = []
    while True:
        going_on, picture = film.read()
        if not going_on:
            break
        height = round(width * picture.shape[0] / picture.shape[1])
        pictures.append(cv2.resize(picture, (width, height), interpolation=cv2.INTER_AREA))
    film.release()
    if not pictures:
        raise ValueError(f"{video}: no frames")
    chosen = np.linspace(0, len(pictures) - 1, frames).round().astype(int)
    rows = np.array_split(chosen, 2)
    sheet = np.vstack([np.hstack([pictures[k] for k in row]) for row in rows])
    cv2.imwrite(str(path), sheet, [cv2.IMWRITE_PNG_COMPRESSION, 9])


def save(figure: Figure, path: Path) -> None:
    """Write a figure."""
    figure.tight_layout(rect=(0, 0, 1, 0.97))
    figure.savefig(path, dpi=90)
    plt.close(figure)
