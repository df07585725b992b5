"""A robot with two photocells, a sensor of one's own, drives to the lamp.

`photocell.py` is the sensor: the world file names it, twice, and this program reads both as plain
numbers. Wherever the robot begins it arrives within a metre of the lamp.

    troupe sensors photocell.py
    troupe run world.yaml --video light_seeker.mp4
"""

from player import AioProxy, PlayerClient, Position2dProxy, SimulationProxy

with PlayerClient() as robot:
    base = Position2dProxy(robot)
    left_eye, right_eye = AioProxy(robot, 0), AioProxy(robot, 1)
    while robot.read():
        left, right = left_eye.values[0], right_eye.values[0]
        if left + right > 0.78:
            base.set_speed(0.0, 0.0)
            SimulationProxy(robot).report("brightness", left + right)
            break
        if left + right == 0.0:
            base.set_speed(0.0, 0.8)  # the lamp is behind
        else:
            base.set_speed(0.4, 1.5 * (left - right) / (left + right))
