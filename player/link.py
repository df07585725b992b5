"""The client's end of a connection: whole messages in, bytes out, deadlines, and how it ends."""

from __future__ import annotations

import math
import select
import socket
import struct
from collections.abc import Callable
from time import monotonic
from typing import NoReturn

from player.codes import BANNER_SIZE
from player.environment import Place, release
from player.errors import PlayerDisconnected, PlayerTimeout, ProtocolError
from player.header import Message, MessageReader
from player.printable import printable
from player.transport import hurry, quick_acknowledge

RECEIVE_SIZE = 1 << 14
"""Bytes taken from the socket at a time: a round with a scan and blobs is about 1500."""

FLUSH_SIZE = 1 << 16
"""Bytes in the queue from which on it is to be sent."""

LONGEST = 1e6
"""Seconds; the system keeps no longer limits of time than some weeks: what is longer is none."""

LEAST_WAIT = 1e-3
"""Seconds; a socket timeout of zero would mean not to wait at all."""


def limit_of(seconds: float | None) -> float | None:
    """A limit of time that can be kept; None: for ever."""
    return None if seconds is None or seconds > LONGEST else seconds


class Deadline:
    """Until when an answer is waited for, in wall-clock time; None seconds: for ever.

    `what` says, for the error, which answer it is. When the time is over, what has arrived by then
    is taken once more: a process that was held up itself still finds its answer, and one that is
    sent something else all the time does not wait for ever.
    """

    __slots__ = ("limit", "over", "until", "what")

    def __init__(self, limit: float | None, what: Callable[[], str]) -> None:
        self.limit = limit = limit_of(limit)
        self.until = None if limit is None else monotonic() + limit
        self.over = False
        self.what = what


FOR_EVER = Deadline(None, lambda: "anything")


