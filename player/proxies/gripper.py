"""A gripper: what is between its paddles, and opening and closing them."""

from __future__ import annotations

from typing import NamedTuple

from player import layouts
from player.codes import Interface
from player.errors import XdrError
from player.proxies.base import Proxy, Size, geometry, reading
from player.xdr import Pose3d

_STATE = layouts.data(Interface.GRIPPER).head

OPEN, CLOSED = 1, 2
"""Player's numbers of states; while paddles move it is 3, and 4 after an error."""


class GripperGeometry(NamedTuple):
    """Where a gripper is on its robot, metres and radians, and how large it is.

    `inner_size` is the space between its paddles when they are open; `beams` that its light beams
    are so many, and `capacity` how many things it can store.
    """

    pose: Pose3d
    outer_size: Size
    inner_size: Size
    beams: int
    capacity: int


class GripperProxy(Proxy):
    """Player's gripper."""

    interface = Interface.GRIPPER

    state: int = reading()
    """1 open, 2 closed, 3 moving, 4 an error."""
    beams: int = reading()
    """A bit for each light beam that something breaks. Stage's grippers, and ours, have two: 4 is
    the inner one, 8 the one at the paddles' tips."""
    stored: int = reading()
    """How many things are stored."""

    def decode(self, subtype: int, payload: bytes) -> None:
        """STATE; see Proxy."""
        if subtype != 1:
            return
        if len(payload) != _STATE.size:
            raise XdrError(f"{self.addr}: {len(payload)} bytes of a state ({_STATE.size} expected)")
        self.state, self.beams, self.stored = _STATE.unpack(payload)

    @property
    def opened(self) -> bool:
        """Whether the paddles are open."""
        return self.state == OPEN

    @property
    def closed(self) -> bool:
        """Whether the paddles are closed, on something or on nothing."""
        return self.state == CLOSED

    def open_paddles(self) -> None:
        """Commands the paddles to open: what they hold is let go."""
        self._command(1)

    def close_paddles(self) -> None:
        """Commands the paddles to close on what lies between (`close` ends the subscription)."""
        self._command(2)

    def stop(self) -> None:
        """Commands the paddles to stop where they are."""
        self._command(3)

    def store(self) -> None:
        """Commands that what is held be put away, where a gripper can."""
        self._command(4)

    def retrieve(self) -> None:
        """Commands that something be taken out of the store."""
        self._command(5)

    def request_geometry(self) -> GripperGeometry:
        """Where the gripper is mounted, and its sizes."""
        reply = self._request(1)
        outer = geometry({"pose": reply["pose"], "size": reply["outer_size"]})
        inner = geometry({"pose": reply["pose"], "size": reply["inner_size"]})
        beams, capacity = int(reply["beams"]), int(reply["capacity"])
        return GripperGeometry(outer.pose, outer.size, inner.size, beams, capacity)
