"""A connection to a Player server, as a controller uses it: read, command, request."""

from __future__ import annotations

import contextlib
import os
import socket
from collections.abc import Mapping
from typing import TYPE_CHECKING, Literal, Self

import numpy as np

from player import messages
from player.backlog import Backlog
from player.codes import (
    ANY,
    DEFAULT_PORT,
    Access,
    DataMode,
    DeviceAddr,
    Interface,
    MessageType,
    PlayerRequest,
    Replace,
)
from player.environment import Place, find_place, find_timeout
from player.errors import PlayerDisconnected, PlayerRefused, ProtocolError
from player.familiar import Familiar
from player.header import Message, pack_message
from player.link import Deadline, Link
from player.printable import printable
from player.usual import read_round
from player.xdr import Values

if TYPE_CHECKING:
    from player.proxies.base import Proxy

DEFAULT_TIMEOUT = 5.0
"""Wall-clock seconds that a server over TCP has for an answer, as in Player's own client."""

FLUSH_SIZE = 1 << 16
_PLAYER = DeviceAddr(Interface.PLAYER, 0)
_DATA, _CMD, _REQ, _ACK, _SYNCH, _NACK = map(int, MessageType)
_REQUEST_DATA = pack_message(Interface.PLAYER, 0, _REQ, PlayerRequest.DATA)


def _data() -> str:
    return "data"


def _encode(interf: int, type_: int, subtype: int, message: Values) -> bytes:
    """The payload of what a client says: no robot can do anything with NaN, or with infinity."""
    spec = messages.known(interf, type_, subtype)
    payload = spec.encode(message)
    spec.check_finite(message)
    return payload