class Link:
    """A socket to a Player server, whose banner has been read.

    Raises PlayerDisconnected where nobody listens, PlayerTimeout where nobody answers within
    `timeout` seconds (None: wait for ever), ProtocolError where it is not Player that does.
    """

    def __init__(self, place: Place, timeout: float | None) -> None:
        self.ending = ""
        """Why the connection is over; "" while it is not."""
        self.clean = False
        """True if it is over because the server closed it between two messages."""
        self._queue: list[bytes] = []
        self._queued = 0
        self._reader = MessageReader()
        self._tcp = place.sock is None
        self._readable: select.poll | None = None  # of a socket pair
        self._waits: float | None = None
        self._limit: float | None = None  # what the system keeps
        self._wait: int | None = None  # the same in milliseconds
        if place.sock is not None:
            self.address = "the inherited socket"
            self._socket = place.sock
        else:
            self.address = f"{place.host}:{place.port}"
            self._socket = self._connect(place.host, place.port, timeout)
        self._socket.settimeout(None)
        try:
            self.banner = self._receive_banner(Deadline(timeout, lambda: "the banner"))
        except BaseException:
            self.close()
            raise

    def _connect(self, host: str, port: int, timeout: float | None) -> socket.socket:
        try:
            sock = socket.create_connection((host, port), timeout=limit_of(timeout))
        except TimeoutError:
            raise PlayerTimeout(
                f"{self.address} did not take the connection within {timeout} s"
            ) from None
        except OSError as error:
            raise PlayerDisconnected(
                f"cannot connect to a Player server at {self.address}: {error.strerror or error} "
                "(is it running, and is this its port?)"
            ) from None
        except (ValueError, OverflowError) as error:  # a name or a port that cannot be one
            raise PlayerDisconnected(f"{self.address} is no address: {error}") from None
        hurry(sock)
        return sock

    def _receive_banner(self, deadline: Deadline) -> str:
        banner = b""
        while len(banner) < BANNER_SIZE:
            banner += self._receive(deadline, BANNER_SIZE - len(banner))
            if not b"Player".startswith(banner[:6]):
                raise ProtocolError(f"{self.address} is no Player server: it said {banner!r}")
        return printable(banner.split(b"\0")[0].decode("ascii", "backslashreplace"))

    def next(self, deadline: Deadline) -> Message:
        """The next message; PlayerTimeout, PlayerDisconnected, or ProtocolError if it is none."""
        while True:
            message = self._reader.take()
            if message is not None:
                return message
            self._reader.feed(self.receive(deadline))

    @property
    def buffered(self) -> int:
        """Bytes that have been received and not been given as messages yet."""
        return self._reader.buffered

    def receive(self, deadline: Deadline) -> bytes:
        """What comes next, in a piece as it comes; raises as `next` does."""
        return self._receive(deadline, RECEIVE_SIZE)

    def queue(self, message: bytes) -> bool:
        """What is sent next begins with what is in the queue; whether that is long by now."""
        self._queue.append(message)
        self._queued += len(message)
        return self._queued > FLUSH_SIZE

    def exchange(self, message: bytes, timeout: float | None, what: Callable[[], str]) -> bytes:
        """Sends a message behind the queue, and gives what comes next, in a piece as it comes.

        The system keeps the limit of time, so that it need not be asked before whether there is
        anything. Raises as `send` and `next` do; `what()` says for which answer it was too late.
        """
        if self._waits is not None:
            self._set_timeout(None)
        if timeout != self._limit:
            self._limit_time(limit_of(timeout))
        queue = self._queue
        queue.append(message)
        data = b"".join(queue)
        queue.clear()
        self._queued = 0
        sent = False
        try:
            self._socket.sendall(data)
            sent = True
            if self._tcp or (self._readable or self._watch()).poll(self._wait):
                got = self._socket.recv(RECEIVE_SIZE)
            else:
                raise BlockingIOError
        except BlockingIOError:
            if sent:
                self._give_up(Deadline(timeout, what))
            self._refuse(timeout)
        except (BrokenPipeError, ConnectionResetError):
            got = self._receive(FOR_EVER, RECEIVE_SIZE)  # its last words
        except OSError as error:
            self._break(error)
        if not got:
            self.end()
        return got

    def _limit_time(self, seconds: float | None) -> None:
        """Has the system keep a limit for whatever is sent or received without one of ours."""
        self._limit = seconds
        self._wait = None if seconds is None else math.ceil(max(seconds, LEAST_WAIT) * 1e3)
        limit = 0.0 if seconds is None else max(seconds, LEAST_WAIT)
        whole = int(limit)
        value = struct.pack("ll", whole, int((limit - whole) * 1e6))
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVTIMEO, value)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, value)

    def _watch(self) -> select.poll:
        """What waits for data at a socket pair, and for nothing else.

        Linux wakes whoever waits in recv also when the other end has read what was sent: to find
        nothing, and to wait again.
        """
        self._readable = select.poll()
        self._readable.register(self._socket, select.POLLIN)
        return self._readable

    def feed(self, data: bytes) -> None:
        """Has `next` begin with what has been received otherwise: the rest is still to come."""
        if self._tcp:
            quick_acknowledge(self._socket)
        self._reader.feed(data)

    def waiting(self) -> Message | None:
        """The next message if it has been received already."""
        return self._reader.take()

    def _receive(self, deadline: Deadline, size: int) -> bytes:
        waits: float | None = None
        if deadline.until is not None:
            waits = deadline.until - monotonic()
            if waits <= 0.0:
                if deadline.over:
                    self._give_up(deadline)
                deadline.over = True
                waits = LEAST_WAIT
        self._set_timeout(waits)
        try:
            data = self._socket.recv(size)
        except TimeoutError as error:
            if error.errno is not None:  # TCP's own: the network has lost the server
                self._break(error)
            self._give_up(deadline)
        except ConnectionResetError:
            data = b""  # it closed without having read all that was sent
        except OSError as error:
            self._break(error)
        if not data:
            self.end()
        if self._tcp:
            quick_acknowledge(self._socket)
        return data

    def _set_timeout(self, seconds: float | None) -> None:
        if self._limit is not None:
            self._limit_time(None)
        if seconds != self._waits:
            self._socket.settimeout(seconds)
            self._waits = seconds

    def _give_up(self, deadline: Deadline) -> NoReturn:
        raise PlayerTimeout(
            f"{self.address} did not answer within {deadline.limit:g} s ({deadline.what()})"
        ) from None

    def send_queued(self, timeout: float | None) -> bool:
        """Sends what is in the queue; False if the server has closed: see `send`."""
        if not self._queue:
            return True
        data = b"".join(self._queue)
        self._queue.clear()
        self._queued = 0
        return self.send(data, timeout)

    def send(self, data: bytes, timeout: float | None) -> bool:
        """Sends; False if the server has closed: what is received then is its last words.

        Raises PlayerTimeout where the server takes nothing for `timeout` seconds (None: wait for
        ever). The connection is over then: half of a message may have gone out.
        """
        limit = limit_of(timeout)
        self._set_timeout(None if limit is None else max(limit, LEAST_WAIT))
        try:
            self._socket.sendall(data)
        except (BrokenPipeError, ConnectionResetError):
            return False
        except TimeoutError as error:
            if error.errno is not None:
                self._break(error)
            self._refuse(timeout)
        except OSError as error:
            self._break(error)
        return True

    def _refuse(self, timeout: float | None) -> NoReturn:
        """Nothing more is to be sent: half of a message may have gone out."""
        self.ending = f"{self.address} took nothing of what was sent within {timeout or 0.0:g} s"
        raise PlayerTimeout(self.ending) from None

    def end(self) -> NoReturn:
        """Notes that the server has closed, and raises PlayerDisconnected that says so."""
        self.ending = f"{self.address} closed the connection"
        if left := self._reader.buffered:
            self.ending += f" in the middle of a message ({left} bytes of it came)"
        self.clean = not left
        raise PlayerDisconnected(self.ending)

    def _break(self, error: OSError) -> NoReturn:
        self.ending = f"the connection to {self.address} broke: {error.strerror or error}"
        raise PlayerDisconnected(self.ending) from None

    def close(self) -> None:
        """Closes the socket."""
        release(self._socket)
        self._socket.close()
