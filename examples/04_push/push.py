"""A robot pushes an orange puck to the blue goal, by camera.

Wherever in the middle of the room the puck lies, it ends at the goal.

    troupe run world.yaml --video push.mp4
"""

import cmath

from player import BlobfinderProxy, PlayerClient, Position2dProxy, SimulationProxy

ORANGE, BLUE = 0xFFA500, 0x0000FF


def seen(camera: BlobfinderProxy, color: int) -> complex | None:
    """Where the widest blob of a colour is: metres ahead + 1j * metres to the left."""
    blobs = [blob for blob in camera.blobs if blob.color == color]
    if not blobs:
        return None
    widest = max(blobs, key=lambda blob: blob.right - blob.left)
    return cmath.rect(widest.range, widest.bearing)


with PlayerClient() as robot:
    base = Position2dProxy(robot)
    camera = BlobfinderProxy(robot)
    while robot.read():
        puck, goal = seen(camera, ORANGE), seen(camera, BLUE)
        if puck is None:
            base.set_speed(0.0, 0.6)
            continue
        aim = puck  # where the puck hides the goal, it is pushed straight on
        if goal is not None:
            way = (goal - puck) / abs(goal - puck)
            aside = abs(cmath.phase(way / puck))  # rad between the push and the way to the goal
            aim = puck - min(0.9, 0.8 * aside) * way  # so a point further back is made for
        turn = max(-1.0, min(1.0, 2.0 * cmath.phase(aim)))
        base.set_speed(0.3 if abs(turn) < 0.8 else 0.1, turn)
        if base.stall:  # the puck is at the goal
            SimulationProxy(robot).report("arrived", robot.time)
            break
