"""A robot follows the wall with its laser, around corners of both kinds.

It drives on until it meets a wall, and from then on keeps it to its right, about 0.6 metres off,
all the way round the room.

    troupe run world.yaml --video follow_wall.mp4
"""

import math

from player import LaserProxy, PlayerClient, Position2dProxy

DISTANCE = 0.6

with PlayerClient() as robot:
    base = Position2dProxy(robot)
    laser = LaserProxy(robot)
    following = False
    while robot.read():
        x, y = laser.points.T
        if ((x > 0) & (x < DISTANCE + 0.1) & (abs(y) < 0.35)).any():
            following = True
            base.set_speed(0.0, 0.8)  # a wall ahead: turn left
            continue
        if not following:
            base.set_speed(0.4, 0.0)
            continue
        right = laser.bearings < math.radians(-20)
        nearest = laser.ranges[right].argmin()
        distance, bearing = laser.ranges[right][nearest], laser.bearings[right][nearest]
        # The nearest point of the wall is to be at -90 degrees, and at its distance.
        turn = 1.5 * (bearing + math.pi / 2) + 2.0 * (DISTANCE - distance)
        base.set_speed(0.4, max(-0.8, min(0.8, turn)))
