"""Drives on, and turns away from what is near. It has a fault: see ../viewing.md."""

from player import LaserProxy, PlayerClient, Position2dProxy

with PlayerClient() as robot:
    base, laser = Position2dProxy(robot), LaserProxy(robot)
    while robot.read():
        left, right = laser.ranges[:90].min(), laser.ranges[91:].min()
        if min(left, right) > 1.0:
            base.set_speed(0.4, 0.0)
        else:
            base.set_speed(0.2, -0.4 if left < right else 0.4)
            print(f"{robot.time:.1f} s: left {left:.2f} m, right {right:.2f} m")
