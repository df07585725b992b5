"""The options of the controller `paint`: what a robot is told before it starts."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence

import numpy as np

from .brain import PATIENCE, Settings
from .constants import ARENA, EPSILON, OVERLAP, SPRAYER
from .geometry import Region, rectangle
from .moves.room import STAND_KEEP
from .moves.twist import LIMITS, Limits


def _point(text: str) -> tuple[float, float]:
    try:
        x, y = (float(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a corner X,Y such as 2,1.5") from None
    if not (math.isfinite(x) and math.isfinite(y)):
        raise argparse.ArgumentTypeError(f"{text!r} is not finite")
    return x, y


def _positive(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (value > 0.0 and math.isfinite(value)):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number above 0")
    return value


def _not_negative(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (value >= 0.0 and math.isfinite(value)):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of at least 0")
    return value


def parse(arguments: Sequence[str] | None = None) -> Settings:
    """The settings that options give; exits with a message (code 2) where they make no sense."""
    parser = argparse.ArgumentParser(
        prog="paint",
        description="Drives one robot of a swarm that paints a region by algorithm Paint.",
    )
    parser.add_argument("--robots", type=int, default=4, help="how many robots there are")
    parser.add_argument(
        "--paint",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="paint the strip, or stop at the goal",
    )
    parser.add_argument(
        "--arena", type=_positive, nargs="+", action="extend", metavar="M",
        help=f"the arena's width and height, m (default {ARENA[0]:g} {ARENA[1]:g})",
    )  # fmt: skip
    parser.add_argument(
        "--corners", type=_point, nargs="+", action="extend", metavar="X,Y",
        help="the corners of a convex region, m, in any frame with axes parallel to the robots'",
    )  # fmt: skip
    parser.add_argument(
        "--jitter", type=_not_negative, default=0.0,
        help="s; cycles have random lengths up to this (0: every reading begins one)",
    )  # fmt: skip
    parser.add_argument(
        "--speed", type=_positive, default=LIMITS.speed, help="m/s that robots drive at most"
    )
    parser.add_argument(
        "--turn-rate", type=_positive, default=math.degrees(LIMITS.turn_rate), help="degrees/s"
    )
    parser.add_argument(
        "--sprayer", type=_positive, nargs="+", action="extend", metavar="M",
        help=f"length and width of what it paints, m (default {SPRAYER[0]:g} {SPRAYER[1]:g})",
    )  # fmt: skip
    parser.add_argument(
        "--patience", type=_positive, default=PATIENCE,
        help="s after which it gives up if it is not painting yet (default %(default)g)",
    )  # fmt: skip
    args = parser.parse_args(arguments)
    if args.robots < 1:
        parser.error(f"--robots {args.robots}: there is at least one")
    for name in ("arena", "sprayer"):
        pair = getattr(args, name)
        if pair is not None and len(pair) != 2:
            parser.error(f"--{name} takes two numbers, not {len(pair)}")
    if args.arena and args.corners:
        parser.error("--arena and --corners: give one of them")
    try:
        shape = (
            Region(np.array(args.corners)) if args.corners else rectangle(*(args.arena or ARENA))
        )
    except ValueError as error:
        parser.error(f"--corners: {error}")
    height = (shape.top - shape.bottom) / args.robots
    if height < EPSILON:
        parser.error(
            f"--robots {args.robots}: strips of {height:.2f} m are too low, at least {EPSILON} m "
            f"are needed, so at most {int((shape.top - shape.bottom) / EPSILON)} robots"
        )
    sprayer = tuple(args.sprayer) if args.sprayer else SPRAYER
    needed = STAND_KEEP + 2.0 * OVERLAP
    if args.robots > 1 and min(sprayer) < needed:
        parser.error(
            f"--sprayer {sprayer[0]:g} {sprayer[1]:g}: at least {needed:g} m are needed, or "
            "bodies that paint beside each other would touch"
        )
    return Settings(
        robots=args.robots,
        paint=args.paint,
        shape=shape,
        jitter=args.jitter,
        limits=Limits(args.speed, math.radians(args.turn_rate), LIMITS.interval),
        sprayer=sprayer,
        patience=args.patience,
    )
