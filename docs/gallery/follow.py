"""Follow: keep behind the nearest robot that the camera sees."""

from player import BlobfinderProxy, PlayerClient, Position2dProxy

with PlayerClient() as robot:
    base = Position2dProxy(robot)
    camera = BlobfinderProxy(robot)
    while robot.read():
        ahead = min(camera.blobs, key=lambda blob: blob.range, default=None)
        if ahead is None:
            base.set_speed(0.0, 0.4)
        else:
            base.set_speed(max(0.0, min(0.4, ahead.range - 0.6)), 1.5 * ahead.bearing)
