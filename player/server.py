"""The device server's sockets: listens, adopts socket pairs, moves bytes to and from sessions.

One thread, nothing blocks but `poll`, and nothing that is decided here depends on a clock.
"""

from __future__ import annotations

import contextlib
import errno
import selectors
import socket
from collections.abc import Callable, Sequence
from time import monotonic
from typing import Any, NamedTuple

from player.codes import DataMode
from player.directory import Datum, Directory
from player.session import Event, Malformed, Session
from player.transport import hurry, quick_acknowledge

RECEIVE_SIZE = 1 << 14
"""Bytes taken from one connection before the others have their turn."""

MAX_CONNECTIONS = 512
"""Connections accepted over TCP at a time; further ones are closed at once."""

LISTEN_BACKLOG = 128

_PULL = DataMode.PULL

HELD_FOR = 0.05
"""Wall-clock seconds for which the news that a request for data has been heard waits for the data,
so as to travel in one piece with it: far below what any client waits for an answer."""


class Connected(NamedTuple):
    """A client has connected over TCP."""

    peer: str


class Disconnected(NamedTuple):
    """The connection is gone; `reason` says why: the client closed it, it broke, or was refused."""

    reason: str


ServerEvent = Event | Connected | Disconnected
"""What `poll` tells about a connection."""


class Connection:
    """One client: its session and its socket. Made by `Server`."""

    __slots__ = (
        "_deaf",
        "_mask",
        "_paused",
        "_server",
        "_socket",
        "_unsent",
        "is_open",
        "peer",
        "port",
        "session",
    )

    def __init__(
        self, server: Server, sock: socket.socket, session: Session, peer: str, port: int
    ) -> None:
        self.session = session
        self.peer = peer
        """Who is there: `127.0.0.1:50123`, or what `adopt` was told."""
        self.port = port
        """The port it came in by, 0 for adopted sockets."""
        self.is_open = True
        self._server = server
        self._socket = sock
        self._deaf = False  # nobody reads at the other end any more
        self._unsent: memoryview | None = None
        self._paused = False  # bytes are left unread in the session until it has been written
        self._mask = 0

    def __repr__(self) -> str:
        return f"<Connection of {self.peer}{'' if self.is_open else ', closed'}>"

    @property
    def unsent(self) -> int:
        """Bytes taken from the session and not yet taken by the socket."""
        return len(self._unsent) if self._unsent is not None else 0

    def flush(self) -> None:
        """Writes what the session has to say, as far as the socket takes it at once."""
        server = self._server
        if self.is_open:
            if self._paused:
                server._continue(self)
            else:
                server._write(self)
            server._ready.pop(self, None)
            server._held.pop(self, None)

    def publish_round(self, data: Sequence[Datum], time: float) -> None:
        """All data of a tick, as `Session.publish_round`, and writes it as `flush` does."""
        session = self.session
        if self._unsent is None and not self._deaf and self.is_open:
            piece = session.round_at_once(data, time)
            if piece is not None:
                self._server._give(self, piece)
                return
        session.publish_round(data, time)
        self.flush()

    def close(self) -> None:
        """Writes what the socket takes at once, and closes. No Disconnected event follows."""
        if self.is_open:
            self._server._write(self)
        if self.is_open:
            self._server._drop(self)


