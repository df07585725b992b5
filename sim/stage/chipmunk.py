"""Chipmunk as it lies within pymunk: its functions' addresses, and those of what they work on.

Rules: this file alone uses what pymunk keeps to itself; it says so when pymunk's insides have
changed, at import. What pymunk would do for each body in Python, or by a function of C that is
called for each, compiled code does by these addresses.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pymunk
from pymunk import batch
from pymunk._chipmunk_cffi import ffi, lib

from sim.stage.memory import ANGLE, PLACE

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


FUNCTIONS = (
    "cpSpaceStep",
    "cpSpaceEachCachedArbiter",
    "cpSpaceSetIterations",
    "pmSpaceArbiterIteratorFuncBatched",
)
"""Those that a tick's steps call, in the order in which `addresses` gives them."""


ARRAY = (("num", "int"), ("max", "int"))
LAYOUT = {
    "pmFloatArray": (*ARRAY, ("arr", "double *")),
    "pmIntArray": (*ARRAY, ("arr", "uintptr_t *")),
}
"""The structs that compiled code reads and writes by itself: their members, in order."""

WITHIN = 32
"""Doubles at the beginning of a body's struct among which its state is looked for."""


def state_offset() -> int:
    """Bytes from a body's address to its state, as `memory` has it; -1 if it does not lie so."""
    body = pymunk.Body(1.0, 1.0)
    body.position, body.velocity, body.force = (101.5, 102.5), (103.5, 104.5), (105.5, 106.5)
    body.angle, body.angular_velocity, body.torque = 107.5, 108.5, 109.5
    found = np.frombuffer(ffi.buffer(ffi.cast("char *", body._body), 8 * WITHIN)).tolist()
    wanted = [101.5 + number for number in range(9)]
    places = [at for at in range(WITHIN - 8) if found[at : at + 9] == wanted]
    return 8 * places[0] if places else -1


def changed_parts() -> list[str]:
    """What of pymunk's insides is not as this file needs it; nothing, if all is."""
    parts = [(lib, name) for name in FUNCTIONS]
    parts += [(batch.Buffer(), "_float_arr"), (batch.Buffer(), "_int_arr")]
    parts += [(pymunk.Space(), "_space"), (pymunk.Body(1.0, 1.0), "_body")]
    changed = [name for owner, name in parts if not hasattr(owner, name)]
    for name, members in LAYOUT.items():
        found = tuple((member, field.type.cname) for member, field in ffi.typeof(name).fields)
        if found != members:
            changed.append(name)
    if "_body" not in changed and state_offset() < 0:
        changed.append("cpBody")
    return changed


if CHANGED := changed_parts():
    raise ImportError(
        f"pymunk {pymunk.version} is not what Troupe needs inside ({', '.join(CHANGED)}): "
        "install pymunk>=7.1,<8"
    )

STATE = state_offset()


def addresses(space: pymunk.Space) -> tuple[int, ...]:
    """The addresses of FUNCTIONS, and then that of a space."""
    functions = (ffi.cast("uintptr_t", ffi.addressof(lib, name)) for name in FUNCTIONS)
    return (*map(int, functions), pointer(space._space))


def state_of(body: pymunk.Body) -> int:
    """The address of a body's state: `memory` says what lies there, while the body is there."""
    return pointer(body._body) + STATE


def take_over(body: pymunk.Body) -> None:
    """Have Chipmunk know where a body is that was moved by what lies in its state alone.

    It keeps the place of a body's origin, and how it is turned, a second time: its functions go
    by that one, and bring it up to date only when they move the body.
    """
    state = ffi.cast("double *", state_of(body))
    body.position, body.angle = (state[PLACE], state[PLACE + 1]), state[ANGLE]


def pointer(thing: Any) -> int:
    """The address of what a cffi pointer points to."""
    return int(ffi.cast("uintptr_t", thing))


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
