"""One client's session on a server: its subscriptions, its queue, its data mode. No sockets.

Bytes go in with `receive`, which gives events; what is to be written comes out of `outgoing`.
Requests to the server itself (interface `player`) are answered here, and so is whatever is not in
the protocol. What is said to the client, and when, is in `player.telling`.
"""

from __future__ import annotations

from player import messages
from player.codes import (
    QUEUE_LIMIT,
    Access,
    DataMode,
    DeviceAddr,
    Interface,
    MessageType,
    PlayerRequest,
)
from player.directory import Directory
from player.errors import ProtocolError, XdrError
from player.events import (
    Command,
    DataRequested,
    Event,
    Ignored,
    Malformed,
    ModeChanged,
    Request,
    Subscribed,
    Unsubscribed,
)
from player.header import MAX_REQUEST, Message, MessageReader
from player.telling import BACKLOG_LIMIT, Telling
from player.usual_commands import UsualCommands
from player.xdr import Values

__all__ = [
    "BACKLOG_LIMIT",
    "MAX_REQUEST",
    "Command",
    "DataRequested",
    "Event",
    "Ignored",
    "Malformed",
    "ModeChanged",
    "Request",
    "Session",
    "Subscribed",
    "Unsubscribed",
]

_PLAYER = int(Interface.PLAYER)
_, _CMD, _REQ, _ACK, _, _NACK = map(int, MessageType)

_ASKED_OF_US = frozenset((_CMD, _REQ))


class Session(Telling):
    """The state of one client's connection.

    `patient`: the answer to REQ DATA is held back until data goes out with it, in one write. Not
    for clients of Player's own library, whose requests time out after five seconds.
    """

    def __init__(
        self,
        directory: Directory,
        *,
        patient: bool = False,
        limit: int = QUEUE_LIMIT,
        max_request: int = MAX_REQUEST,
    ) -> None:
        super().__init__(directory, patient=patient, limit=limit)
        self.broken = False
        """Malformed bytes have come: nothing is read any more."""
        self._reader = MessageReader(max_request)
        self._requests = 0
        self._usual = UsualCommands(directory, max_request)

    def receive(self, data: bytes) -> list[Event]:
        """Takes bytes from the client, in pieces of any size, and gives what they mean, in order.

        Stops early while `backlog` is above its limit (the client asks and does not read);
        `receive(b"")` goes on from there.
        """
        events: list[Event] = []
        if self.broken:
            return events
        if not self._reader.left and self._outbox.backlog <= BACKLOG_LIMIT:
            usual = self._usual.hear(data, events)
            if usual is not None:
                if usual.asks and (asked := self._asked(usual.seq)):
                    events.append(asked)
                return events
        if data:
            self._reader.feed(data)
        try:
            while self._outbox.backlog <= BACKLOG_LIMIT:
                message = self._reader.take()
                if message is None:
                    break
                self._handle(message, events)
        except ProtocolError as error:
            self.broken = True
            events.append(Malformed(str(error)))
        return events

    def _handle(self, message: Message, events: list[Event]) -> None:
        interf, index, type_, subtype = message[2:6]
        if type_ not in _ASKED_OF_US:
            if interf == _PLAYER:
                self._reply(message, _NACK)
            else:
                events.append(Ignored(f"a client sent a message of type {type_}"))
            return
        if interf == _PLAYER:
            self._handle_player(message, events)
            return
        addr = DeviceAddr(interf, index)
        spec = messages.find(interf, type_, subtype)
        reason = None
        if addr not in self.directory:
            reason = f"there is no device {addr}"
        elif spec is None:
            reason = f"{addr}: no {MessageType(type_).name} of subtype {subtype} is known"
        else:
            try:
                values = spec.decode(message.payload) if spec.fields else {}
            except XdrError as error:
                reason = str(error)
        if reason is not None or spec is None:
            if type_ == _REQ:
                self._reply(message, _NACK)
            events.append(Ignored(reason or ""))
        elif type_ == _CMD:
            events.append(Command(addr, subtype, values, spec.name))
        else:
            self._requests += 1
            request = Request(addr, subtype, values, spec.name, self._requests, message.seq)
            self._pending[self._requests] = request
            events.append(request)

    def _handle_player(self, message: Message, events: list[Event]) -> None:
        subtype = message.subtype
        spec = messages.find(_PLAYER, _REQ, subtype)
        if message.type != _REQ or message.index != 0 or spec is None:
            self._reply(message, _NACK)
            return
        if subtype == PlayerRequest.DATA:
            if asked := self._asked(message.seq):
                events.append(asked)
            return
        try:
            values = spec.decode(message.payload) if spec.fields else {}
        except XdrError as error:
            self._reply(message, _NACK)
            events.append(Ignored(str(error)))
            return
        if subtype == PlayerRequest.DEVLIST:
            self._reply(message, _ACK, self.directory.listing())
        elif subtype == PlayerRequest.DRIVERINFO:
            self._driver_info(message, values)
        elif subtype == PlayerRequest.DEV:
            self._subscription(message, values, events)
        elif subtype == PlayerRequest.DATAMODE:
            self._change_mode(message, values["mode"], events)
        elif subtype == PlayerRequest.ADD_REPLACE_RULE:
            accepted = self._outbox.add_rule(values)
            self._reply(message, _ACK if accepted else _NACK)
        else:
            self._reply(message, _NACK)  # authentication and names: Player has neither

    def _driver_info(self, message: Message, values: Values) -> None:
        addr = DeviceAddr(*values["addr"][2:])
        if addr not in self.directory:
            self._reply(message, _NACK)
            return
        payload = messages.encode(
            _PLAYER, _ACK, 2, addr=self._wire(addr), driver=self.directory.driver(addr)
        )
        self._reply(message, _ACK, payload)

    def _subscription(self, message: Message, values: Values, events: list[Event]) -> None:
        addr = DeviceAddr(*values["addr"][2:])
        access = values["access"]
        count = self.subscribed.get(addr, 0)
        type_ = _ACK
        event: Event | None = None
        if access == Access.OPEN and addr in self.directory:
            self.subscribed[addr] = count + 1
            event = None if count else Subscribed(addr)
        elif access == Access.OPEN:
            type_, access = _NACK, Access.ERROR
        elif access == Access.CLOSE and count > 1:
            self.subscribed[addr] = count - 1
        elif access == Access.CLOSE and count:
            del self.subscribed[addr]
            event = Unsubscribed(addr)
        else:
            access = Access.ERROR
        payload = messages.encode(
            _PLAYER,
            type_,
            3,
            addr=self._wire(addr),
            access=access,
            driver=self.directory.driver(addr),
        )
        self._reply(message, type_, payload)
        if event is not None:
            events.append(event)

    def _wire(self, addr: DeviceAddr) -> tuple[int, int, int, int]:
        return (self.directory.wire_host, self.directory.port, *addr)

    def _change_mode(self, message: Message, mode: int, events: list[Event]) -> None:
        self._reply(message, _ACK)  # whatever the mode, as Player does
        if mode not in (DataMode.PUSH, DataMode.PULL) or mode == self.mode:
            return
        self.mode = DataMode(mode)
        if self.mode is DataMode.PUSH:
            if self._held_ack:
                self._release_ack()
            self.waiting = False
            self._outbox.release()
        events.append(ModeChanged(self.mode))

    def close(self) -> None:
        """The client is gone: nothing is kept for it any more; `subscribed` stays to be read."""
        self.broken = True
        super().close()
