"""A Player server on a thread of its own, with devices that send what a test gives them."""

from __future__ import annotations

import contextlib
import socket
import threading
from collections.abc import Iterator

from player import DeviceAddr
from player.directory import Directory
from player.server import Connection, Disconnected, Server
from player.session import Command, Request
from tests.patience import PATIENCE


class Stub:
    """The server's port, and the commands that have come."""

    def __init__(self) -> None:
        self.port = 0
        self.commands: list[Command] = []
        self.heard = threading.Condition()

    @property
    def name(self) -> str:
        return f"127.0.0.1:{self.port}"

    def wait_for(self, count: int, seconds: float = PATIENCE) -> list[Command]:
        """The commands, as soon as there are so many; fails the test if they do not come."""
        with self.heard:
            assert self.heard.wait_for(lambda: len(self.commands) >= count, seconds), self.commands
            return list(self.commands)


@contextlib.contextmanager
def stub_server(
    devices: dict[DeviceAddr, list[tuple[int, bytes]]],
    rounds: int = 1 << 30,
    driver: str = "stub_{index}",
) -> Iterator[Stub]:
    """Serve devices: each sends its messages (subtype, payload) in every round.

    After so many rounds with a subscriber the server closes the connections.
    """
    stub = Stub()
    stop, waker = socket.socketpair()
    directory = Directory({addr: driver.format(index=addr.index) for addr in devices})

    def serve() -> None:
        done = 0
        with Server() as server:
            _, stub.port = server.listen("127.0.0.1", 0, directory)
            ended: list[bool] = []
            server.watch(stop, lambda: ended.append(True))
            ready.set()
            clients: dict[Connection, None] = {}
            while not ended:
                for connection, event in server.poll(0.01):
                    clients[connection] = None
                    if isinstance(event, Disconnected):
                        clients.pop(connection)
                    elif isinstance(event, Request):
                        connection.session.refuse(event)
                    elif isinstance(event, Command):
                        with stub.heard:
                            stub.commands.append(event)
                            stub.heard.notify_all()
                readers = [one for one in clients if one.session.subscribed]
                done += bool(readers)
                for connection in list(readers):
                    if done > rounds:
                        clients.pop(connection)
                        connection.close()
                        continue
                    for addr, messages in devices.items():
                        for subtype, payload in messages:
                            connection.session.publish(addr, subtype, payload, 0.1 * done)
                    connection.session.end_of_round()
                server.flush()

    ready = threading.Event()
    thread = threading.Thread(target=serve)
    thread.start()
    assert ready.wait(PATIENCE)
    try:
        yield stub
    finally:
        waker.close()
        thread.join(PATIENCE)
        stop.close()


@contextlib.contextmanager
def rude_server(greeting: bytes) -> Iterator[str]:
    """A server that says `greeting` to one client and is no Player server; its HOST:PORT."""
    listener = socket.create_server(("127.0.0.1", 0))

    def greet() -> None:
        with contextlib.suppress(OSError):
            client, _ = listener.accept()
            with client:
                client.sendall(greeting)
                client.recv(1)  # until the client has gone

    thread = threading.Thread(target=greet)
    thread.start()
    try:
        yield f"127.0.0.1:{listener.getsockname()[1]}"
    finally:
        listener.shutdown(socket.SHUT_RDWR)
        listener.close()
        thread.join(PATIENCE)
