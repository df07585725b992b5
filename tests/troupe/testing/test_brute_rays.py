"""Brute-force rays know the world that runs: robots, obstacles, walls and what is pushed."""

from __future__ import annotations

import numpy as np

import troupe
from troupe.testing import Watch, rays

WORLD = {
    "size": [9, 7],
    "duration": 2,
    "models": {
        "disc": {"body": {"shape": "circle", "radius": 0.3}},
        "box": {
            "body": {"shape": "box", "size": [0.8, 0.5]},
            "sensors": [{"type": "laser", "pose": [0.1, 0, 90], "samples": 91, "range": 6}],
        },
    },
    "obstacles": [
        {"shape": "polygon", "points": [[0.8, 0], [0, 0.5], [-0.7, 0]], "pose": [6, 2, 70]},
        {"shape": "circle", "radius": 0.4, "pose": [2, 5, 0], "movable": True, "mass": 1},
    ],
    "robots": [{"model": name, "count": 3, "placement": "random"} for name in ("disc", "box")],
}


def test_lasers_of_a_run_read_what_brute_force_says() -> None:
    watch = Watch()
    with troupe.Simulation(WORLD, seed=3) as sim:
        while not sim.over:
            sim.command(forward=0.5, turn=0.4)
            sim.step()
            watch(sim)
        scan = sim.readings("laser")
    things = rays.things_at(watch.evidence)
    for robot, ranges in zip(scan.robots.tolist(), scan.ranges, strict=True):
        x, y, yaw = watch.evidence.poses[-1, robot]
        eye = (x + 0.1 * np.cos(yaw), y + 0.1 * np.sin(yaw), yaw + np.pi / 2)
        answer = rays.scan(things, eye, robot, scan.bearings, 6.0)
        rays.check_scan(answer, ranges, answer.owner, 6.0)
