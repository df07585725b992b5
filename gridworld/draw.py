"""What a run on the grid shows, as numbers: what stands in each cell. `troupe` draws it.

Active robots are arrows in their primary direction, as in the paper's figures 5 and 6 (dots, while
they have not moved), settled ones diamonds.
"""

import numpy as np
from numpy.typing import NDArray

from gridworld.grid import NO_LIMIT, GridRun

WALL, FREE, ARROW, DOT, DIAMOND = 0, 1, 2, 6, 7
"""What a cell may hold; an arrow up is ARROW, to the right ARROW + 1, and so on clockwise."""
DOOR = 8
"""Added to what a door's cell holds."""
_MOST_FRAMES = 3600  # two minutes; of a longer run every second step is shown, or third, ...


def cells_of(run: GridRun) -> NDArray[np.uint8]:
    """What stands in each cell now: (rows, columns), with a frame of walls unless the map has one.

    The frame shows where the region reaches to the map's edge, and nothing else bounds it.
    """
    free = run.region.free
    kinds = np.zeros((run.region.rows + 2, run.region.columns + 2), np.uint8)
    kinds[1:-1, 1:-1] = np.where(free, FREE, WALL)
    flat = kinds.reshape(-1)
    active = run.at_work
    flat[run.position[np.arange(run.emitted)]] = DIAMOND
    headings = (run.state[active] >> 3) & 3
    flat[run.position[active]] = np.where(run.moves[active] > 0, ARROW + headings, DOT)
    flat[run.doors] += DOOR
    edge = free[0].any() or free[-1].any() or free[:, 0].any() or free[:, -1].any()
    return kinds if edge else kinds[1:-1, 1:-1]


def entries_of(run: GridRun) -> list[str]:
    """The step and the robots, in words."""
    robots = run.emitted
    settled = robots - len(run.at_work)
    return [
        f"step {run.steps}",
        f"{robots} robot{'' if robots == 1 else 's'}, {settled} settled",
    ]


def stride_of(run: GridRun) -> int:
    """Steps from frame to frame of a film: 1, or more where a film would be too long."""
    return -(-2 * run.region.cells // _MOST_FRAMES)


def limit_of(max_steps: int | None) -> int:
    """The last step of a run."""
    return NO_LIMIT if max_steps is None else max_steps
