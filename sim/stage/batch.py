"""pymunk's experimental batch access, in one place: all bodies' states and contacts as arrays.

`pymunk.batch` prepares its arguments anew in every call, which costs several times what the
call itself does for a handful of robots; so its handles are prepared once here. Rows are in
Chipmunk's order, which changes whenever a body is added, removed or made static: call `index`
after every structural change and find rows by body id.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk import batch
from pymunk._chipmunk_cffi import ffi, lib

Floats = NDArray[np.float64]
Ids = NDArray[np.uint64]

_FIELDS = batch.BodyFields
_STATE = _FIELDS.POSITION | _FIELDS.ANGLE | _FIELDS.VELOCITY | _FIELDS.ANGULAR_VELOCITY
_ORDER = _FIELDS.VELOCITY | _FIELDS.ANGULAR_VELOCITY | _FIELDS.FORCE | _FIELDS.TORQUE
_ARBITER = batch.ArbiterFields
_TOUCH = (
    _ARBITER.BODY_A_ID
    | _ARBITER.BODY_B_ID
    | _ARBITER.CONTACT_COUNT
    | _ARBITER.POINT_A_1
    | _ARBITER.POINT_B_1
    | _ARBITER.POINT_A_2
    | _ARBITER.POINT_B_2
)
_SPARE = 4
"""Numbers that a buffer must be longer than its content: pymunk reallocates a buffer that has
less than three left, which it must never do with numpy's memory."""


class BodyTable:
    """All bodies of a space: states read into an array, velocities and forces written from one.

    state (b, 6): x, y, angle, vx, vy, angular velocity, in the world's frame.
    orders (b, 6): vx, vy, angular velocity, force x, y and torque that `write` sets. Forces act
    for one step.
    """

    def __init__(self, space: pymunk.Space) -> None:
        self._space = space
        self._get = ffi.addressof(lib, "pmSpaceBodyGetIteratorFuncBatched")
        self._set = ffi.addressof(lib, "pmSpaceBodySetIteratorFuncBatched")
        self.state: Floats = np.zeros((0, 6))
        self.orders: Floats = np.zeros((0, 6))

    def index(self) -> Ids:
        """Prepare for the bodies that the space has now, and read them.

        Returns the bodies' ids (b,) in the order of the rows.
        """
        count = len(self._space.bodies)
        self._kept: list[tuple[Any, Any]] = []
        memory = np.zeros(count * 6 + _SPARE)
        names = np.zeros(count + _SPARE, dtype=np.uintp)
        written = np.zeros(count * 6 + _SPARE)
        self.state = memory[: count * 6].reshape(count, 6)
        self.orders = written[: count * 6].reshape(count, 6)
        ints = self._ints(names)
        self._read_floats = self._floats(memory)
        self._write_floats = self._floats(written)
        self._read_data = self._data(_STATE.value, self._read_floats, ints)
        self._write_data = self._data(_ORDER.value, self._write_floats, ints)
        named = self._data(_FIELDS.BODY_ID.value, self._read_floats, ints)
        lib.cpSpaceEachBody(self._space._space, self._get, named)
        if ints.num != count:
            raise RuntimeError(f"the space lists {ints.num} of its {count} bodies")
        self.read()
        return names[:count].astype(np.uint64)

    def _floats(self, memory: Floats) -> Any:
        held = ffi.from_buffer("cpFloat[]", memory)
        array = ffi.new("pmFloatArray *", {"num": 0, "max": len(held), "arr": held})
        self._keep(array, held)
        return array

    def _ints(self, memory: NDArray[np.uintp]) -> Any:
        held = ffi.from_buffer("uintptr_t[]", memory)
        array = ffi.new("pmIntArray *", {"num": 0, "max": len(held), "arr": held})
        self._keep(array, held)
        return array

    def _data(self, fields: int, floats: Any, ints: Any) -> Any:
        made = {"fields": fields, "floatArray": floats, "intArray": ints}
        data = ffi.new("pmBatchedData *", made)
        self._keep(data, (floats, ints))
        return data

    def _keep(self, made: Any, needed: Any) -> None:
        """Keep alive what `made` points to; C does not."""
        self._kept.append((made, needed))

    def read(self) -> None:
        """Fill `state` from the space."""
        self._read_floats.num = 0
        lib.cpSpaceEachBody(self._space._space, self._get, self._read_data)

    def write(self) -> None:
        """Set the velocities and forces of all bodies to `orders`."""
        self._write_floats.num = 0
        lib.cpSpaceEachBody(self._space._space, self._set, self._write_data)


class ContactTable:
    """Contacts between bodies after a step."""

    def __init__(self, space: pymunk.Space) -> None:
        self._space = space
        self._buffer = batch.Buffer()
        self._floats, self._ints = self._buffer._float_arr, self._buffer._int_arr
        self._call = ffi.addressof(lib, "pmSpaceArbiterIteratorFuncBatched")
        self._data = ffi.new(
            "pmBatchedData *",
            {
                "fields": _TOUCH.value,
                "floatArray": self._floats,
                "intArray": self._ints,
            },
        )

    def read(self) -> tuple[NDArray[np.uintp], Floats] | None:
        """Pairs of bodies that the space has in mind, or None if there are none.

        pairs (k, 3): id of one body, id of the other, number of contact points: 1 or 2, or 0 for
        a pair that touched a moment ago. points (k, 2, 2, 2): per contact point, the place on
        either body's surface in the world; only as many are set as the pair has. Their order is
        not the same from run to run (Chipmunk hashes addresses): sort before use.
        """
        self._floats.num = 0
        self._ints.num = 0
        lib.cpSpaceEachCachedArbiter(self._space._space, self._call, self._data)
        if self._ints.num == 0:
            return None
        pairs = np.frombuffer(self._buffer.int_buf(), np.uintp).reshape(-1, 3).copy()
        points = np.frombuffer(self._buffer.float_buf(), np.float64).reshape(-1, 2, 2, 2).copy()
        return pairs, points
