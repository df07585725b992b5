"""The drive law, for all robots at once: from commands to the twist wanted of each body."""

from __future__ import annotations

import math
from typing import Any

from sim.stage.compiled import bare, compiled, inlined
from sim.stage.intrinsics import floats_at
from sim.stage.memory import ANGLE, PLACE, SPIN, VELOCITY
from sim.stage.records import (
    CAR,
    HEADING,
    OMNIDIRECTIONAL,
    POSITION,
    STEERING,
)

ARRIVED = 0.02
"""m from its goal at which a robot that was sent to a pose has arrived (Stage's tolerance)."""
TURN_FIRST = 0.3
"""rad of bearing above which a differential robot on its way to a pose turns on the spot."""
BRAKING = 0.7
"""Share of the acceleration that approaching a goal plans with; the rest absorbs the delay of
one step between command and motion, so that it does not overshoot."""


@inlined
def _wrap(angle: float) -> float:
    return math.pi - (math.pi - angle) % (2.0 * math.pi)


@inlined
def _length(x: float, y: float, least: float) -> float:
    """The length of (x, y), or 0 where it is surely below `least` and so of no interest."""
    if y == 0.0:
        return abs(x)
    return math.hypot(x, y) if x * x + y * y >= least * least * (1.0 - 1e-9) else 0.0


@inlined
def _approach(left: float, limit: float, acceleration: float, dt: float) -> float:
    """Speed at which to approach a goal that is `left` away, so as to stop there."""
    return min(limit, math.sqrt(2.0 * BRAKING * acceleration * left), left / (3.0 * dt))


@inlined
def _turn_to(error: float, limit: float, acceleration: float, dt: float) -> float:
    rate = _approach(abs(error), limit, acceleration, dt)
    return rate if error >= 0.0 else -rate


@inlined
def _set_point(mover: Any, x: float, y: float, yaw: float, dt: float) -> tuple[float, float, float]:
    """The twist (vx, vy, wz; robot's frame) that a robot's command asks for now."""
    if mover.mode == STEERING:
        return mover.vx, 0.0, mover.vx * mover.curvature
    if mover.mode == POSITION:
        dx, dy = mover.goal_x - x, mover.goal_y - y
        left = math.hypot(dx, dy)
        if left > ARRIVED:
            speed = _approach(left, mover.speed_limit, mover.max_acceleration, dt)
            if mover.kind == OMNIDIRECTIONAL:
                turn = _turn_to(
                    _wrap(mover.goal_yaw - yaw), mover.turn_limit, mover.max_turn_acceleration, dt
                )
                bearing = math.atan2(dy, dx) - yaw
                return speed * math.cos(bearing), speed * math.sin(bearing), turn
            error = _wrap(math.atan2(dy, dx) - yaw)
            turn = _turn_to(error, mover.turn_limit, mover.max_turn_acceleration, dt)
            if abs(error) > TURN_FIRST:
                return 0.0, 0.0, turn
            return speed * math.cos(error), 0.0, turn
        mover.mode = HEADING
        mover.vx = 0.0
    if mover.mode == HEADING:
        error = _wrap(mover.goal_yaw - yaw)
        turn = _turn_to(error, mover.turn_limit, mover.max_turn_acceleration, dt)
        return mover.vx, 0.0, turn
    return mover.vx, mover.vy, mover.wz


@inlined
def _ramp(mover: Any, vx: float, vy: float, wz: float, dt: float) -> None:
    """Bring the wanted twist nearer to the set-point, within the limits of acceleration.

    A car turns no faster than its limits allow: a circle that would need more at its speed is
    driven wider. It turns only while it rolls: if it brakes faster than it may end its turn, it
    brakes less.
    """
    before = mover.wanted_x
    dx, dy = vx - mover.wanted_x, vy - mover.wanted_y
    most = mover.max_acceleration * dt
    change = _length(dx, dy, most)
    if change > most:
        dx, dy = dx * most / change, dy * most / change
        mover.wanted_x += dx
        mover.wanted_y += dy
    else:
        mover.wanted_x, mover.wanted_y = vx, vy
    if mover.kind == CAR and mover.mode == STEERING:
        wz = mover.wanted_x * mover.curvature
        wz = min(mover.max_turn_rate, max(-mover.max_turn_rate, wz))
    most = mover.max_turn_acceleration * dt
    mover.wanted_turn += min(most, max(-most, wz - mover.wanted_turn))
    most = abs(mover.wanted_x) * mover.max_curvature
    if mover.wanted_x * before < 0.0:
        most *= 1.0 + 1e-12  # at full lock the rounding of the turn keeps no car from reversing
    if mover.kind == CAR and abs(mover.wanted_turn) > most:
        rolling = min(abs(before), abs(mover.wanted_turn) / mover.max_curvature)
        mover.wanted_x = rolling if before >= 0.0 else -rolling


@compiled
def want(state: Any, movers: Any, count: int, dt: float) -> None:
    """Update the wanted twists of the first `count` movers for a step of `dt` seconds."""
    state, movers = bare(state), bare(movers)
    for i in range(count):
        mover = movers[i]
        if not mover.driven:
            continue
        body = state[i]
        vx, vy, wz = 0.0, 0.0, 0.0
        if mover.motors:
            vx, vy, wz = _set_point(mover, body[0], body[1], body[2], dt)
        if mover.kind != OMNIDIRECTIONAL:
            vy = 0.0
        _ramp(mover, vx, vy, wz, dt)


