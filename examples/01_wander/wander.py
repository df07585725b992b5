"""A robot drives about a room and turns away from whatever its laser shows in its way.

It touches nothing, wherever it begins, and never stands for long.

    troupe run world.yaml --video wander.mp4
"""

from player import LaserProxy, PlayerClient, Position2dProxy

with PlayerClient() as robot:
    base = Position2dProxy(robot)
    laser = LaserProxy(robot)
    turn = 0.0  # rad/s; a turn that has begun keeps its direction
    while robot.read():
        x, y = laser.points.T  # metres ahead and to the left, of all that the laser hits
        in_the_way = (x > 0) & (x < 0.8) & (abs(y) < 0.4)
        if not in_the_way.any():
            turn = 0.0
            base.set_speed(0.4, 0.0)
            continue
        if turn == 0.0:
            right, left = laser.ranges[:45].mean(), laser.ranges[-45:].mean()
            turn = 0.8 if left > right else -0.8
        base.set_speed(0.0, turn)
