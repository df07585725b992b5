"""The device server's sockets: listens, adopts socket pairs, moves bytes to and from sessions.

One thread, nothing blocks but `poll`, and nothing that is decided here depends on a clock.
"""

from __future__ import annotations

import errno
import os
import selectors
import socket
from collections.abc import Callable
from typing import Any

from player.connection import (
    HELD_FOR,
    Connected,
    Connection,
    Desk,
    Disconnected,
    ServerEvent,
)
from player.directory import Directory
from player.session import Session
from player.transport import hurry

__all__ = ["HELD_FOR", "Connected", "Connection", "Disconnected", "Server", "ServerEvent"]

MAX_CONNECTIONS = 512
"""Connections accepted over TCP at a time; further ones are closed at once."""

LISTEN_BACKLOG = 128


class Server:
    """All connections of one process, behind one selector.

    A loop of its owner: `poll`, handle the events, `flush`. Events of one connection come in the
    order of its bytes; after Disconnected there are none.
    """

    def __init__(self, *, max_connections: int = MAX_CONNECTIONS) -> None:
        self._desk = desk = Desk()
        self.selector = desk.selector
        self.connections = desk.connections
        self.max_connections = max_connections
        self._listeners: dict[socket.socket, Directory] = {}
        self._asleep: list[socket.socket] = []
        self._accepted = 0
        self._watched: dict[Any, Callable[[], None]] = {}

    def listen(self, host: str, port: int, directory: Directory) -> tuple[str, int]:
        """Serves `directory` over TCP; port 0 takes a free one. Returns the address bound.

        The directory is told its host and port. Raises OSError where the address cannot be had.
        """
        try:
            family, _, _, _, address = socket.getaddrinfo(
                host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
            )[0]
        except OSError as error:
            raise cannot_listen(host, port, error) from None
        listener = socket.socket(family, socket.SOCK_STREAM)
        try:
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listener.setblocking(False)
            listener.bind(address)
            listener.listen(LISTEN_BACKLOG)
        except OSError as error:
            listener.close()
            raise cannot_listen(host, port, error) from None
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
        return self._add(sock, directory, patient, peer or "a socket pair", 0)

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
        desk = self._desk
        if desk.ready:
            desk.write_ready()
        if desk.events:
            timeout = 0.0
        elif desk.held:
            left = desk.held_for
            if left <= 0.0:
                self.flush()
            else:
                timeout = left if timeout is None else min(timeout, left)
        for key, mask in self.selector.select(timeout):
            owner = key.data
            if type(owner) is Connection:
                if mask & selectors.EVENT_WRITE and owner.is_open:
                    owner.proceed()
                if mask & selectors.EVENT_READ and owner.is_open:
                    owner.read()
            elif isinstance(owner, socket.socket):
                self._accept(owner)
            else:
                owner()
        events = desk.events
        desk.events = []
        return events

    def flush(self) -> None:
        """Writes what all sessions have to say, as far as their sockets take it.

        The rest goes out in later polls, before anything that the session says meanwhile.
        """
        desk = self._desk
        desk.ready |= desk.held
        desk.held.clear()
        desk.write_ready()

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

    def _add(
        self, sock: socket.socket, directory: Directory, patient: bool, peer: str, port: int
    ) -> Connection:
        sock.setblocking(False)
        session = Session(directory, patient=patient)
        return Connection(self._desk, sock, session, peer, port, self._forget)

    def _forget(self, connection: Connection) -> None:
        """A connection has ended: there is room for another."""
        if connection.port:
            self._accepted -= 1
        for listener in self._asleep:
            self.selector.register(listener, selectors.EVENT_READ, listener)
        self._asleep.clear()

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
        self._desk.events.append((connection, Connected(peer)))
        connection.write()  # the banner at once, in one write


def cannot_listen(host: str, port: int, error: OSError) -> OSError:
    """The error of an address that cannot be had, which tells the address.

    The number of the error of a name that nobody knows is no errno.
    """
    number, why = error.errno, error.strerror or str(error)
    if isinstance(error, socket.gaierror):
        number = None
    elif number:
        why = os.strerror(number)  # without the words of who called the system
    return OSError(number, f"cannot listen on {host}:{port}: {why}")
