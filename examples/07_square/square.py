"""A program that is started by hand in another terminal drives a robot around a square.

The run waits for it; it would drive a real robot's Player server as well. It knows its way from
odometry alone, which drifts a little, and comes back to within 0.3 metres of where it began.

    troupe run world.yaml
    python square.py
"""

from controllers.motion import drive_to
from player import PlayerClient, Position2dProxy

with PlayerClient() as robot:  # at 127.0.0.1:6665, unless PLAYER_HOST and PLAYER_PORT are set
    base = Position2dProxy(robot)
    corners = [(2, 0), (2, 2), (0, 2), (0, 0)]  # metres, from where it began
    while corners and robot.read():
        twist = drive_to((base.x, base.y, base.yaw), corners[0], max_speed=0.4, max_turn_rate=1.0)
        base.set_speed(twist.vx, twist.vyaw)
        if abs(base.x - corners[0][0]) < 0.02 and abs(base.y - corners[0][1]) < 0.02:
            print(f"{robot.time:5.1f} s: at corner {corners.pop(0)}")
