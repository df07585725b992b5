"""Chipmunk as it lies within pymunk: its functions' addresses, and all bodies' states as arrays.

Rules: this file alone uses what pymunk keeps to itself; it says so when pymunk's insides have
changed, at import. `pymunk.batch`, which is experimental, prepares its arguments anew in every
call, which costs several times what the call itself does for a handful of robots; so its handles
are prepared once here. Rows are in Chipmunk's order, which changes whenever a body is added,
removed or made static: call `index` after every structural change and find rows by body id.
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


FUNCTIONS = (
    "cpSpaceStep",
    "cpSpaceEachBody",
    "cpSpaceEachCachedArbiter",
    "cpSpaceSetIterations",
    "pmSpaceBodyGetIteratorFuncBatched",
    "pmSpaceBodySetIteratorFuncBatched",
    "pmSpaceArbiterIteratorFuncBatched",
)
"""Those that a tick's steps call, in the order in which `addresses` gives them."""


ARRAY = (("num", "int"), ("max", "int"))
LAYOUT = {
    "pmFloatArray": (*ARRAY, ("arr", "double *")),
    "pmIntArray": (*ARRAY, ("arr", "uintptr_t *")),
}
"""The structs that compiled code reads and writes by itself: their members, in order."""


def changed_parts() -> list[str]:
    """What of pymunk's insides is not as this file needs it; nothing, if all is."""
    parts = [(lib, name) for name in FUNCTIONS]
    parts += [(batch.Buffer(), "_float_arr"), (batch.Buffer(), "_int_arr")]
    parts += [(pymunk.Space(), "_space")]
    changed = [name for owner, name in parts if not hasattr(owner, name)]
    for name, members in LAYOUT.items():
        found = tuple((member, field.type.cname) for member, field in ffi.typeof(name).fields)
        if found != members:
            changed.append(name)
    return changed


if CHANGED := changed_parts():
    raise ImportError(
        f"pymunk {pymunk.version} is not what Troupe needs inside ({', '.join(CHANGED)}): "
        "install pymunk>=7.1,<8"
    )


def addresses(space: pymunk.Space) -> tuple[int, ...]:
    """The addresses of FUNCTIONS, and then that of a space."""
    functions = (ffi.cast("uintptr_t", ffi.addressof(lib, name)) for name in FUNCTIONS)
    return (*map(int, functions), pointer(space._space))


def pointer(thing: Any) -> int:
    """The address of what a cffi pointer points to."""
    return int(ffi.cast("uintptr_t", thing))


class BodyTable:
    """All bodies of a space: states read into an array, velocities and forces written from one.

    state (b, 6): x, y, angle, vx, vy, angular velocity, in the world's frame.
    orders (b, 6): vx, vy, angular velocity, force x, y and torque, to be written. Forces act for
    one step.
    readers, writers: the addresses of what pymunk's functions for one body are given, and of the
    buffer of which they count up how much is in it.
    """

    def __init__(self, space: pymunk.Space) -> None:
        self._space = space
        self._get = ffi.addressof(lib, "pmSpaceBodyGetIteratorFuncBatched")
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
        write_floats = self._floats(written)
        self._read_data = self._data(_STATE.value, self._read_floats, ints)
        written_data = self._data(_ORDER.value, write_floats, ints)
        self.readers = pointer(self._read_data), pointer(self._read_floats)
        self.writers = pointer(written_data), pointer(write_floats)
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


class ContactTable:
    """Contacts between bodies after a step, in buffers of pymunk's that it moves as they grow.

    Per pair of bodies that the space has in mind, 3 words: the id of one body, that of the other,
    and the number of contact points: 1 or 2, or 0 for a pair that touched a moment ago. And 2 x 2
    x 2 floats: per contact point, the place on either body's surface in the world; only as many
    are set as the pair has. The pairs' order is not the same from run to run (Chipmunk hashes
    addresses): sort before use.

    readers: the addresses of what pymunk's function for one pair is given, of the buffer of words
    and of that of floats. A buffer begins with two int32, how much is in it and how much fits;
    then comes where its numbers are.
    """

    def __init__(self) -> None:
        self._buffer = batch.Buffer()
        floats, ints = self._buffer._float_arr, self._buffer._int_arr
        made = {"fields": _TOUCH.value, "floatArray": floats, "intArray": ints}
        self._data = ffi.new("pmBatchedData *", made)
        self.readers = pointer(self._data), pointer(ints), pointer(floats)
