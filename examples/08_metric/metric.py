"""How much of a room do three wanderers see to in a minute? A metric of one's own, as CSV.

A hook is called after every tick; once a second it notes which share of the room's squares of half
a metre has had a robot in it. The share never falls, and ends above a fifth. Where matplotlib is
installed the curve is drawn too.

    python metric.py 7     # with seed 7; 1 unless given
"""

import csv
import sys

import numpy as np

import troupe

seed = int(sys.argv[1]) if len(sys.argv) > 1 else 1
visited = np.zeros((12, 16), bool)  # of a room of 8 x 6 metres
rows = []


def look(sim: troupe.Simulation) -> None:
    x, y = (sim.poses[:, :2] / 0.5).astype(int).T
    visited[y, x] = True
    if sim.ticks % 10 == 0:
        rows.append((sim.time, visited.mean()))


result = troupe.run("world.yaml", seed=seed, each_tick=look)
with open("visited.csv", "w", newline="") as file:
    csv.writer(file).writerows([("time", "visited"), *rows])
print(f"{result.outcome}: {visited.mean():.0%} of the room in {result.sim_time:g} s")

try:
    from matplotlib.figure import Figure
except ImportError:
    sys.exit()
figure = Figure(figsize=(5, 3), layout="constrained")
axes = figure.subplots()
axes.plot(*zip(*rows, strict=True))
axes.set(xlabel="time [s]", ylabel="visited", ylim=(0, 1))
figure.savefig("visited.svg")
