"""What a client is told, in its order: data when it has asked for it, and replies. No sockets.

What is to be written comes out of `outgoing`. Rules of the queue after Player's TCP server:

- In push mode data goes out as it is published.
- In pull mode data waits until the client asks (REQ DATA), or until a reply is made: data queued
  before a reply goes out before it. Once the client has asked and a round holds data, all of it
  goes out, and a SYNCH ends it.
- A replace rule lets newer data take the place of older data of its kind in the queue.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from player import messages
from player.codes import (
    QUEUE_LIMIT,
    DataMode,
    DeviceAddr,
    Interface,
    MessageType,
    PlayerRequest,
    Synch,
)
from player.directory import Datum, Directory
from player.errors import XdrError
from player.events import DataRequested, Request
from player.header import HEADER, HEADER_SIZE, TIME, Message
from player.outbox import Outbox
from player.xdr import Values

BACKLOG_LIMIT = 1 << 20
"""Bytes of replies that may wait to be written before no further request is looked at."""

_PLAYER, _DATA, _CMD, _REQ, _ACK, _SYNCH, _NACK = (int(Interface.PLAYER), *map(int, MessageType))
_PULL = DataMode.PULL
_SERVED, _UNSERVED = DataRequested(served=True), DataRequested(served=False)
ROUND_END = HEADER.pack(0, 0, _PLAYER, 0, _SYNCH, Synch.OK, 0.0, 0, 0)
"""What ends a round in which nothing is missing."""


class Telling:
    """The half of a client's session that speaks.

    `patient`: the answer to REQ DATA is held back until data goes out with it, in one write. Not
    for clients of Player's own library, whose requests time out after five seconds.
    """

    def __init__(
        self, directory: Directory, *, patient: bool = False, limit: int = QUEUE_LIMIT
    ) -> None:
        self.directory = directory
        self.patient = patient
        self.mode = DataMode.PUSH
        self.subscribed: dict[DeviceAddr, int] = {}
        """Subscribed devices, and how often each."""
        self.waiting = False
        """The client has asked for data and not been served yet."""
        self.closed = False
        """`close` has been called."""
        self._outbox = Outbox(limit)
        self._open_round = False
        self._held_ack = False
        self._pending: dict[int, Request] = {}

    @property
    def backlog(self) -> int:
        """Bytes that `outgoing` would give now."""
        return self._outbox.backlog

    @property
    def dropped(self) -> int:
        """Messages lost to a full queue since the last SYNCH."""
        return self._outbox.dropped

    @property
    def stalled(self) -> bool:
        """True if received bytes are left unread until the backlog has been written."""
        return self._outbox.backlog > BACKLOG_LIMIT

    # -- replies ----------------------------------------------------------------------------

    def acknowledge(
        self, request: Request, message: Values | None = None, time: float | None = None
    ) -> None:
        """Answers a request with an ACK that carries `message` (None: nothing).

        `time` is simulated, in seconds; the directory's if left out. Raises KeyError if the
        request has been answered already, XdrError if `message` is not the reply's layout (the
        request is refused then, so that its client does not wait).
        """
        payload = b""
        if message is not None:
            spec = messages.find(request.addr.interf, _ACK, request.subtype)
            try:
                if spec is None:
                    raise XdrError(f"{request.addr}: no reply of subtype {request.subtype}")
                payload = spec.encode(message)
            except XdrError:
                self.refuse(request, time=time)
                raise
        self._answer(request, _ACK, payload, time)

    def refuse(self, request: Request, time: float | None = None) -> None:
        """Answers a request with a NACK; KeyError if it has been answered already."""
        self._answer(request, _NACK, b"", time)

    def _answer(self, request: Request, type_: int, payload: bytes, time: float | None) -> None:
        del self._pending[request.number]
        directory = self.directory
        header = HEADER.pack(
            directory.wire_host,
            directory.port,
            *request.addr,
            type_,
            request.subtype,
            directory.time if time is None else time,
            request.seq,
            len(payload),
        )
        self._outbox.release()
        self._outbox.say(header + payload)

    @property
    def pending(self) -> list[Request]:
        """Requests that have not been answered, oldest first."""
        return list(self._pending.values())

    def _reply(self, message: Message, type_: int, payload: bytes = b"") -> None:
        self._outbox.release()
        self._outbox.say(self._header(message, type_, len(payload)) + payload)

    def _header(self, message: Message, type_: int, size: int = 0) -> bytes:
        directory = self.directory
        return HEADER.pack(
            directory.wire_host,
            directory.port,
            message.interf,
            message.index,
            type_,
            message.subtype,
            directory.time,
            message.seq,
            size,
        )

    # -- data -------------------------------------------------------------------------------

    def _asked(self, seq: int) -> DataRequested | None:
        """The client asks for data; None if it is sent all there is anyway."""
        outbox = self._outbox
        if self.mode is not _PULL:
            outbox.say(self._data_ack(seq))
            return None
        if self._held_ack:
            self._release_ack()  # asked twice: each request has its one answer
        self.waiting = True
        if self.patient:
            self._held_ack = True
        else:
            outbox.say_later(self._data_ack(seq))
        if outbox.queued and not self._open_round:
            self._serve()
            return _SERVED
        return _UNSERVED

    def _data_ack(self, seq: int = 0) -> bytes:
        directory = self.directory
        front = directory.front(_PLAYER, 0, _ACK, PlayerRequest.DATA)
        return front + TIME.pack(directory.time) + (seq << 32).to_bytes(8)

    def publish(self, addr: DeviceAddr, subtype: int, payload: bytes, time: float) -> None:
        """Queues data of a device, already encoded, if the client has subscribed it.

        It goes out at `end_of_round`, after all of its round. When `limit` messages wait
        unread, further ones are dropped and the next SYNCH says so.
        """
        if addr not in self.subscribed or self.closed:
            return
        interf, index = addr
        front = self.directory.front(interf, index, _DATA, subtype)
        message = front + TIME.pack(time) + len(payload).to_bytes(8) + payload
        self._open_round = True
        self._outbox.queue((interf, index, subtype), message)

    def publish_round(self, data: Sequence[Datum], time: float) -> None:
        """All data of a tick at once: as `publish` for each, then `end_of_round`.

        Of each device and subtype there is one at the most.
        """
        for addr, subtype, payload in data:
            self.publish(addr, subtype, payload, time)
        self.end_of_round()

    def round_ready(self, piece: memoryview, messages: int) -> bytes | memoryview | None:
        """What to write, before anything else, of a round that is encoded already.

        From its acknowledgement to its end, so many messages of data. Only if that is all the
        client waits for; None otherwise: nothing has changed then.
        """
        outbox = self._outbox
        if not self.waiting or self._open_round or not outbox.idle or messages > outbox.limit:
            return None
        self.waiting = False
        before = outbox.take()
        if self._held_ack:
            self._held_ack = False
            return before + piece if before else piece
        return before + piece[HEADER_SIZE:]

    def keep_newest(self) -> None:
        """Data that waits is no more than the newest of each kind, unless the client has rules."""
        self._outbox.keep_newest()

    def end_of_round(self) -> None:
        """All data of a tick has been published: it goes out if the client has asked for it."""
        self._open_round = False
        if not self._outbox.queued:
            return
        if self.waiting:
            self._serve()
        elif self.mode is DataMode.PUSH:
            self._outbox.wake()

    def _serve(self) -> None:
        """The queue goes out, then a SYNCH; the client is not waiting any more."""
        if self._held_ack:
            self._release_ack()
        self._outbox.release()
        dropped = self._outbox.dropped
        if dropped:
            payload = messages.encode(_PLAYER, _SYNCH, 2, dropped=min(dropped, 0xFFFFFFFF))
            header = HEADER.pack(0, 0, _PLAYER, 0, _SYNCH, Synch.OVERFLOW, 0.0, 0, len(payload))
            self._outbox.say(header + payload)
            self._outbox.dropped = 0
        else:
            self._outbox.say(ROUND_END)
        self.waiting = False

    def _release_ack(self) -> None:
        self._held_ack = False
        self._outbox.say(self._data_ack())

    def on_output(
        self, notify: Callable[[], None], notify_later: Callable[[], None] | None = None
    ) -> None:
        """Calls `notify` from now on whenever `outgoing` starts to have something to say.

        `notify_later` in its place where that is only that a request for data has been heard: it
        may well travel with the data, but not wait for them as long as clients wait for answers.
        """
        self._outbox.notify = notify
        self._outbox.notify_later = notify_later or notify

    def outgoing(self) -> bytes:
        """Takes the bytes that are to be written now; b"" if there are none.

        To be called when they can be written: in push mode data waits in the bounded queue
        until then.
        """
        if self.mode is DataMode.PUSH and not self._open_round:
            self._outbox.release()
        return self._outbox.take()

    def close(self) -> None:
        """The client is gone: nothing is kept for it any more; `subscribed` stays to be read."""
        self.closed = True
        self.waiting = False
        self._outbox.close()
