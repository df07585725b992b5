"""Keep the lane: drive along it by compass, and no faster than what is ahead allows."""

from controllers.perception import free_ahead
from player import LaserProxy, PlayerClient, Position2dProxy

with PlayerClient() as robot:
    base, laser = Position2dProxy(robot), LaserProxy(robot)
    middle = None
    while robot.read():
        if middle is None:
            middle = base.y  # of the lane in which it begins
        ahead = free_ahead(laser.ranges, laser.bearings, 0.4)
        speed = max(0.0, min(1.2, 0.5 * (ahead - 1.5)))
        base.set_speed(speed, 0.5 * (middle - base.y) - 1.0 * base.yaw)
