"""A robot looks for the orange ball with its camera, goes there and stops before it.

It turns until it sees orange, whatever else there is to be seen, and stops within 0.6 metres of
the ball without touching it. The result tells when: property `found`.

    troupe run world.yaml --video find_blob.mp4
"""

from player import BlobfinderProxy, PlayerClient, Position2dProxy, SimulationProxy, SpeechProxy

ORANGE = 0xFFA500

with PlayerClient() as robot:
    base = Position2dProxy(robot)
    camera = BlobfinderProxy(robot)
    while robot.read():
        seen = [blob for blob in camera.blobs if blob.color == ORANGE]
        if not seen:
            base.set_speed(0.0, 0.6)
            continue
        ball = min(seen, key=lambda blob: blob.range)
        if ball.range < 0.55:
            base.set_speed(0.0, 0.0)
            SpeechProxy(robot).say("found it")
            SimulationProxy(robot).report("found", robot.time)
            break
        base.set_speed(min(0.4, ball.range - 0.4), 1.5 * ball.bearing)
