"""What a client hears, in its order: rounds of data, data that is pushed, and replies.

Data goes to the proxies of its device when the client reads. What comes while a reply is waited for
is kept until then.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from player.backlog import Backlog
from player.codes import DeviceAddr, Interface, MessageType, PlayerRequest
from player.errors import PlayerRefused
from player.header import Message
from player.link import Deadline, Link
from player.saying import REQUEST_DATA
from player.usual_rounds import UsualRounds

if TYPE_CHECKING:
    from player.proxies.base import Proxy

_PLAYER = int(Interface.PLAYER)
_DATA, _, _, _ACK, _SYNCH, _NACK = map(int, MessageType)


def _data() -> str:
    return "data"


class Hearing:
    """Takes what a server sends off a link, and hands data to the proxies."""

    def __init__(self, link: Link) -> None:
        self.stray = 0
        """Replies that nobody was waiting for, dropped."""
        self.routes: dict[tuple[int, ...], list[Proxy]] = {}
        """The proxies, by their devices' interface and index."""
        self._link = link
        self._backlog = Backlog()
        self._usual = UsualRounds(self.routes)
        self._time = 0.0
        self._timely = False  # it is newer than that of the last familiar round
        self._asked = False
        self._acknowledged = False
        self._in_step = False  # the last round is over, and nothing that came since is left

    def route(self, proxy: Proxy) -> None:
        """The proxy gets its device's data from now on."""
        self._usual.forget()
        self.routes.setdefault(tuple(map(int, proxy.addr)), []).append(proxy)
        proxy.rounds = self._usual

    def unroute(self, proxy: Proxy) -> bool:
        """It does not any more; whether nobody else gets it."""
        self._usual.forget()
        route = self.routes[proxy.addr]
        route.remove(proxy)
        if not route:
            del self.routes[proxy.addr]
        return not route

    def begin_again(self) -> None:
        """The mode is another: what was asked for will not come."""
        self._asked = self._acknowledged = self._in_step = False

    def begin(self) -> None:
        """A reading begins: what came before it is not fresh any more."""
        self._usual.begin()

    @property
    def time(self) -> float:
        """Simulated time of the last reading, seconds."""
        return self._time if self._timely else self._usual.time

    # -- rounds -----------------------------------------------------------------------------

    def round(self, timeout: float | None, read_timeout: float | None) -> None:
        """Asks for a round of data, and waits for all of it; raises as `Link` does.

        Seconds of the wall clock for an answer, and for data after it; None: for ever.
        """
        if self._in_step and read_timeout is None:
            self._in_step = False  # unless it ends well
            self._asked = True
            if self._taken(self._link.exchange(REQUEST_DATA, timeout, _data)):
                return
        self._take_slowly(timeout, read_timeout)

    def _taken(self, data: bytes) -> bool:
        """Hands out a familiar round; if it is none, False, its messages are next on the link."""
        usual = self._usual
        try:
            if not usual.hand_out(data):
                self._link.feed(data)
                usual.learn(data)
                return False
        except BaseException:
            self._acknowledged = True
            self._timely = False
            self._link.feed(usual.rest)  # for the next reading
            raise
        self._timely = False
        self._asked = False
        self._in_step = True
        return True

    def _take_slowly(self, timeout: float | None, read_timeout: float | None) -> None:
        """Reads a round message by message, from where an earlier reading has come to."""
        link = self._link
        kept, ended = self._backlog.take()
        over = self._asked and ended  # the round that an earlier read() gave up waiting for
        if not self._asked:
            link.queue(REQUEST_DATA)
            self._asked = True
        elif over:
            self._asked = self._acknowledged = False
        link.send_queued(timeout)
        for message in kept:
            self._dispatch(message)
        if over:
            return
        deadline = Deadline(read_timeout if self._acknowledged else timeout, _data)
        if not (self._acknowledged or link.buffered) and self._taken(link.receive(deadline)):
            return
        while True:
            message = link.next(deadline)
            type_ = message.type
            if type_ == _DATA:
                self._dispatch(message)
            elif type_ == _SYNCH:
                self._asked = self._acknowledged = False
                self._in_step = not (self._backlog or link.buffered)
                return
            elif self._is_data_ack(message) and not self._acknowledged:
                self._acknowledged = True
                self._note(message.time)  # in case the round holds no data
                deadline = Deadline(read_timeout, _data)
            elif type_ == _NACK and self._is_data_reply(message):
                self._asked = False
                raise PlayerRefused(f"{link.address} refused to send data")
            else:
                self.stray += 1

    # -- pushed data ------------------------------------------------------------------------

    def pushed(self, timeout: float | None, read_timeout: float | None) -> None:
        """Takes what data has come, waiting until there is some; raises as `Link` does."""
        link = self._link
        kept, _ = self._backlog.take()
        link.send_queued(timeout)
        found = bool(kept)
        deadline = Deadline(read_timeout, _data)
        message: Message | None
        for message in kept:
            self._dispatch(message)
        while True:
            message = link.waiting()
            if message is None:
                if found:
                    return
                message = link.next(deadline)
            if message.type == _DATA:
                self._dispatch(message)
                found = True
            elif message.type != _SYNCH:
                self.stray += 1

    # -- replies ----------------------------------------------------------------------------

    def reply(
        self, addr: DeviceAddr, subtype: int, name: Callable[[], str], timeout: float | None
    ) -> bytes:
        """Waits for the reply to a request that has been sent; its payload.

        Data that comes in between is kept, within bounds. Raises PlayerRefused at a NACK, and as
        `Link` does; `name()` says in errors which request it was.
        """
        self._in_step = False
        deadline = Deadline(timeout, name)
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
                raise PlayerRefused(f"{self._link.address} refused the request {name()}")
            elif got.type == _ACK:
                return got.payload

    # -- messages ---------------------------------------------------------------------------

    @staticmethod
    def _is_data_reply(message: Message) -> bool:
        return message.interf == _PLAYER and message.subtype == PlayerRequest.DATA

    def _is_data_ack(self, message: Message) -> bool:
        return self._asked and message.type == _ACK and self._is_data_reply(message)

    def _dispatch(self, message: Message) -> None:
        self._usual.settle()
        self._note(message.time)
        for proxy in self.routes.get(message[2:4], ()):
            self._usual.handed.append(proxy)
            proxy.take(message.subtype, message.payload, message.time)

    def _note(self, time: float) -> None:
        self._time = time
        self._timely = True
