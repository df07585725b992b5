"""One client of a server: its socket, and bytes between that and its session.

Nothing here blocks. What connections share, such as the selector, is their `Desk`.
"""

from __future__ import annotations

import contextlib
import selectors
import socket
from collections.abc import Callable, Sequence
from time import monotonic
from typing import NamedTuple

from player.codes import DataMode
from player.directory import Datum
from player.events import Event, Malformed
from player.session import Session
from player.transport import quick_acknowledge

RECEIVE_SIZE = 1 << 14
"""Bytes taken from one connection before the others have their turn."""

HELD_FOR = 0.05
"""Wall-clock seconds for which the news that a request for data has been heard waits for the data,
so as to travel in one piece with it: far below what any client waits for an answer."""

_PULL = DataMode.PULL


class Connected(NamedTuple):
    """A client has connected over TCP."""

    peer: str


class Disconnected(NamedTuple):
    """The connection is gone; `reason` says why: the client closed it, it broke, or was refused."""

    reason: str


ServerEvent = Event | Connected | Disconnected
"""What `poll` tells about a connection."""


class Desk:
    """What the connections of one server share: whom they wait for, and what they have heard."""

    def __init__(self) -> None:
        self.selector = selectors.DefaultSelector()
        self.connections: set[Connection] = set()
        self.ready: dict[Connection, None] = {}
        """Those whose sessions have something to say."""
        self.held: dict[Connection, None] = {}
        """Those that have something to say which can wait for more."""
        self._held_until = 0.0
        self.events: list[tuple[Connection, ServerEvent]] = []

    def hold(self, connection: Connection) -> None:
        """What a session has to say may wait for what it says next, but not for long."""
        if not self.held:
            self._held_until = monotonic() + HELD_FOR
        self.held[connection] = None

    @property
    def held_for(self) -> float:
        """Seconds for which they can wait still."""
        return self._held_until - monotonic()

    def write_ready(self) -> None:
        """Writes what sessions have to say, as far as their sockets take it."""
        while self.ready:
            ready, self.ready = self.ready, {}
            for connection in ready:
                self.held.pop(connection, None)
                if connection.is_open:
                    connection.proceed()


