"""Striker: get behind the orange ball, and push it towards the goal of a colour."""

import argparse
import cmath

from player import BlobfinderProxy, PlayerClient, Position2dProxy

ORANGE = 0xFFA500


def seen(camera: BlobfinderProxy, color: int) -> complex | None:
    """Where the widest blob of a colour is: metres ahead + 1j * metres to the left."""
    blobs = [blob for blob in camera.blobs if blob.color == color]
    widest = max(blobs, key=lambda blob: blob.right - blob.left, default=None)
    return None if widest is None else cmath.rect(widest.range, widest.bearing)


options = argparse.ArgumentParser()
options.add_argument("--goal", type=lambda text: int(text, 16), help="its colour, rrggbb")
color = options.parse_args().goal

with PlayerClient() as robot:
    base = Position2dProxy(robot)
    camera = BlobfinderProxy(robot)
    while robot.read():
        ball, goal = seen(camera, ORANGE), seen(camera, color)
        if ball is None:
            base.set_speed(-0.1, 1.0)
            continue
        aim = ball
        if goal is not None:
            way = (goal - ball) / abs(goal - ball)
            aim = ball - min(0.9, 0.8 * abs(cmath.phase(way / ball))) * way
        turn = max(-2.0, min(2.0, 3.0 * cmath.phase(aim)))
        base.set_speed(0.6 if abs(turn) < 1.0 else 0.1, turn)
