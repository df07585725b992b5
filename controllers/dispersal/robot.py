"""The program that drives one robot by a rule of uniform dispersal.

Time is cut into steps of a fixed period. A robot looks when a step begins, asks its rule, goes to
the centre of the next cell and waits there for the next step. It never knows its cell in the map:
it knows which way is up (its heading when it entered), how wide cells are, and the time. When it
settles it reports and ends; its body stays.
"""

from __future__ import annotations

import argparse
import math
import os

import numpy as np

from controllers.dispersal import chance
from controllers.dispersal.look import active, occupied
from controllers.dispersal.rules import DICE, LIGHTS, RULES, SENSES, SETTLE, STAY, TALK
from controllers.motion import Twist, approach, slide_to, wrap
from player import (
    BlobfinderProxy,
    LaserProxy,
    PlayerClient,
    Position2dProxy,
    SimulationProxy,
    SpeechProxy,
)

STEPS_AHEAD = ((1.0, 0.0), (0.0, -1.0), (-1.0, 0.0), (0.0, 1.0))
"""Up, right, down, left in the robot's own frame, whose x axis is up."""

ACTIVE_COLOR = 0x00FF00
SETTLED_COLOR = "#0000ff"
"""The light: a robot's body is green while it is active and blue when it has settled."""


def main() -> None:
    """Drive one robot until it settles or the run is over."""
    args = parse()
    with PlayerClient() as robot:
        Disperser(robot, args).run()


def parse() -> argparse.Namespace:
    """The program's options."""
    options = argparse.ArgumentParser(prog="fcdfs", description=__doc__)
    rules = [name for name in RULES if not SENSES.get(name, 0) & TALK]
    options.add_argument(
        "--rule", choices=rules, default="fcdfs5", help="what to do in a step; light is AsynchFCDFS"
    )
    options.add_argument("--cell", type=float, default=1.5, help="width of a cell in metres")
    options.add_argument("--body", type=float, default=1.0, help="width of a body in metres")
    options.add_argument("--period", type=float, default=4.0, help="seconds per step")
    options.add_argument("--speed", type=float, default=0.8, help="m/s at the most")
    options.add_argument("--turn-rate", type=float, default=1.5, help="rad/s at the most")
    options.add_argument(
        "--turns", action=argparse.BooleanOptionalAction, default=False,
        help="turn to where it goes, as a differential drive must",
    )  # fmt: skip
    options.add_argument("--q", type=float, default=0.0, help="probability to miss a step")
    options.add_argument(
        "--number", type=int, default=os.environ.get("TROUPE_NUMBER"),
        help="the robot's place in the order of entry, from 1: chance depends on it "
        "(default: TROUPE_NUMBER, which Troupe tells its programs)",
    )  # fmt: skip
    args = options.parse_args()
    if args.number is None and (args.q > 0 or SENSES.get(args.rule, 0) & DICE):
        options.error("with chance in it, --number (or TROUPE_NUMBER) must be given")
    return args


class Disperser:
    """One robot at work: its rule's state, and where its own odometry says it is to be."""

    def __init__(self, robot: PlayerClient, args: argparse.Namespace) -> None:
        self.robot = robot
        self.args = args
        self.base = Position2dProxy(robot)
        self.lasers = [LaserProxy(robot, 0), LaserProxy(robot, 1)]
        self.mounts = [laser.request_geometry().pose[5] for laser in self.lasers]
        self.senses = SENSES.get(args.rule, 0)
        self.cameras = []
        if self.senses & LIGHTS:
            self.cameras = [BlobfinderProxy(robot, 0), BlobfinderProxy(robot, 1)]
        self.speech = SpeechProxy(robot)
        self.simulation = SimulationProxy(robot)
        self.number: int = args.number or 0
        self.run_seed = int(os.environ.get("TROUPE_SEED", "0"))
        self.state = 0
        self.travel = 0
        self.goal = (0.0, 0.0)
        self.heading = 0.0  # of the way to the goal
        self.interval = 1.0 / self.lasers[0].request_configuration().scanning_frequency

    def run(self) -> None:
        """Step by step until settled, or until the run is over."""
        step = 0
        while self.robot.read():
            if not all(proxy.valid for proxy in (self.base, *self.lasers, *self.cameras)):
                continue  # a server may be slow with its first readings
            # A step's look is taken one reading after the step began: a robot that entered just
            # then has its first reading, and nobody has moved yet.
            began = self.robot.time - self.interval
            current = math.floor(began / self.args.period + 1e-6) + 1
            if current > step:
                step = current
                if self.decide(step):
                    return
            self.move()

    def decide(self, step: int) -> bool:
        """Look and compute; True once settled."""
        if not chance.activated(self.run_seed, self.number, step, self.args.q):
            return False
        rule = RULES[self.args.rule]
        self.state, move = rule(self.state, self.look(step))
        if move == SETTLE:
            self.settle(step)
            return True
        if move != STAY:
            ahead, left = STEPS_AHEAD[move]
            cell = self.args.cell
            self.goal = (self.goal[0] + ahead * cell, self.goal[1] + left * cell)
            self.heading = math.atan2(left, ahead)
            self.travel += 1
        return False

    def look(self, step: int) -> int:
        """What the rule sees, from both lasers, and both cameras if it needs the lights."""
        yaw, cell, body = self.base.yaw, self.args.cell, self.args.body
        bearings = np.concatenate(
            [
                laser.bearings + mount + yaw
                for laser, mount in zip(self.lasers, self.mounts, strict=True)
            ]
        )
        ranges = np.concatenate([laser.ranges for laser in self.lasers])
        seen = occupied(bearings, ranges, cell, body)
        if self.senses & LIGHTS:
            images = [(camera, math.pi, mount + yaw) for camera, mount in
                      zip(self.cameras, self.mounts, strict=True)]  # fmt: skip
            seen |= active(images, ACTIVE_COLOR, seen)
        if self.senses & DICE:
            die = chance.draw(self.run_seed, self.number, step, chance.DIE) >> 16
            seen |= die << 32
        return seen

    def move(self) -> None:
        """Towards the centre of the cell where this step ends."""
        pose = (self.base.x, self.base.y, self.base.yaw)
        args = self.args
        if not args.turns:
            twist = slide_to(pose, self.goal, 0.0, args.speed, args.turn_rate, self.interval)
        else:
            twist = self.turn_and_drive(pose)
        self.base.set_speed(twist.vx, twist.vyaw, vy=twist.vy)

    def turn_and_drive(self, pose: tuple[float, float, float]) -> Twist:
        """First turn to where the step goes, then drive along it; small errors are steered away."""
        dx, dy = self.goal[0] - pose[0], self.goal[1] - pose[1]
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        along, across = cos * dx + sin * dy, cos * dy - sin * dx
        turn = wrap(self.heading - pose[2])
        if abs(turn) > 0.02 and along > 0.05:
            return Twist(0.0, 0.0, approach(turn, self.args.turn_rate, self.interval))
        steer = turn + max(-0.2, min(0.2, 2.0 * across)) * (along > 0.05)
        speed = approach(along, self.args.speed, self.interval)
        return Twist(speed, 0.0, approach(steer, self.args.turn_rate, self.interval))

    def settle(self, step: int) -> None:
        """Report, show the light, and be done."""
        self.base.set_speed(0.0)
        self.speech.say(f"settled in step {step}")
        self.simulation.report("travel", self.travel)
        self.simulation.report("settled_step", step)
        self.simulation.report("bits", f"{self.state & 31:05b}")
        if self.senses & LIGHTS:
            self.simulation.report("color", SETTLED_COLOR)


if __name__ == "__main__":
    main()
