"""The paper's model once more, written for clearness: a judge of the compiled one."""

from controllers.dispersal.chance import DIE, activated, draw
from controllers.dispersal.rules import SETTLE, STAY

AROUND = [(0, -1), (1, 0), (0, 1), (-1, 0), (1, -1), (1, 1), (-1, 1), (-1, -1)]


def walk(region, rule, seed=0, q=0.0, settled_go_on=False):
    """Robots from the region's one door, until all have settled.

    Returns per robot (entered, settled, path). Rules see occupied cells, lights and a die. With
    `settled_go_on` settled robots compute in every step too, and must want to settle again.
    """
    (door,) = region.doors
    free = {(c, r) for r in range(region.rows) for c in range(region.columns) if region.free[r, c]}
    robots, step = [], 0
    while len(robots) < len(free) or any(robot["settled"] == 0 for robot in robots):
        step += 1
        assert step < 100 * len(free) + 100
        at = {robot["path"][-1]: robot for robot in robots}
        decisions = []
        for number, robot in enumerate(robots, 1):
            if robot["settled"] and not settled_go_on:
                continue
            if not activated(seed, number, step, q):
                decisions.append((robot, robot["state"], STAY))
                continue
            x, y = robot["path"][-1]
            seen = draw(seed, number, step, DIE) >> 16 << 32
            for k, (dx, dy) in enumerate(AROUND):
                cell = (x + dx, y + dy)
                seen |= (cell not in free or cell in at) << k
                seen |= (cell in at and at[cell]["settled"] == 0) << (8 + k)
            decisions.append((robot, *rule(robot["state"], seen)))
        for robot, state, move in decisions:
            if robot["settled"]:
                assert move == SETTLE
                continue
            robot["state"] = state
            if move == SETTLE:
                robot["settled"] = step
                continue
            x, y = robot["path"][-1]
            dx, dy = (0, 0) if move == STAY else AROUND[move]
            assert (x + dx, y + dy) in free
            robot["path"].append((x + dx, y + dy))
        if door not in at:
            robots.append({"entered": step, "settled": 0, "path": [door], "state": 0})
        places = [robot["path"][-1] for robot in robots]
        assert len(places) == len(set(places))
    return robots