class PlayerClient:
    """One connection to a Player server. Proxies of devices are made on it.

    Where to connect: `host` and `port` if given; else what the environment says: PLAYER_FD (the
    number of an inherited socket), or PLAYER_HOST and PLAYER_PORT; else 127.0.0.1:6665.

    `timeout`: wall-clock seconds to wait for an answer, whatever else comes; None for ever. Left
    out it is PLAYER_TIMEOUT (0: for ever) or else 5 over TCP, and None over an inherited socket,
    whose other end is alive or closed.
    `read_timeout`: the same for data in `read`; None, the default, waits for ever.
    `mode`: "pull" (one `read` asks for and gets one round of data) or "push".
    `replace`: in pull mode, newer data takes the place of older data that has not been asked for.

    Raises PlayerDisconnected where nobody listens, PlayerTimeout where nobody answers,
    ProtocolError where it is not Player that does.
    """

    def __init__(
        self,
        host: str | None = None,
        port: int | None = None,
        *,
        sock: socket.socket | None = None,
        timeout: float | Literal["default"] | None = "default",
        read_timeout: float | None = None,
        mode: Literal["pull", "push"] = "pull",
        replace: bool = True,
        environ: Mapping[str, str] = os.environ,
    ) -> None:
        place = Place(sock=sock) if sock is not None else find_place(host, port, environ)
        self.name = environ.get("PLAYER_ROBOT", "")
        """The robot's name in the simulation, "" if unknown."""
        self.index = place.index
        """The device index that proxies take unless told another."""
        self.seed = place.seed
        """The seed of this robot in this run, from PLAYER_SEED; 0 if there is none."""
        self.time = 0.0
        """Simulated time of the last reading, seconds."""
        self.stray = 0
        """Replies that nobody was waiting for, dropped."""
        self.timeout: float | None
        if timeout == "default":
            is_local = place.sock is not None
            self.timeout = None if is_local else find_timeout(environ, DEFAULT_TIMEOUT)
        else:
            self.timeout = timeout
        self.read_timeout = read_timeout
        self._rng: np.random.Generator | None = None
        self._proxies: list[Proxy] = []
        self._routes: dict[tuple[int, ...], list[Proxy]] = {}
        self._out: list[bytes] = []
        self._out_size = 0
        self._backlog = Backlog()
        self._asked = False
        self._acknowledged = False
        self._in_step = False  # the last round is over, and nothing that came since is left
        self._familiar = Familiar(read_round)
        self._closed = False
        self._outside = place.sock is None
        self._mode = DataMode.PUSH  # a server's first state
        self._link = Link(place, self.timeout)
        self.banner = self._link.banner
        """What the server said first, such as `Player v.3.1.1-dev`; control characters escaped."""
        try:
            self.set_data_mode(mode)
            if replace:
                self.add_replace_rule()
        except BaseException:
            self._link.close()
            raise

    @property
    def address(self) -> str:
        """Where the server is: host and port, or "the inherited socket"."""
        return self._link.address

    @property
    def ending(self) -> str:
        """Why the run is over for this client; "" while it is not."""
        return self._link.ending

    def __repr__(self) -> str:
        return f"<PlayerClient of {self.address}{', ' + self.ending if self.ending else ''}>"

    # -- for controllers --------------------------------------------------------------------

    def read(self) -> bool:
        """Waits for the next reading and hands it to the proxies; False when the run is over.

        In pull mode that is one round: every subscribed device's newest data. In push mode it
        is what has arrived, at least one device's data. Queued commands travel along.
        Raises PlayerTimeout, ProtocolError, and PlayerDisconnected after `close`.
        """
        if self._closed:
            raise PlayerDisconnected("this PlayerClient has been closed")
        for proxy in self._proxies:
            proxy.fresh = False
        if self.ending:
            return False
        if not self._routes:
            raise ProtocolError("read() would wait for ever: make a proxy of a device first")
        try:
            return self._read_round() if self._mode is DataMode.PULL else self._read_pushed()
        except PlayerDisconnected:
            if self._link.clean:
                return False
            raise

    def flush(self) -> None:
        """Sends queued commands now, without waiting for the next `read`.

        Raises PlayerDisconnected if the server has gone, PlayerTimeout if it takes nothing.
        """
        if not self._send_queued():
            self._link.end()

    def rng(self) -> np.random.Generator:
        """This robot's random generator, seeded by the run's seed: the same one at each call."""
        if self._rng is None:
            self._rng = np.random.default_rng([self.seed])
        return self._rng

    def devices(self) -> list[DeviceAddr]:
        """The devices at the server's port."""
        reply = self.request(_PLAYER, PlayerRequest.DEVLIST)
        return [DeviceAddr(int(row[2]), int(row[3])) for row in reply["devices"]]

    def driver(self, addr: DeviceAddr) -> str:
        """The name of the driver behind a device; PlayerRefused if there is no such device.

        Control characters in it are escaped, as in all names that a server gives.
        """
        reply = self.request(
            _PLAYER, PlayerRequest.DRIVERINFO, {"addr": (0, 0, *addr), "driver": ""}
        )
        return printable(reply["driver"])

    def set_data_mode(self, mode: Literal["pull", "push"]) -> None:
        """Chooses between asking for data ("pull") and being sent it as it comes ("push")."""
        modes = {"pull": DataMode.PULL, "push": DataMode.PUSH}
        if mode not in modes:
            raise ValueError(f"mode is 'pull' or 'push' ({mode!r} given)")
        self.request(_PLAYER, PlayerRequest.DATAMODE, {"mode": modes[mode]})
        self._mode = modes[mode]
        self._asked = self._acknowledged = False

    def add_replace_rule(
        self,
        interf: int = ANY,
        index: int = ANY,
        subtype: int = ANY,
        replace: Replace = Replace.REPLACE,
    ) -> None:
        """What the server does with data while older data of its kind waits (-1: any)."""
        rule = {
            "interf": interf,
            "index": index,
            "type": _DATA,
            "subtype": subtype,
            "replace": replace,
        }
        self.request(_PLAYER, PlayerRequest.ADD_REPLACE_RULE, rule)

    def close(self) -> None:
        """Sends queued commands, unsubscribes all devices as Player's library does, and closes.

        Further calls do nothing. By unsubscribing a server over TCP can tell a client that is done
        from one that has broken off.
        """
        self._close(done=True)

    def _close(self, done: bool) -> None:
        if self._closed:
            return
        if not self.ending:
            if done and self._outside:
                for addr in self._routes:
                    message = {"addr": (0, 0, *addr), "access": Access.CLOSE, "driver": ""}
                    payload = _encode(_PLAYER.interf, _REQ, PlayerRequest.DEV, message)
                    self._out.append(pack_message(*_PLAYER, _REQ, PlayerRequest.DEV, payload))
            with contextlib.suppress(PlayerDisconnected, OSError):
                self.flush()
        self._closed = True
        self._link.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        self._close(done=kind is None)

    # -- for proxies ------------------------------------------------------------------------

    def subscribe(self, proxy: Proxy) -> str:
        """Subscribes the proxy's device, once for all its proxies; returns the driver's name.

        Raises PlayerRefused, with the devices that there are, if there is no such device.
        """
        driver = ""
        if proxy.addr not in self._routes:
            try:
                driver = self._access(proxy.addr, Access.OPEN)
            except PlayerRefused:
                there = ", ".join(str(addr) for addr in self.devices()) or "none"
                raise PlayerRefused(
                    f"no device {proxy.addr} at {self.address} (devices there: {there})"
                ) from None
        self._routes.setdefault(tuple(map(int, proxy.addr)), []).append(proxy)
        self._proxies.append(proxy)
        return driver

    def unsubscribe(self, proxy: Proxy) -> None:
        """Undoes `subscribe`; nothing if the connection is gone."""
        self._proxies.remove(proxy)
        route = self._routes[proxy.addr]
        route.remove(proxy)
        if not route:
            del self._routes[proxy.addr]
            if not (self._closed or self.ending):
                self._access(proxy.addr, Access.CLOSE)

    def _access(self, addr: DeviceAddr, access: Access) -> str:
        message = {"addr": (0, 0, *addr), "access": access, "driver": ""}
        reply = self.request(_PLAYER, PlayerRequest.DEV, message)
        if reply["access"] != access:
            raise PlayerRefused(f"{self.address} could not {access.name.lower()} {addr}")
        return printable(reply["driver"])

    def command(self, addr: DeviceAddr, subtype: int, message: Values) -> None:
        """Queues a command for the next `read`, request or `flush`.

        Raises XdrError, a ValueError, where a value does not fit or is no finite number.
        """
        payload = _encode(addr.interf, _CMD, subtype, message)
        self.queue(pack_message(*addr, _CMD, subtype, payload))

    def queue(self, data: bytes) -> None:
        """Queues one encoded message; sends what is queued when it gets long."""
        if self._closed:
            raise PlayerDisconnected("this PlayerClient has been closed")
        if self.ending:
            return  # the robot is not there any more; the next read() says so
        self._out.append(data)
        self._out_size += len(data)
        if self._out_size > FLUSH_SIZE:
            with contextlib.suppress(PlayerDisconnected):
                self.flush()

    def request(self, addr: DeviceAddr, subtype: int, message: Values | None = None) -> Values:
        """Sends a request, waits for its reply and returns the reply's fields.

        Data that comes in between is kept for the next `read`, within bounds. Raises PlayerRefused
        at a NACK, PlayerTimeout, PlayerDisconnected, and XdrError, a ValueError, if `message` does
        not fit or holds what is no finite number.
        """
        if self._closed or self.ending:
            raise PlayerDisconnected(self.ending or "this PlayerClient has been closed")
        payload = _encode(addr.interf, _REQ, subtype, message or {})
        self._in_step = False
        self._out.append(pack_message(*addr, _REQ, subtype, payload))
        self._send_queued()

        def name() -> str:
            spec = messages.find(addr.interf, _REQ, subtype)
            return f"{spec.name if spec else subtype} of {addr}"

        deadline = Deadline(self.timeout, name)
        expected = (*addr, subtype)
        while True:
            got = self._link.next(deadline)
            if got.type == _DATA:
                self._backlog.add(got)
            elif got.type == _SYNCH:
                if self._asked:
                    self._backlog.end_round()
            elif self._is_data_ack(got):
                self._acknowledged = True
            elif (got.interf, got.index, got.subtype) != expected:
                self.stray += 1
            elif got.type == _NACK:
                raise PlayerRefused(f"{self.address} refused the request {name()}")
            elif got.type == _ACK:
                return messages.decode(addr.interf, _ACK, subtype, got.payload)

    # -- messages ---------------------------------------------------------------------------

    def _read_round(self) -> bool:
        if not (self._in_step and self.timeout is None and self.read_timeout is None):
            return self._read_slowly()
        self._in_step = False
        out = self._out
        out.append(_REQUEST_DATA)
        said = b"".join(out)
        out.clear()
        self._out_size = 0
        self._asked = True
        return self._take(self._link.exchange(said)) or self._read_slowly()

    def _take(self, data: bytes) -> bool:
        """Hands a round to the proxies, if all of it is here and looks like one before.

        Otherwise, False, its messages are read one by one.
        """
        found = self._familiar.match(data)
        if found is None:
            self._link.feed(data)
            self._familiar.learn(data)
            return False
        round, parts = found
        self.time = parts[1]  # in case it holds no data
        routes = self._routes
        taken = 0
        try:
            for at, subtype, addr, taken in round:  # noqa: B007 - needed where a proxy raises
                self.time = time = parts[at - 2]
                for proxy in routes.get(addr, ()):
                    proxy.take(subtype, parts[at], time)
        except BaseException:
            self._acknowledged = True
            self._link.feed(data[taken:])  # the rest is for the next reading
            raise
        self._asked = False
        self._in_step = True
        return True

    def _read_slowly(self) -> bool:
        """Reads a round message by message, from where an earlier reading has come to."""
        link = self._link
        kept, ended = self._backlog.take()
        over = self._asked and ended  # the round that an earlier read() gave up waiting for
        if not self._asked:
            self._out.append(_REQUEST_DATA)
            self._asked = True
        elif over:
            self._asked = self._acknowledged = False
        self._send_queued()
        for message in kept:
            self._dispatch(message)
        if over:
            return True
        deadline = Deadline(self.read_timeout if self._acknowledged else self.timeout, _data)
        if not (self._acknowledged or link.buffered) and self._take(link.receive(deadline)):
            return True
        while True:
            message = link.next(deadline)
            type_ = message.type
            if type_ == _DATA:
                self._dispatch(message)
            elif type_ == _SYNCH:
                self._asked = self._acknowledged = False
                self._in_step = not (self._backlog or link.buffered)
                return True
            elif self._is_data_ack(message) and not self._acknowledged:
                self._acknowledged = True
                self.time = message.time  # in case the round holds no data
                deadline = Deadline(self.read_timeout, _data)
            elif type_ == _NACK and self._is_data_reply(message):
                self._asked = False
                raise PlayerRefused(f"{self.address} refused to send data")
            else:
                self.stray += 1

    def _read_pushed(self) -> bool:
        kept, _ = self._backlog.take()
        self._send_queued()
        found = bool(kept)
        deadline = Deadline(self.read_timeout, _data)
        message: Message | None
        for message in kept:
            self._dispatch(message)
        while True:
            message = self._link.waiting()
            if message is None:
                if found:
                    return True
                message = self._link.next(deadline)
            if message.type == _DATA:
                self._dispatch(message)
                found = True
            elif message.type != _SYNCH:
                self.stray += 1

    @staticmethod
    def _is_data_reply(message: Message) -> bool:
        return message.interf == _PLAYER.interf and message.subtype == PlayerRequest.DATA

    def _is_data_ack(self, message: Message) -> bool:
        return self._asked and message.type == _ACK and self._is_data_reply(message)

    def _dispatch(self, message: Message) -> None:
        self.time = message.time
        for proxy in self._routes.get(message[2:4], ()):
            proxy.take(message.subtype, message.payload, message.time)

    def _send_queued(self) -> bool:
        """Sends what is queued; False if the server has closed."""
        if not self._out:
            return True
        data = b"".join(self._out)
        self._out.clear()
        self._out_size = 0
        return self._link.send(data, self.timeout)


__all__ = ["DEFAULT_PORT", "DEFAULT_TIMEOUT", "PlayerClient"]