class Connection:
    """One client: its session and its socket, which does not block. Made by `Server`.

    `gone` is called when the connection has ended, whoever has ended it.
    """

    __slots__ = (
        "_deaf",
        "_desk",
        "_gone",
        "_mask",
        "_paused",
        "_socket",
        "_unsent",
        "is_open",
        "peer",
        "port",
        "session",
    )

    def __init__(
        self,
        desk: Desk,
        sock: socket.socket,
        session: Session,
        peer: str,
        port: int,
        gone: Callable[[Connection], None],
    ) -> None:
        self.session = session
        self.peer = peer
        """Who is there: `127.0.0.1:50123`, or what `adopt` was told."""
        self.port = port
        """The port it came in by, 0 for adopted sockets."""
        self.is_open = True
        self._desk = desk
        self._gone = gone
        self._socket = sock
        self._deaf = False  # nobody reads at the other end any more
        self._unsent: memoryview | None = None
        self._paused = False  # bytes are left unread in the session until it has been written
        self._mask = 0
        session.on_output(lambda: desk.ready.__setitem__(self, None), lambda: desk.hold(self))
        desk.ready[self] = None
        desk.connections.add(self)
        self._select(selectors.EVENT_READ)

    def __repr__(self) -> str:
        return f"<Connection of {self.peer}{'' if self.is_open else ', closed'}>"

    @property
    def unsent(self) -> int:
        """Bytes taken from the session and not yet taken by the socket."""
        return len(self._unsent) if self._unsent is not None else 0

    def flush(self) -> None:
        """Writes what the session has to say, as far as the socket takes it at once."""
        if self.is_open:
            self.proceed()
            self._desk.ready.pop(self, None)
            self._desk.held.pop(self, None)

    def publish_round(self, data: Sequence[Datum], time: float) -> None:
        """All data of a tick, as `Session.publish_round`, and writes it as `flush` does."""
        self.session.publish_round(data, time)
        self.flush()

    def take_round(self, piece: memoryview, messages: int) -> bool:
        """Writes a round that is encoded already, if that is all its client waits for.

        `piece` is from the acknowledgement to the end, and may change afterwards; False: nothing
        has been done.
        """
        can = self._unsent is None and not self._deaf and self.is_open
        said = self.session.round_ready(piece, messages) if can else None
        if said is not None:
            self._write_at_once(said)
        return said is not None

    def close(self) -> None:
        """Writes what the socket takes at once, and closes. No Disconnected event follows."""
        if self.is_open:
            self.write()
        if self.is_open:
            self._drop()

    # -- bytes in ---------------------------------------------------------------------------

    def read(self) -> None:
        """Takes what has come. Of a client over TCP, what comes for an acknowledgement as well.

        Who writes a command and then a request, with Nagle's algorithm on as in Player's own
        library, has the request wait until the command is acknowledged.
        """
        session = self.session
        if not self._receive() or not self.port or session.waiting:
            return  # what is said to a client acknowledges what came
        quick_acknowledge(self._socket)
        if session.mode is _PULL:
            self._receive()

    def _receive(self) -> bool:
        """Takes bytes that have come; False if there are none, or will be none any more."""
        try:
            data = self._socket.recv(RECEIVE_SIZE)
        except (BlockingIOError, InterruptedError):
            return False
        except OSError as error:
            self._lose(f"the connection broke: {error.strerror}")
            return False
        if not data:
            self._lose("the client closed the connection")
            return False
        self._take(data)
        return self.is_open

    def _take(self, data: bytes) -> None:
        session = self.session
        while True:
            events = session.receive(data)
            self._desk.events += [(self, event) for event in events]
            if session.broken:
                if events and type(events[-1]) is Malformed:
                    self.write()
                    if self.is_open:
                        self._lose(f"not Player's protocol: {events[-1].reason}")
                return
            if not session.stalled:
                return
            self.write()
            if not self.is_open:
                return
            if session.stalled:
                self._paused = True
                return
            data = b""

    # -- bytes out --------------------------------------------------------------------------

    def proceed(self) -> None:
        """Writes; then takes what the client had sent before and was left unread."""
        self.write()
        if self._paused and self.is_open and not self.session.stalled:
            self._paused = False
            self._take(b"")

    def write(self) -> None:
        session = self.session
        unsent: bytes | memoryview | None = self._unsent
        self._unsent = None
        while not self._deaf:
            data = session.outgoing() if unsent is None else unsent
            if not data:
                break
            try:
                sent = self._socket.send(data)
            except (BlockingIOError, InterruptedError):
                sent = 0
            except OSError:
                # It has closed; what it said before that is still to be read, up to its end.
                self._deaf = True
                break
            if sent < len(data):
                self._unsent = memoryview(data)[sent:]
                # A client that asks and does not read is not read from until it does.
                wanted = 0 if session.stalled else selectors.EVENT_READ
                self._select(wanted | selectors.EVENT_WRITE)
                return
            if unsent is None:
                break  # all that the session had
            unsent = None
        if self._deaf:
            session.outgoing()
        if self._mask != selectors.EVENT_READ:
            self._select(selectors.EVENT_READ)

    def _write_at_once(self, piece: bytes | memoryview) -> None:
        """Writes a piece that nothing is before; it may change afterwards."""
        desk = self._desk
        if desk.ready:
            desk.ready.pop(self, None)
        if desk.held:
            desk.held.pop(self, None)
        try:
            sent = self._socket.send(piece)
        except OSError:
            sent = 0  # whatever it is: the plain way finds it again
        if sent < len(piece):
            self._unsent = memoryview(bytes(piece[sent:]))
            self.proceed()

    # -- its end ----------------------------------------------------------------------------

    def _lose(self, reason: str) -> None:
        self._drop()
        self._desk.events.append((self, Disconnected(reason)))

    def _drop(self) -> None:
        desk = self._desk
        self.is_open = False
        self.session.close()
        self._select(0)
        desk.connections.discard(self)
        desk.ready.pop(self, None)
        desk.held.pop(self, None)
        with contextlib.suppress(OSError):
            self._socket.close()
        self._gone(self)

    def _select(self, mask: int) -> None:
        if mask == self._mask:
            return
        if not self._mask:
            self._desk.selector.register(self._socket, mask, self)
        elif not mask:
            self._desk.selector.unregister(self._socket)
        else:
            self._desk.selector.modify(self._socket, mask, self)
        self._mask = mask
