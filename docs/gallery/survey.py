"""Survey: wander, and find one's place by the landmarks in sight, whose places are known."""

import cmath
import math

from controllers.perception import free_ahead
from player import FiducialProxy, LaserProxy, PlayerClient, Position2dProxy, SimulationProxy

PLACES = {1: -5 + 3j, 2: 3j, 3: 5 + 3j, 4: -5 - 3j, 5: -3j, 6: 5 - 3j}
"""x + 1j * y of the landmarks in the world, metres."""

with PlayerClient() as robot:
    base, laser = Position2dProxy(robot), LaserProxy(robot)
    landmarks, simulation = FiducialProxy(robot), SimulationProxy(robot)
    while robot.read():
        free = free_ahead(laser.ranges, laser.bearings, 0.35) > 0.8
        base.set_speed(0.4 if free else 0.0, 0.0 if free else 0.6)
        seen = {one.id: complex(one.x, one.y) for one in landmarks.fiducials}
        if len(seen) >= 2:
            # Two landmarks give the heading, and either of them then the place.
            first, second = sorted(seen)[:2]
            yaw = cmath.phase((PLACES[second] - PLACES[first]) / (seen[second] - seen[first]))
            place = PLACES[first] - seen[first] * cmath.exp(1j * yaw)
            simulation.report("place", [place.real, place.imag, math.degrees(yaw)])
