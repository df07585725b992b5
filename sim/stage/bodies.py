"""pymunk bodies for robots, movable obstacles and what stands, and the joints between them.

Dry friction with the floor, a drive, and the grip of wheels are one and the same thing for the
solver: a constraint on velocities with a limited force. A driven robot that may meet something
follows a kinematic body of its own (which collides with nothing) that moves with the wanted
twist: a pivot joint without position correction passes on at most `max_force` in whatever
direction, a motor at most `max_torque`. For wheels this is the friction circle of tyres: what a
differential or a car drive spends on pushing ahead it lacks for holding sideways, and a push
sideways beyond `max_force` makes it skid. Because the solver treats joints and contacts
together, a robot that stands holds its ground against a push up to `max_force` instead of
creeping.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pymunk

from sim.stage.geometry import Floats, girth, outline, pieces, reach, signed_area
from sim.stage.levels import EVERY_LEVEL
from sim.stage.limits import SLOP
from sim.stage.standing import Solid

GRAVITY = 9.81
"""m/s2; only friction with the floor knows it."""
ERROR_BIAS = 0.5**50
"""The share of an overlap, or of joints' error that is left after a second; half goes in 20 ms."""


def new_space() -> pymunk.Space:
    """An empty space without gravity, tuned for bodies of about a metre and steps of 20 ms.

    collision_slop: Chipmunk lets bodies overlap that far; its default of 0.1 is 10 cm here.
    """
    space = pymunk.Space()
    space.gravity = (0.0, 0.0)
    space.collision_slop = SLOP
    space.collision_bias = ERROR_BIAS
    space.sleep_time_threshold = math.inf
    return space


@dataclass(frozen=True)
class Form:
    """What bodies of one description have in common; computed once, however many there are."""

    schema: Any
    moment: float
    """kg m2 about the origin."""
    corners: Floats
    """(k, 2) of the convex hull, counter-clockwise in the body's frame; none for a circle."""
    reach: float
    """m, radius of the circle about the origin that holds the body."""
    girth: float
    """m, half of its width where it is narrowest."""
    pieces: tuple[tuple[list[tuple[float, float]], tuple[float, float, float] | None], ...]
    """The parts that it is made of: corners, or x, y and radius of a circle."""


def form_of(schema: Any) -> Form:
    """The form of a body of the schema."""
    corners = np.zeros((0, 2)) if schema.shape == "circle" else outline(schema)
    parts = [([(x, y) for x, y in one.tolist()], circle) for one, circle in pieces(schema)]
    return Form(schema, moment_of(schema), corners, reach(schema), girth(schema), tuple(parts))


def shapes_of(body: pymunk.Body, form: Form) -> list[pymunk.Shape]:
    """The shapes of a body of a form, attached to a pymunk body at its origin."""
    found: list[pymunk.Shape] = []
    for vertices, circle in form.pieces:
        shape: pymunk.Shape
        if circle is not None:
            shape = pymunk.Circle(body, circle[2], circle[:2])
        else:
            shape = pymunk.Poly(body, vertices)
        shape.friction = form.schema.friction
        shape.elasticity = 0.0
        found.append(shape)
    return found


def moment_of(schema: Any) -> float:
    """Moment of inertia in kg m2 about the body's origin, its mass spread evenly over its parts.

    The origin is taken for the centre of mass, for polygons too: a robot turns about its origin.
    """
    area, moment = area_of(schema), 0.0
    for vertices, circle in pieces(schema):
        mass = schema.mass * (signed_area(vertices) / area)
        if circle is not None:
            moment += float(pymunk.moment_for_circle(mass, 0.0, circle[2], circle[:2]))
        else:
            moment += float(pymunk.moment_for_poly(mass, vertices.tolist()))
    return moment


def area_of(schema: Any) -> float:
    """The area of all parts in m2."""
    return sum(signed_area(vertices) for vertices, _ in pieces(schema))


def dynamic_body(form: Form, pose: tuple[float, float, float]) -> pymunk.Body:
    """A body of a form that moves, at pose (x, y, yaw radians)."""
    body = pymunk.Body(form.schema.mass, form.moment)
    body.position = pose[0], pose[1]
    body.angle = pose[2]
    return body


def floor_friction(schema: Any) -> tuple[float, float]:
    """Coulomb friction with the floor: force mu m g (N), torque (N m) of a disc of the same area.

    The coefficient is the body's `friction`. A disc that turns on its face meets the torque
    2/3 mu m g r.
    """
    force = schema.friction * schema.mass * GRAVITY
    round_one = schema.shape == "circle"
    radius = schema.radius if round_one else math.sqrt(area_of(schema) / math.pi)
    return force, force * radius * 2.0 / 3.0


def follow(
    leader: pymunk.Body, body: pymunk.Body, force: float, torque: float
) -> list[pymunk.Constraint]:
    """Joints that make a body take over its leader's velocities, with limited force and torque."""
    pivot = pymunk.PivotJoint(leader, body, (0.0, 0.0), (0.0, 0.0))
    pivot.max_bias = 0.0  # velocities are led, positions are not
    pivot.max_force = force
    motor = pymunk.SimpleMotor(leader, body, 0.0)
    motor.max_force = torque
    return [pivot, motor]


def grip(holder: pymunk.Body, load: pymunk.Body) -> list[pymunk.Constraint]:
    """Joints that keep a body where it is in another one's frame, and as it is turned there."""
    at = holder.world_to_local(load.position)
    pivot = pymunk.PivotJoint(holder, load, at, (0.0, 0.0))
    gear = pymunk.GearJoint(holder, load, load.angle - holder.angle, 1.0)
    for joint in (pivot, gear):
        joint.error_bias = ERROR_BIAS
    return [pivot, gear]


def pass_through(body: pymunk.Body, group: int) -> None:
    """Let the shapes of bodies of one group above 0 pass through each other; 0: of none."""
    for shape in body.shapes:
        old = shape.filter
        shape.filter = pymunk.ShapeFilter(group, old.categories, old.mask)


def limit_to(shape: pymunk.Shape, levels: int) -> None:
    """Let a shape touch only what shares one of these bits of heights with it."""
    if levels != EVERY_LEVEL:
        shape.filter = pymunk.ShapeFilter(categories=levels, mask=levels)


def add_solids(space: pymunk.Space, solids: tuple[Solid, ...]) -> dict[int, pymunk.Body]:
    """Add what stands and is solid, one static body per group; returns them by their groups."""
    bodies: dict[int, pymunk.Body] = {}
    for solid in solids:
        if not solid.levels:
            continue
        if solid.group not in bodies:
            bodies[solid.group] = pymunk.Body(body_type=pymunk.Body.STATIC)
            space.add(bodies[solid.group])
        body = bodies[solid.group]
        shape: pymunk.Shape
        if solid.circle is None:
            shape = pymunk.Poly(body, solid.vertices.tolist())
        else:
            shape = pymunk.Circle(body, solid.circle[2], solid.circle[:2])
        shape.friction = solid.friction
        limit_to(shape, solid.levels)
        space.add(shape)
    return bodies
