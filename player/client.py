"""A connection to a Player server, as a controller uses it: read, command, request."""

from __future__ import annotations

import contextlib
import os
import socket
from collections.abc import Mapping
from typing import TYPE_CHECKING, Literal, Self

import numpy as np

from player import messages
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
from player.hearing import Hearing
from player.link import Link
from player.printable import printable
from player.saying import access_to, encoded, request_name
from player.xdr import Values

if TYPE_CHECKING:
    from player.proxies.base import Proxy

DEFAULT_TIMEOUT = 5.0
"""Wall-clock seconds that a server over TCP has for an answer, as in Player's own client."""

_PLAYER = DeviceAddr(Interface.PLAYER, 0)
_DATA, _CMD, _REQ, _ACK, _, _ = map(int, MessageType)
_PULL = DataMode.PULL


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
        self.timeout: float | None
        if timeout == "default":
            is_local = place.sock is not None
            self.timeout = None if is_local else find_timeout(environ, DEFAULT_TIMEOUT)
        else:
            self.timeout = timeout
        self.read_timeout = read_timeout
        self._rng: np.random.Generator | None = None
        self._closed = False
        self._outside = place.sock is None
        self._mode = DataMode.PUSH  # a server's first state
        self._link = Link(place, self.timeout)
        self._hearing = Hearing(self._link)
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
    def time(self) -> float:
        """Simulated time of the last reading, seconds."""
        return self._hearing.time

    @property
    def stray(self) -> int:
        """Replies that nobody was waiting for, dropped."""
        return self._hearing.stray

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
        hearing, link = self._hearing, self._link
        hearing.begin()
        if link.ending:
            return False
        if not hearing.routes:
            raise ProtocolError("read() would wait for ever: make a proxy of a device first")
        try:
            if self._mode is _PULL:
                hearing.round(self.timeout, self.read_timeout)
            else:
                hearing.pushed(self.timeout, self.read_timeout)
        except PlayerDisconnected:
            if link.clean:
                return False
            raise
        return True

    def flush(self) -> None:
        """Sends queued commands now, without waiting for the next `read`.

        Raises PlayerDisconnected if the server has gone, PlayerTimeout if it takes nothing.
        """
        if not self._link.send_queued(self.timeout):
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
        self._hearing.begin_again()

    def add_replace_rule(
        self,
        interf: int = ANY,
        index: int = ANY,
        subtype: int = ANY,
        replace: Replace = Replace.REPLACE,
    ) -> None:
        """What the server does with data while older data of its kind waits (-1: any)."""
        rule = {"interf": interf, "index": index, "type": _DATA, "subtype": subtype}
        rule["replace"] = replace
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
                for addr in self._hearing.routes:
                    close = access_to(DeviceAddr(*addr), Access.CLOSE)
                    self._link.queue(encoded(_PLAYER, _REQ, PlayerRequest.DEV, close))
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
        if proxy.addr not in self._hearing.routes:
            try:
                driver = self._access(proxy.addr, Access.OPEN)
            except PlayerRefused:
                there = ", ".join(str(addr) for addr in self.devices()) or "none"
                raise PlayerRefused(
                    f"no device {proxy.addr} at {self.address} (devices there: {there})"
                ) from None
        self._hearing.route(proxy)
        return driver

    def unsubscribe(self, proxy: Proxy) -> None:
        """Undoes `subscribe`; nothing if the connection is gone."""
        if self._hearing.unroute(proxy) and not (self._closed or self.ending):
            self._access(proxy.addr, Access.CLOSE)

    def _access(self, addr: DeviceAddr, access: Access) -> str:
        reply = self.request(_PLAYER, PlayerRequest.DEV, access_to(addr, access))
        if reply["access"] != access:
            raise PlayerRefused(f"{self.address} could not {access.name.lower()} {addr}")
        return printable(reply["driver"])

    def command(self, addr: DeviceAddr, subtype: int, message: Values) -> None:
        """Queues a command for the next `read`, request or `flush`.

        Raises XdrError, a ValueError, where a value does not fit or is no finite number.
        """
        self.queue(encoded(addr, _CMD, subtype, message))

    def queue(self, data: bytes) -> None:
        """Queues one encoded message; sends what is queued when it gets long."""
        if self._closed:
            raise PlayerDisconnected("this PlayerClient has been closed")
        if self._link.ending:
            return  # the robot is not there any more; the next read() says so
        if self._link.queue(data):
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
        self._link.queue(encoded(addr, _REQ, subtype, message or {}))
        self._link.send_queued(self.timeout)

        def name() -> str:
            return request_name(addr, subtype)

        reply = self._hearing.reply(addr, subtype, name, self.timeout)
        return messages.decode(addr.interf, _ACK, subtype, reply)


__all__ = ["DEFAULT_PORT", "DEFAULT_TIMEOUT", "PlayerClient"]