@inlined
def impulse(body: Any, mover: Any, vx: float, vy: float, dt: float) -> tuple[float, float, float]:
    """How a drive changes a body's velocity (m/s, world) and turn rate (rad/s) in a step of `dt`.

    (vx, vy): the velocity that it is to have. What is passive is braked so by the floor.
    """
    dx, dy, most = vx - body[3], vy - body[4], mover.max_force * dt / mover.mass
    change = _length(dx, dy, most)
    if change > most:
        dx, dy = dx * most / change, dy * most / change
    most = mover.max_torque * dt / mover.moment
    return dx, dy, min(most, max(-most, mover.wanted_turn - body[5]))


@compiled
def lead(state: Any, movers: Any, count: int, dt: float, substep: float) -> None:
    """Have what moves bodies as wanted act in a step of `dt` s, which Chipmunk cuts to substeps.

    A robot in Chipmunk's space follows its leader, which is given its velocities here, and what is
    passive there has joints with the ground. All others are far from everything, and are moved
    here: the same limited impulse acts on them at once.

    As in Chipmunk bodies move first, with the velocities they have, and then get new ones for the
    next step. So the wanted direction is that of the heading halfway through the next step;
    with it an arc of many steps stays on its circle.
    """
    state, movers = bare(state), bare(movers)
    for i in range(count):
        mover = movers[i]
        if mover.standing or (mover.inside and not mover.driven):
            continue
        body = state[i]
        step = substep if mover.inside else dt
        yaw = body[2] + body[5] * step + mover.wanted_turn * step / 2.0
        cosine, sine = math.cos(yaw), math.sin(yaw)
        mover.axis_x, mover.axis_y = cosine, sine
        vx = mover.wanted_x * cosine - mover.wanted_y * sine
        vy = mover.wanted_x * sine + mover.wanted_y * cosine
        if mover.inside:
            leader = floats_at(mover.leader)
            leader[VELOCITY], leader[VELOCITY + 1], leader[SPIN] = vx, vy, mover.wanted_turn
            continue
        dx, dy, turn = impulse(body, mover, vx, vy, dt)
        own = floats_at(mover.body)
        own[PLACE] = body[0] + body[3] * dt
        own[PLACE + 1] = body[1] + body[4] * dt
        own[ANGLE] = body[2] + body[5] * dt
        own[VELOCITY], own[VELOCITY + 1], own[SPIN] = body[3] + dx, body[4] + dy, body[5] + turn


@compiled
def account(state: Any, movers: Any, count: int, dt: float) -> None:
    """After a step of `dt`: the way gone, and how much of what was wanted was done."""
    state, movers = bare(state), bare(movers)
    for i in range(count):
        mover = movers[i]
        body = state[i]
        mover.distance += math.hypot(body[0] - mover.x, body[1] - mover.y)
        mover.x, mover.y = body[0], body[1]
        if not mover.driven:
            continue
        speed = _length(mover.wanted_x, mover.wanted_y, 0.0)
        if speed > 0.0:
            vx = body[3] * mover.axis_x + body[4] * mover.axis_y
            vy = body[4] * mover.axis_x - body[3] * mover.axis_y
            mover.asked += speed * dt
            mover.done += (vx * mover.wanted_x + vy * mover.wanted_y) / speed * dt
        turn = mover.wanted_turn
        if turn != 0.0:
            mover.asked_turn += abs(turn) * dt
            mover.done_turn += (body[5] if turn > 0.0 else -body[5]) * dt


STALL_SPEED = 0.01
"""m/s: slower commands do not stall."""
STALL_TURN = 0.02
"""rad/s: slower commands to turn do not stall."""
STALL_SHARE = 0.5
"""A robot stalls when it does less than this share of what is wanted of it."""


@compiled
def report(
    state: Any,
    movers: Any,
    first: int,
    count: int,
    interval: float,
    poses: Any,
    velocities: Any,
    distances: Any,
    stalls: Any,
) -> None:
    """After a tick of `interval` seconds: the robots' poses, velocities, ways and stalls.

    Robots are the movers from `first` to `count`. A robot stalls when, over the tick, it was
    wanted to go faster than STALL_SPEED on average and went less than STALL_SHARE of that way,
    measured along the wanted direction; or the same of turning. Wanted is what the limits of
    acceleration have left of the command: speeding up is no stall.
    """
    state, movers, poses = bare(state), bare(movers), bare(poses)
    velocities, distances, stalls = bare(velocities), bare(distances), bare(stalls)
    for i in range(first, count):
        mover = movers[i]
        body = state[i]
        at = i - first
        poses[at, 0], poses[at, 1], poses[at, 2] = body[0], body[1], _wrap(body[2])
        cosine, sine = mover.axis_x, mover.axis_y
        if not mover.driven:
            cosine, sine = math.cos(body[2]), math.sin(body[2])
        velocities[at, 0] = body[3] * cosine + body[4] * sine
        velocities[at, 1] = body[4] * cosine - body[3] * sine
        velocities[at, 2] = body[5]
        distances[at] = mover.distance
        blocked = mover.asked > STALL_SPEED * interval and mover.done < STALL_SHARE * mover.asked
        stuck = (
            mover.asked_turn > STALL_TURN * interval
            and mover.done_turn < STALL_SHARE * mover.asked_turn
        )
        stalls[at] = blocked or stuck
        mover.asked, mover.done, mover.asked_turn, mover.done_turn = 0.0, 0.0, 0.0, 0.0
