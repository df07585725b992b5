"""A swarm fills a map of one's own: each robot sees its neighbouring cells and nothing else.

`home.txt` is the map; `troupe disperse home.txt --rule symmetric` fills it on the grid. Robots with
bodies, lasers and controllers do the same: every cell gets a robot, nobody touches anybody, and
each robot goes as many cells as on the grid.

    python disperse.py 7     # with seed 7; 1 unless given
"""

import sys

import troupe
from gridworld.grid import simulate
from gridworld.regions import load

seed = int(sys.argv[1]) if len(sys.argv) > 1 else 1
grid = simulate(load("home.txt"), "symmetric", seed=seed)
bodies = troupe.run("world.yaml", seed=seed)

print("on the grid:", [int(way) for way in grid.moves], "cells;", grid.outcome)
print("with bodies:", [robot.properties.get("travel") for robot in bodies.robots], "cells;",
      bodies.outcome, "contacts:", sum(robot.contacts for robot in bodies.robots))  # fmt: skip
