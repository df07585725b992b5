"""Flock: keep with the neighbours in sight: near them, along with them, and not too near."""

import cmath

import player


def drive(robot: player.Robot) -> None:
    """Called at each reading: turn to where the neighbours and the walls want the robot."""
    wish = 1 + 0j  # straight ahead
    neighbours = robot.fiducial.fiducials
    for one in neighbours:
        place = complex(one.x, one.y)
        wish += cmath.exp(1j * one.yaw) / len(neighbours)  # along with them
        wish += 0.2 * place / len(neighbours)  # near them
        if abs(place) < 0.9:
            wish -= 0.3 * place / abs(place) ** 2  # not too near
    for distance, bearing in zip(robot.laser.ranges, robot.laser.bearings, strict=True):
        if distance < 1.0:
            wish -= 0.5 * cmath.exp(1j * bearing) * (1.0 - distance)
    turn = 1.5 * cmath.phase(wish)
    robot.base.set_speed(0.3 if abs(turn) < 1.0 else 0.1, turn)


if __name__ == "__main__":
    player.run(drive)
