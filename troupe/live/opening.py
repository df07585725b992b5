"""A view beside a command: its address is told, a browser opened, run after run watched."""

from __future__ import annotations

import os
import sys
import threading
import webbrowser
from collections.abc import Callable
from time import sleep
from types import TracebackType
from typing import TYPE_CHECKING, Self

from sim.ports import is_loopback
from troupe.live.exchange import Exchange
from troupe.live.server import LiveServer
from troupe.live.watch import Watch

if TYPE_CHECKING:
    from sim.engine import Engine
    from troupe.log import Log

LOOK_AGAIN = 0.1
"""Wall-clock seconds between two looks at what is asked for after a run's end."""


class Served:
    """The page, at an address that is told, as long as it is entered.

    `host`, `port` (0: any free one): where. Raises OSError, when it is entered, where the address
    cannot be had. `what`: what whoever knows the address can do.
    """

    def __init__(
        self,
        host: str,
        port: int,
        *,
        browser: bool,
        read_only: bool,
        say: Callable[[str], None],
        what: str = "watch the run and reach into it",
        place: str = "",
    ) -> None:
        self.host, self.port = host, port
        self.browser, self.say = browser, say
        self.what = "watch" if read_only else what
        self.place = place
        self.exchange = Exchange()
        self.server = LiveServer(self.exchange, read_only=read_only)

    @property
    def address(self) -> str:
        """What a browser on this machine is to open."""
        return self.server.address + self.place

    def __enter__(self) -> Self:
        self.server.open(self.host, self.port)
        self.say(f"watch it at {self.address}")
        if not is_loopback(self.host):
            self.say(
                f"the view listens on {self.host}: whoever reaches this address and knows "
                f"its token can {self.what}; what goes there is not encrypted"
            )
        if self.browser and has_desktop():
            threading.Thread(target=webbrowser.open, args=(self.address,), daemon=True).start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.server.close()


class LiveView(Served):
    """Shows runs to browsers as long as it is entered.

    `paused`: the first run stands at its beginning. `stays`: the page stays when the run is over,
    until `going_on()` is False. `again`: whether a run may be begun again.
    """

    def __init__(
        self,
        host: str = "127.0.0.1",
        port: int = 0,
        *,
        browser: bool = True,
        read_only: bool = False,
        paused: bool = False,
        stays: bool = False,
        again: bool = True,
        say: Callable[[str], None],
        warn: Callable[[str], None],
    ) -> None:
        super().__init__(host, port, browser=browser, read_only=read_only, say=warn)
        self.stays = stays
        self.tell = say
        self.watch = Watch(self.exchange, paused=paused, again=again)

    def each_tick(self, engine: Engine) -> None:
        """To be called after every tick."""
        self.watch.each_tick(engine)

    def while_waiting(self, engine: Engine) -> None:
        """To be called while the world waits."""
        self.watch.while_waiting(engine)

    def next_seed(self, outcome: str, going_on: Callable[[], bool]) -> int | None:
        """A run has ended; the seed of another one that is asked for, None: no more."""
        self.watch.finish(outcome)
        if self.stays and self.watch.restart is None and going_on():
            self.tell("the run is over; its view stays until you press Ctrl-C")
            while self.watch.restart is None and going_on():
                self.watch.linger()
                sleep(LOOK_AGAIN)
        seed = self.watch.restart if going_on() or self.watch.restart is not None else None
        self.watch.leave()
        return seed


class LogView(Served):
    """Shows a log to browsers as long as it is entered, from second `start` of it on."""

    def __init__(
        self,
        log: Log,
        host: str = "127.0.0.1",
        port: int = 0,
        *,
        start: float = 0.0,
        browser: bool = True,
        read_only: bool = False,
        warn: Callable[[str], None],
    ) -> None:
        """Raises LogError for a log of whose run nothing can be shown."""
        from troupe.live.playing import Playing  # noqa: PLC0415 - a run needs nothing of it

        super().__init__(
            host,
            port,
            browser=browser,
            read_only=read_only,
            say=warn,
            what="watch, and say what the others see",
            place=f"#t={start:g}" if start else "",
        )
        self.playing = Playing(log, self.exchange, start=start)

    def play(self, going_on: Callable[[], bool]) -> None:
        """Show the log until `going_on()` is False."""
        self.playing.play(going_on)


def has_desktop() -> bool:
    """Whether a browser would open before whoever has started us, and not in the terminal."""
    if "SSH_CONNECTION" in os.environ:
        return False
    shown = "DISPLAY" in os.environ or "WAYLAND_DISPLAY" in os.environ
    return sys.platform == "darwin" or shown
