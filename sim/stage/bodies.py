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

from sim.stage.geometry import Floats, least_width, outline, reach, signed_area
from sim.stage.layout import Solid
from sim.stage.limits import SLOP

GRAVITY = 9.81
"""m/s2; only friction with the floor knows it."""


def new_space() -> pymunk.Space:
    """An empty space without gravity, tuned for bodies of about a metre and steps of 20 ms.

    collision_slop: Chipmunk lets bodies overlap that far; its default of 0.1 is 10 cm here.
    collision_bias: the share of an overlap that is left after a second; half goes in 20 ms.
    """
    space = pymunk.Space()
    space.gravity = (0.0, 0.0)
    space.collision_slop = SLOP
    space.collision_bias = 0.5**50
    space.sleep_time_threshold = math.inf
    return space


@dataclass(frozen=True)
class Form:
    """What bodies of one description have in common; computed once, however many there are."""

    schema: Any
    moment: float
    """kg m2 about the origin."""
    corners: Floats
    """(k, 2) counter-clockwise in the body's frame; none for a circle."""
    points: list[tuple[float, float]]
    reach: float
    """m, radius of the circle about the origin that holds the body."""
    girth: float
    """m, half of its width where it is narrowest."""


def form_of(schema: Any) -> Form:
    """The form of a body of the schema."""
    if schema.shape == "circle":
        corners, girth = np.zeros((0, 2)), schema.radius
    else:
        corners = outline(schema)
        girth = least_width(corners) / 2
    return Form(
        schema,
        moment_of(schema),
        corners,
        [(x, y) for x, y in corners.tolist()],
        reach(schema),
        girth,
    )


def shape_of(body: pymunk.Body, form: Form) -> pymunk.Shape:
    """The shape of a body of a form, attached to a pymunk body at its origin."""
    shape: pymunk.Shape
    if form.schema.shape == "circle":
        shape = pymunk.Circle(body, form.schema.radius)
    else:
        shape = pymunk.Poly(body, form.points)
    shape.friction = form.schema.friction
    shape.elasticity = 0.0
    return shape


def moment_of(schema: Any) -> float:
    """Moment of inertia in kg m2 about the body's origin, its mass spread evenly.

    The origin is taken for the centre of mass, for polygons too: a robot turns about its origin.
    """
    if schema.shape == "circle":
        return float(pymunk.moment_for_circle(schema.mass, 0.0, schema.radius))
    return float(pymunk.moment_for_poly(schema.mass, outline(schema).tolist()))


def dynamic_body(form: Form, pose: tuple[float, float, float]) -> pymunk.Body:
    """A body of a form that moves, at pose (x, y, yaw radians)."""
    body = pymunk.Body(form.schema.mass, form.moment)
    body.position = pose[0], pose[1]
    body.angle = pose[2]
    return body


def floor_friction(ground: pymunk.Body, body: pymunk.Body, schema: Any) -> list[pymunk.Constraint]:
    """Coulomb friction with the floor: force mu m g, torque that of a disc of the same area.

    The coefficient is the body's `friction`. A disc that turns on its face meets the torque
    2/3 mu m g r.
    """
    force = schema.friction * schema.mass * GRAVITY
    radius = schema.radius if schema.shape == "circle" else _equal_radius(outline(schema))
    return follow(ground, body, force, force * radius * 2.0 / 3.0)


def _equal_radius(vertices: Floats) -> float:
    return math.sqrt(abs(signed_area(vertices)) / math.pi)


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


def add_solids(space: pymunk.Space, solids: tuple[Solid, ...]) -> dict[int, int]:
    """Add what stands, one static body per group; returns body id -> group."""
    bodies: dict[int, pymunk.Body] = {}
    for solid in solids:
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
        space.add(shape)
    return {body.id: group for group, body in bodies.items()}
