"""What controllers share of driving: it gets there, the short way, and never past it."""

from __future__ import annotations

import math

from hypothesis import given
from hypothesis import strategies as st

from controllers.motion import REST, Twist, approach, drive_to, slide_to, turn_to, wrap

ANGLES = st.floats(-50.0, 50.0)
PLACES = st.tuples(st.floats(-8.0, 8.0), st.floats(-8.0, 8.0))
INTERVAL = 0.1


def moved(pose: tuple[float, float, float], twist: Twist) -> tuple[float, float, float]:
    """Where an ideal drive is one interval later."""
    x, y, yaw = pose
    middle = yaw + 0.5 * twist.vyaw * INTERVAL
    cos, sin = math.cos(middle), math.sin(middle)
    return (
        x + (cos * twist.vx - sin * twist.vy) * INTERVAL,
        y + (sin * twist.vx + cos * twist.vy) * INTERVAL,
        yaw + twist.vyaw * INTERVAL,
    )


@given(ANGLES)
def test_a_wrapped_angle_is_the_same_direction_within_half_a_turn(angle: float) -> None:
    wrapped = wrap(angle)
    assert -math.pi < wrapped <= math.pi
    assert math.cos(wrapped - angle) > 1.0 - 1e-9


@given(st.floats(-30.0, 30.0), st.floats(0.05, 3.0))
def test_an_approach_comes_nearer_and_never_passes(error: float, most: float) -> None:
    speed = approach(error, most, INTERVAL)
    assert abs(speed) <= most
    assert speed * error >= 0.0
    assert abs(speed) * INTERVAL <= abs(error)


@given(st.floats(-5.0, 5.0), st.floats(0.2, 1.0))
def test_an_approach_arrives_with_a_drive_that_cannot_stop_at_once(
    start: float, most: float
) -> None:
    left, speed, passed = start, 0.0, 0.0
    for _ in range(1000):
        change = approach(left, most, INTERVAL) - speed
        speed += max(-2.0 * INTERVAL, min(2.0 * INTERVAL, change))  # a drive's 2 m/s2
        left -= speed * INTERVAL
        passed = max(passed, -left * math.copysign(1.0, start))
    assert abs(left) < 1e-3
    assert passed < 0.01


@given(ANGLES, ANGLES)
def test_a_turn_goes_the_short_way(yaw: float, heading: float) -> None:
    rate = turn_to(yaw, heading, 1.0)
    assert abs(wrap(heading - yaw - rate * INTERVAL)) <= abs(wrap(heading - yaw)) + 1e-12


@given(PLACES, ANGLES)
def test_a_differential_robot_gets_to_a_point(goal: tuple[float, float], yaw: float) -> None:
    pose = (0.0, 0.0, yaw)
    for _ in range(1500):
        twist = drive_to(pose, goal, 0.5, 1.5)
        assert twist.vy == 0.0
        assert abs(twist.vx) <= 0.5
        pose = moved(pose, twist)
    assert math.dist(pose[:2], goal) < 2e-3
    assert drive_to((*goal, yaw), goal, 0.5, 1.5) == REST


@given(PLACES, ANGLES, ANGLES)
def test_an_omnidirectional_robot_slides_to_a_point_and_a_heading(
    goal: tuple[float, float], yaw: float, heading: float
) -> None:
    pose = (0.0, 0.0, yaw)
    for _ in range(1500):
        twist = slide_to(pose, goal, heading, 0.5, 1.5)
        assert math.hypot(twist.vx, twist.vy) <= 0.5 + 1e-9
        pose = moved(pose, twist)
    assert math.dist(pose[:2], goal) < 1e-3
    assert abs(wrap(heading - pose[2])) < 1e-3
