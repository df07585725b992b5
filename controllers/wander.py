"""Wander: drive about, turn away from whatever the laser shows ahead. The example to start from."""

from __future__ import annotations

import argparse
import math

from controllers.perception import free_ahead
from player import LaserProxy, PlayerClient, Position2dProxy


def main() -> None:
    """Drive one robot until the run is over."""
    options = argparse.ArgumentParser(prog="wander", description=__doc__)
    options.add_argument("--speed", type=float, default=0.4, help="m/s on a free way")
    options.add_argument("--turn-rate", type=float, default=0.8, help="rad/s while turning away")
    options.add_argument("--distance", type=float, default=1.5, help="m to keep free ahead")
    options.add_argument("--half-width", type=float, default=0.8, help="m to keep free aside")
    args = options.parse_args()

    with PlayerClient() as robot:
        base = Position2dProxy(robot)
        laser = LaserProxy(robot)
        random = robot.rng()
        turn = 0.0  # the turn that is going on; once begun it keeps its direction
        while robot.read():
            if not laser.valid:
                continue  # a server may be slow with its first scan
            if free_ahead(laser.ranges, laser.bearings, args.half_width) > args.distance:
                turn = 0.0
                base.set_speed(args.speed, 0.2 * random.standard_normal())
                continue
            if turn == 0.0:
                ahead = abs(laser.bearings) < math.pi / 2
                left = laser.ranges[ahead & (laser.bearings > 0)].mean()
                right = laser.ranges[ahead & (laser.bearings < 0)].mean()
                turn = args.turn_rate if left > right else -args.turn_rate
            base.set_speed(0.0, turn)


if __name__ == "__main__":
    main()
