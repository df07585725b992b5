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

LOOK_AGAIN = 0.1
"""Wall-clock seconds between two looks at what is asked for after a run's end."""


class LiveView:
    """Serves the page as long as it is entered.

    `host`, `port` (0: any free one): where. `paused`: the first run stands at its beginning.
    `stays`: the page stays when the run is over, until `going_on()` is False. `again`: whether a
    run may be begun again. Raises OSError, when it is entered, where the address cannot be had.
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
        self.host, self.port = host, port
        self.browser, self.stays = browser, stays
        self.say, self.warn = say, warn
        self.exchange = Exchange()
        self.server = LiveServer(self.exchange, read_only=read_only)
        self.watch = Watch(self.exchange, paused=paused, again=again)

    def __enter__(self) -> Self:
        self.server.open(self.host, self.port)
        address = self.server.address
        self.warn(f"watch it at {address}")
        if not is_loopback(self.host):
            what = "watch" if self.server.read_only else "watch the run and reach into it"
            self.warn(
                f"the view listens on {self.host}: whoever reaches this address and knows "
                f"its token can {what}; what goes there is not encrypted"
            )
        if self.browser and has_desktop():
            threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.server.close()

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
            self.say("the run is over; its view stays until you press Ctrl-C")
            while self.watch.restart is None and going_on():
                self.watch.linger()
                sleep(LOOK_AGAIN)
        seed = self.watch.restart if going_on() or self.watch.restart is not None else None
        self.watch.leave()
        return seed


def has_desktop() -> bool:
    """Whether a browser would open before whoever has started us, and not in the terminal."""
    if "SSH_CONNECTION" in os.environ:
        return False
    shown = "DISPLAY" in os.environ or "WAYLAND_DISPLAY" in os.environ
    return sys.platform == "darwin" or shown
