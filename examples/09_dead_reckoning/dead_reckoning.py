"""How far does a robot miss its goal if it counts its wheels' turns alone? A sweep over seeds.

The robot drives around a square of 2 metres by odometry, with three sizes of error; `sweep.yaml`
says which, and with what seeds. The median miss, a column of one's own, grows with the error.

    troupe sweep sweep.yaml --out runs
    troupe report runs --measure miss -o report.html
"""

import math
from typing import Any

from controllers.motion import drive_to
from player import PlayerClient, Position2dProxy

WAY = [(2, 0), (2, 2), (0, 2), (0, 0)]  # metres, from where it began


def main() -> None:
    """The controller: drive the way, by odometry."""
    with PlayerClient() as robot:
        base = Position2dProxy(robot)
        goals = list(WAY)
        while goals and robot.read():
            pose = base.x, base.y, base.yaw
            twist = drive_to(pose, goals[0], max_speed=0.5, max_turn_rate=1.5)
            base.set_speed(twist.vx, twist.vyaw)
            if math.dist(pose[:2], goals[0]) < 0.02:
                del goals[0]


def miss(result: Any) -> float:
    """Of a run: how far the robot really is from its goal, in metres."""
    rover = result.robot("rover")
    return math.dist(rover.pose[:2], rover.start[:2])


if __name__ == "__main__":
    main()
