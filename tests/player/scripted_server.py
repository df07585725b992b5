"""Servers for tests of the client: one that follows a script, and one that serves stub devices."""

import socket
import threading
from contextlib import contextmanager

from wire_talk import (
    ACK,
    BANNER,
    DATA,
    DATAMODE,
    DEV,
    DEVLIST,
    GET_DATA,
    HEADER,
    NACK,
    PLAYER,
    REQ,
    RULE,
    SYNCH,
    Heard,
    say,
)

from tests.patience import PATIENCE


class Talk:
    """The server's end of a connection, driven by a script."""

    def __init__(self, sock):
        self.sock = sock
        sock.settimeout(PATIENCE)

    def exactly(self, size):
        data = b""
        while len(data) < size:
            got = self.sock.recv(size - len(data))
            if not got:
                raise EOFError
            data += got
        return data

    def hear(self):
        _, _, interf, index, type_, subtype, time, seq, size = HEADER.unpack(self.exactly(40))
        return Heard(interf, index, type_, subtype, time, seq, self.exactly(size))

    def expect(self, interf, type_, subtype):
        message = self.hear()
        assert (message.interf, message.type, message.subtype) == (interf, type_, subtype), message
        return message

    def say(self, *args, **kwargs):
        self.sock.sendall(say(*args, **kwargs))

    def reply(self, message, payload=b"", type_=ACK, time=0.0):
        self.say(message.interf, message.index, type_, message.subtype, payload, time)

    def accept(self, interf, subtype, payload=b""):
        """Expects a request and acknowledges it."""
        message = self.expect(interf, REQ, subtype)
        self.reply(message, payload)
        return message

    def greet(self):
        """Banner, data mode, replace rule: how a pull client begins."""
        self.sock.sendall(BANNER)
        assert self.accept(PLAYER, DATAMODE).payload == b"\0\0\0\2"
        self.accept(PLAYER, RULE)

    def subscribe(self):
        """Expects a subscription and grants it, from a driver named `stub`."""
        message = self.expect(PLAYER, REQ, DEV)
        self.reply(message, message.payload[:20] + b"\0\0\0\5\0\0\0\5stub\0\0\0\0")
        return message

    def list_devices(self, *devices):
        rows = b"".join(b"".join(n.to_bytes(4) for n in (0, 0, *device)) for device in devices)
        count = len(devices).to_bytes(4)
        self.accept(PLAYER, DEVLIST, count + count + rows)

    def round(self, *data, time=1.0):
        """Expects REQ DATA; sends data given as (interf, subtype, payload), and SYNCH."""
        message = self.expect(PLAYER, REQ, GET_DATA)
        self.reply(message, time=time)
        for interf, subtype, payload in data:
            self.say(interf, 0, DATA, subtype, payload, time)
        self.say(PLAYER, 0, SYNCH, 1, time=1e300)  # a real server's time here is garbage

    def whole_round(self, *data, time=1.0):
        """As `round`, in one write and with one time: as our server sends it."""
        self.expect(PLAYER, REQ, GET_DATA)
        said = say(PLAYER, 0, ACK, GET_DATA, time=time)
        for interf, subtype, payload in data:
            said += say(interf, 0, DATA, subtype, payload, time)
        self.sock.sendall(said + say(PLAYER, 0, SYNCH, 1))

    def refuse(self, interf, subtype):
        message = self.expect(interf, REQ, subtype)
        self.reply(message, type_=NACK)
        return message


def _run(script, talk, failures):
    try:
        script(talk)
    except (BrokenPipeError, ConnectionResetError):
        pass  # the client has heard enough; it is the test that says whether rightly so
    except BaseException as error:
        failures.append(error)
    finally:
        talk.sock.close()


@contextmanager
def scripted(script):
    """The client's end of a socket pair at whose other end `script(talk)` runs, in a thread."""
    ours, theirs = socket.socketpair()
    failures = []
    thread = threading.Thread(target=_run, args=(script, Talk(ours), failures))
    thread.start()
    try:
        yield theirs
    finally:
        theirs.close()
        thread.join(PATIENCE)
    assert not thread.is_alive()
    for failure in failures:
        raise failure


@contextmanager
def scripted_port(script):
    """As `scripted`, over TCP: gives host and port."""
    listener = socket.create_server(("127.0.0.1", 0))
    listener.settimeout(PATIENCE)
    failures = []

    def serve():
        _run(script, Talk(listener.accept()[0]), failures)

    thread = threading.Thread(target=serve)
    thread.start()
    try:
        yield listener.getsockname()
    finally:
        thread.join(PATIENCE)
        listener.close()
    assert not thread.is_alive()
    for failure in failures:
        raise failure
