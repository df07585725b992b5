"""Twelve robots that begin in a heap spread out and keep their distance, driven by one program.

All lasers are read as one array, and all robots are commanded with arrays: no loop over robots.
Nobody touches anybody, and in the end each has a metre of room around it.

    python keep_distance.py 7     # with seed 7; 1 unless given
"""

import sys

import numpy as np

import troupe

ROOM = 1.5  # metres: what is nearer pushes a robot away


def keep_distance(sim: troupe.Simulation) -> None:
    """Command all robots: away from what is near, whatever it is."""
    scan = sim.readings("laser")
    push = np.clip(ROOM - scan.ranges, 0, None)  # (robots, rays) metres
    ahead = (push * np.cos(scan.bearings)).mean(axis=1)
    left = (push * np.sin(scan.bearings)).mean(axis=1)
    sim.command(scan.robots, forward=-2 * ahead, side=-2 * left)


def nearest(sim: troupe.Simulation) -> float:
    """Metres between the middles of the two robots that are nearest to each other."""
    places = sim.poses[:, :2]
    gaps = np.linalg.norm(places[:, None] - places[None], axis=2)
    return gaps[np.triu_indices(len(gaps), 1)].min()


if __name__ == "__main__":
    seed = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    with troupe.Simulation("world.yaml", seed=seed, controllers=False) as sim:
        print(f"at first: {nearest(sim):.2f} m between the nearest two")
        while not sim.over:
            keep_distance(sim)
            sim.step()
        print(f"after {sim.time:g} s: {nearest(sim):.2f} m, contacts: {sim.contacts.sum()}")
