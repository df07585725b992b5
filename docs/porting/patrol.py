"""Patrol: drive on while the way is free, else turn to the freer side."""

from player import BlobfinderProxy, LaserProxy, PlayerClient, Position2dProxy

with PlayerClient() as robot:  # PLAYER_PORT, else 6665; or the robot that it was started for
    base = Position2dProxy(robot)
    laser = LaserProxy(robot)
    camera = BlobfinderProxy(robot)
    base.set_motor_power(True)

    seen = 0
    for _ in range(300):
        robot.read()
        ahead = laser.ranges[abs(laser.bearings) < 0.5].min(initial=8.0)
        left = laser.ranges[laser.bearings > 0].sum()
        right = laser.ranges[laser.bearings <= 0].sum()
        seen += len(camera.blobs) > 0
        if ahead > 1.0:
            base.set_speed(0.5)
        else:
            base.set_speed(0.0, 0.8 if left > right else -0.8)
    base.set_speed(0.0)
    print(f"at {base.x:.2f} {base.y:.2f} after {robot.time:.1f} s; orange in {seen} pictures")
