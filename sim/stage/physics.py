"""The bodies of a stage: how they come into Chipmunk's space, settle there, and leave it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pymunk
from numpy.typing import ArrayLike, NDArray

from sim.stage import bodies
from sim.stage.chipmunk import ContactTable, addresses, state_of, take_over
from sim.stage.geometry import Floats
from sim.stage.layout import Layout
from sim.stage.records import mover
from sim.stage.steps import PARTS


class Physics:
    """Movers (movable obstacles first, then robots) as bodies, numbered as they came.

    They are out of the space until they are put into it.
    """

    def __init__(self, layout: Layout) -> None:
        self._space = bodies.new_space()
        self._ground = pymunk.Body(body_type=pymunk.Body.STATIC)
        self._space.add(self._ground)
        self._levels = layout.levels
        self._standing = bodies.add_solids(self._space, layout.solids)
        self._bodies: list[pymunk.Body] = []
        self._shapes_of: list[tuple[pymunk.Shape, ...]] = []  # by body, in the order of its parts
        self._joints: list[list[pymunk.Constraint]] = []
        self._leaders: list[pymunk.Body | None] = []
        self._grips: dict[int, tuple[int, list[pymunk.Constraint]]] = {}  # by what is held
        self._shapes: dict[Any, int] = {}
        self._forms: dict[int, bodies.Form] = {}  # by id of what they were made of, which they hold
        self._records: dict[tuple[int, int], Any] = {}  # of movers at no place, by body and drive
        self._contacts = ContactTable()
        self.machine = np.zeros(PARTS, np.uintp)
        """The addresses of what a tick's steps work with: see `steps`."""
        self.machine[:] = *addresses(self._space), *self._contacts.readers
        self.outlines: NDArray[np.float64] = np.zeros((0, 1, 2))
        """(s, k, 2) Outlines of the shapes that there are, in their own frames."""
        self.sides: NDArray[np.int64] = np.zeros(0, dtype=np.int64)
        """(s,) How many corners each has; 0 for a circle."""

    def add(self, record: Any, schema: Any, drive: Any, pose: tuple[float, float, float]) -> None:
        """Add a mover of a body and a drive (or None) of the schema, and write its record (1,)."""
        form = self._forms.get(id(schema))
        if form is None:
            form = self._forms[id(schema)] = bodies.form_of(schema)
        body = bodies.dynamic_body(form, pose)
        shapes, levels = bodies.shapes_of(body, form), self._levels.of(schema)
        for shape in shapes:
            bodies.limit_to(shape, levels)
        self._bodies.append(body)
        self._shapes_of.append(tuple(shapes))
        self._joints.append([])
        self._leaders.append(None)
        usual = self._records.get((id(schema), id(drive)))
        if usual is None:
            usual = self._records[id(schema), id(drive)] = mover(
                schema,
                drive,
                moment=form.moment,
                reach=form.reach,
                girth=form.girth,
                shape=self._shape(form.corners),
                levels=levels,
                friction=bodies.floor_friction(schema),
            )
        record[:] = usual
        record["body"] = state_of(body)
        record["x"], record["y"] = pose[0], pose[1]
        record["axis_x"], record["axis_y"] = math.cos(pose[2]), math.sin(pose[2])

    def _shape(self, corners: Floats) -> int:
        """The number of an outline (k, 2), which bodies of equal shape share."""
        key = corners.tobytes()
        if key not in self._shapes:
            self._shapes[key] = len(self._shapes)
            most = max(self.outlines.shape[1], len(corners))
            wider = np.zeros((len(self._shapes), most, 2))
            wider[:-1, : self.outlines.shape[1]] = self.outlines
            wider[-1, : len(corners)] = corners
            self.outlines, self.sides = wider, np.append(self.sides, len(corners))
        return self._shapes[key]

    def put_in(self, number: int, record: Any) -> None:
        """Put a mover into the space, with the joints that drive or brake it; its record says so.

        A driven one follows a leader of its own there, whose address stands in its record.
        """
        body, leader = self._bodies[number], self._leaders[number]
        if not self._joints[number]:
            force, torque = float(record["max_force"]), float(record["max_torque"])
            if record["driven"]:
                leader = self._leaders[number] = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
                record["leader"] = state_of(leader)
            self._joints[number] = bodies.follow(leader or self._ground, body, force, torque)
        take_over(body)
        led = [] if leader is None else [leader]
        self._space.add(body, *self._shapes_of[number], *led, *self._joints[number])
        record["inside"] = True

    def take_out(self, number: int, record: Any) -> None:
        """Take a mover out of the space, with its joints; it moves on as it did."""
        body, leader = self._bodies[number], self._leaders[number]
        led = [] if leader is None else [leader]
        self._space.remove(*self._joints[number], *led, *self._shapes_of[number], body)
        record["inside"] = False

    def settle(self, number: int, record: Any) -> None:
        """Make a mover a standing body."""
        if not record["inside"]:
            self.put_in(number, record)
        body, leader = self._bodies[number], self._leaders[number]
        self._space.remove(*self._joints[number], *([] if leader is None else [leader]))
        self._joints[number], self._leaders[number] = [], None
        body.velocity, body.angular_velocity = (0.0, 0.0), 0.0
        body.body_type = pymunk.Body.STATIC

    def hold(self, holder: int, load: int) -> None:
        """Fix a passive mover to another one, as it lies now.

        It slides on the floor no more, and the two do not touch each other.
        """
        body, held = self._bodies[holder], self._bodies[load]
        joints = bodies.grip(body, held)
        self._space.remove(*self._joints[load])
        self._space.add(*joints)
        self._grips[load] = holder, joints
        for one in (body, held):
            bodies.pass_through(one, holder + 1)

    def let_go(self, load: int) -> None:
        """Let go a mover that is held, as it lies now."""
        holder, joints = self._grips.pop(load)
        self._space.remove(*joints)
        self._space.add(*self._joints[load])
        bodies.pass_through(self._bodies[load], 0)
        if all(other != holder for other, _ in self._grips.values()):
            bodies.pass_through(self._bodies[holder], 0)

    def put(self, number: int, pose: tuple[float, float, float]) -> None:
        """Move a mover to a pose (x, y, yaw) at once, at rest."""
        body = self._bodies[number]
        body.position, body.angle = (pose[0], pose[1]), pose[2]
        if body.body_type == pymunk.Body.DYNAMIC:
            body.velocity, body.angular_velocity = (0.0, 0.0), 0.0
        if body.space is not None:
            self._space.reindex_shapes_for_body(body)

    def stand(self, group: int, frame: tuple[float, float, float]) -> None:
        """Move a group of what stands with its frame, which is at (0, 0, 0) at the start."""
        body = self._standing.get(group)  # what is not solid has none
        if body is not None:
            body.position, body.angle = (frame[0], frame[1]), frame[2]
            self._space.reindex_shapes_for_body(body)

    def names(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Ids (b,) of the bodies that can be touched, ascending, and which thing each is.

        Things as `contacts.Touches` numbers them: movers, and what stands by negative numbers.
        """
        own = np.array([body.id for body in self._bodies], dtype=np.int64)
        standing = np.array([body.id for body in self._standing.values()], dtype=np.int64)
        groups = np.array(list(self._standing), dtype=np.int64)
        ids = np.concatenate([own, standing])
        things = np.concatenate([np.arange(len(own)), -1 - groups])
        rank = np.argsort(ids)
        return ids[rank], things[rank]


def pose_of(values: ArrayLike) -> tuple[float, float, float]:
    """Three finite numbers as a pose; ValueError otherwise."""
    flat = np.asarray(values, dtype=np.float64)
    if flat.shape != (3,) or not np.isfinite(flat).all():
        raise ValueError(f"a pose is three finite numbers x, y, yaw, not {values!r}")
    return float(flat[0]), float(flat[1]), float(flat[2])