class Server:
    """All connections of one process, behind one selector.

    A loop of its owner: `poll`, handle the events, `flush`. Events of one connection come in the
    order of its bytes; after Disconnected there are none.
    """

    def __init__(self, *, max_connections: int = MAX_CONNECTIONS) -> None:
        self.selector = selectors.DefaultSelector()
        self.connections: set[Connection] = set()
        self.max_connections = max_connections
        self._listeners: dict[socket.socket, Directory] = {}
        self._asleep: list[socket.socket] = []
        self._accepted = 0
        self._ready: dict[Connection, None] = {}
        self._held: dict[Connection, None] = {}  # what they are to be told can wait for more
        self._held_until = 0.0
        self._events: list[tuple[Connection, ServerEvent]] = []
        self._watched: dict[Any, Callable[[], None]] = {}

    def listen(self, host: str, port: int, directory: Directory) -> tuple[str, int]:
        """Serves `directory` over TCP; port 0 takes a free one. Returns the address bound.

        The directory is told its host and port. Raises OSError where the address cannot be had.
        """
        family, _, _, _, address = socket.getaddrinfo(
            host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
        listener = socket.socket(family, socket.SOCK_STREAM)
        try:
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listener.setblocking(False)
            listener.bind(address)
            listener.listen(LISTEN_BACKLOG)
        except OSError as error:
            listener.close()
            raise OSError(
                error.errno, f"cannot listen on {host}:{port}: {error.strerror}"
            ) from None
        bound: tuple[str, int] = listener.getsockname()[:2]
        directory.place(*bound)
        self._listeners[listener] = directory
        self.selector.register(listener, selectors.EVENT_READ, listener)
        return bound

    def adopt(
        self, sock: socket.socket, directory: Directory, *, patient: bool = True, peer: str = ""
    ) -> Connection:
        """Serves `directory` on one end of a socket pair; `peer` names the client in messages.

        The socket belongs to the server from now on. The banner goes out with the next `flush`
        or `poll`.
        """
        connection = self._add(sock, directory, patient, peer or "a socket pair", 0)
        return connection

    def watch(self, fileobj: Any, callback: Callable[[], None]) -> None:
        """Calls `callback()` within `poll` whenever `fileobj` can be read."""
        self.selector.register(fileobj, selectors.EVENT_READ, callback)
        self._watched[fileobj] = callback

    def unwatch(self, fileobj: Any) -> None:
        """Ends what `watch` began; KeyError if it did not."""
        del self._watched[fileobj]
        self.selector.unregister(fileobj)

    def poll(self, timeout: float | None) -> list[tuple[Connection, ServerEvent]]:
        """What clients have sent. Waits at most `timeout` seconds for it (None: as long as needed).

        Returns early, perhaps with nothing, when a watched file or a socket's state has changed.
        What sessions have to say is written first, so that nobody waits for an answer meanwhile.
        """
        if self._ready:
            self._write_ready()
        if self._events:
            timeout = 0.0
        elif self._held:
            left = self._held_until - monotonic()
            if left <= 0.0:
                self.flush()
            else:
                timeout = left if timeout is None else min(timeout, left)
        for key, mask in self.selector.select(timeout):
            owner = key.data
            if type(owner) is Connection:
                if mask & selectors.EVENT_WRITE and owner.is_open:
                    self._continue(owner)
                if mask & selectors.EVENT_READ and owner.is_open:
                    self._read(owner)
            elif isinstance(owner, socket.socket):
                self._accept(owner)
            else:
                owner()
        events = self._events
        self._events = []
        return events

    def flush(self) -> None:
        """Writes what all sessions have to say, as far as their sockets take it.

        The rest goes out in later polls, before anything that the session says meanwhile.
        """
        self._ready |= self._held
        self._held.clear()
        self._write_ready()

    def close(self) -> None:
        """Closes all connections and listeners."""
        for connection in list(self.connections):
            connection.close()
        for listener in self._listeners:
            listener.close()
        self._listeners.clear()
        self._asleep.clear()
        self.selector.close()

    def __enter__(self) -> Server:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _write_ready(self) -> None:
        while self._ready:
            ready = self._ready
            self._ready = {}
            for connection in ready:
                self._held.pop(connection, None)
                if connection.is_open:
                    self._continue(connection)

    def _hold(self, connection: Connection) -> None:
        """What a session has to say may wait for what it says next, but not for long."""
        if not self._held:
            self._held_until = monotonic() + HELD_FOR
        self._held[connection] = None

    # -- sockets ----------------------------------------------------------------------------

    def _add(
        self, sock: socket.socket, directory: Directory, patient: bool, peer: str, port: int
    ) -> Connection:
        sock.setblocking(False)
        session = Session(directory, patient=patient)
        connection = Connection(self, sock, session, peer, port)
        session.on_output(
            lambda: self._ready.__setitem__(connection, None), lambda: self._hold(connection)
        )
        self._ready[connection] = None
        self.connections.add(connection)
        self._select(connection, selectors.EVENT_READ)
        return connection

    def _select(self, connection: Connection, mask: int) -> None:
        if mask == connection._mask:
            return
        if not connection._mask:
            self.selector.register(connection._socket, mask, connection)
        elif not mask:
            self.selector.unregister(connection._socket)
        else:
            self.selector.modify(connection._socket, mask, connection)
        connection._mask = mask

    def _accept(self, listener: socket.socket) -> None:
        try:
            sock, address = listener.accept()
        except OSError as error:
            if error.errno in (errno.EMFILE, errno.ENFILE, errno.ENOBUFS, errno.ENOMEM):
                # No room for another: stop asking until a connection ends.
                self.selector.unregister(listener)
                self._asleep.append(listener)
            return
        if self._accepted >= self.max_connections:
            sock.close()
            return
        self._accepted += 1
        hurry(sock)
        peer = f"{address[0]}:{address[1]}"
        directory = self._listeners[listener]
        connection = self._add(sock, directory, False, peer, directory.port)
        self._events.append((connection, Connected(peer)))
        self._write(connection)  # the banner at once, in one write

    def _read(self, connection: Connection) -> None:
        """Takes what has come. Of a client over TCP, what comes for an acknowledgement as well.

        Who writes a command and then a request, with Nagle's algorithm on as in Player's own
        library, has the request wait until the command is acknowledged.
        """
        session = connection.session
        if not self._receive(connection) or not connection.port or session.waiting:
            return  # what is said to a client acknowledges what came
        quick_acknowledge(connection._socket)
        if session.mode is _PULL:
            self._receive(connection)

    def _receive(self, connection: Connection) -> bool:
        """Takes bytes that have come; False if there are none, or will be none any more."""
        try:
            data = connection._socket.recv(RECEIVE_SIZE)
        except (BlockingIOError, InterruptedError):
            return False
        except OSError as error:
            self._lose(connection, f"the connection broke: {error.strerror}")
            return False
        if not data:
            self._lose(connection, "the client closed the connection")
            return False
        self._take(connection, data)
        return connection.is_open

    def _take(self, connection: Connection, data: bytes) -> None:
        session = connection.session
        while True:
            events = session.receive(data)
            self._events += [(connection, event) for event in events]
            if session.broken:
                if events and type(events[-1]) is Malformed:
                    self._write(connection)
                    if connection.is_open:
                        self._lose(connection, f"not Player's protocol: {events[-1].reason}")
                return
            if not session.stalled:
                return
            self._write(connection)
            if not connection.is_open:
                return
            if session.stalled:
                connection._paused = True
                return
            data = b""

    def _continue(self, connection: Connection) -> None:
        """Writes; then takes what the client had sent before and was left unread."""
        self._write(connection)
        if connection._paused and connection.is_open and not connection.session.stalled:
            connection._paused = False
            self._take(connection, b"")

    def _write(self, connection: Connection) -> None:
        session = connection.session
        unsent: bytes | memoryview | None = connection._unsent
        connection._unsent = None
        while not connection._deaf:
            data = session.outgoing() if unsent is None else unsent
            if not data:
                break
            try:
                sent = connection._socket.send(data)
            except (BlockingIOError, InterruptedError):
                sent = 0
            except OSError:
                # It has closed; what it said before that is still to be read, up to its end.
                connection._deaf = True
                break
            if sent < len(data):
                connection._unsent = memoryview(data)[sent:]
                # A client that asks and does not read is not read from until it does.
                wanted = 0 if session.stalled else selectors.EVENT_READ
                self._select(connection, wanted | selectors.EVENT_WRITE)
                return
            if unsent is None:
                break  # all that the session had
            unsent = None
        if connection._deaf:
            session.outgoing()
        if connection._mask != selectors.EVENT_READ:
            self._select(connection, selectors.EVENT_READ)

    def _give(self, connection: Connection, piece: bytes) -> None:
        """Writes a piece that nothing is before."""
        self._ready.pop(connection, None)
        self._held.pop(connection, None)
        try:
            sent = connection._socket.send(piece)
        except OSError:
            sent = 0  # whatever it is: the plain way finds it again
        if sent < len(piece):
            connection._unsent = memoryview(piece)[sent:]
            self._continue(connection)

    def _lose(self, connection: Connection, reason: str) -> None:
        self._drop(connection)
        self._events.append((connection, Disconnected(reason)))

    def _drop(self, connection: Connection) -> None:
        connection.is_open = False
        connection.session.close()
        self._select(connection, 0)
        self.connections.discard(connection)
        self._ready.pop(connection, None)
        self._held.pop(connection, None)
        with contextlib.suppress(OSError):
            connection._socket.close()
        if connection.port:
            self._accepted -= 1
        for listener in self._asleep:
            self.selector.register(listener, selectors.EVENT_READ, listener)
        self._asleep.clear()
