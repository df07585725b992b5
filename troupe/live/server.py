"""The pages' connections, served by a thread of their own: each gets moments at its own pace.

A page tells when it has drawn a moment, and has at most two under way: one that stands in a
debugger, or at the end of a slow line, gets fewer, holds nobody up, and costs one moment's memory.
One that floods, or sends what no page sends, is cut off; the others do not notice.

What is new is written at once by whoever finds that a page can take it (`_feed`), without tasks
that wake each other: a moment costs a run that goes on beside this thread by how much code it goes
through.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import secrets
import threading
from collections.abc import Iterator
from http import HTTPStatus
from time import monotonic, thread_time
from typing import Any

from websockets.asyncio.server import Server as Listening
from websockets.asyncio.server import ServerConnection, broadcast, serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from player.server import cannot_listen
from sim.ports import advised
from troupe.live.asks import DOINGS, Ask, Malformed, parse_ask
from troupe.live.entrance import answer
from troupe.live.exchange import Exchange
from troupe.live.messages import Messages
from troupe.live.viewer import FULL, Viewer

MOST_VIEWERS = 32
LONGEST_ASK = 4096
"""Bytes of a page's message; a longer one ends its connection."""
LAST_WORDS = 2.0
"""Wall-clock seconds within which pages are to have taken what a run ended with."""
POLICY = 1008
"""The code by which a WebSocket is closed over which came what is not allowed."""
START_LIMIT = 60.0


class LiveServer:
    """Serves the page and the exchange's moments."""

    def __init__(self, exchange: Exchange, *, read_only: bool = False) -> None:
        self.exchange = exchange
        self.read_only = read_only
        self.token = secrets.token_urlsafe(16)
        self.bound = ""
        self.port = 0
        self.viewers: set[Viewer] = set()
        self._messages = Messages(read_only)
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="live", daemon=True)
        self._listening: Listening | None = None
        self._spent = 0.0
        self._closing = False

    def open(self, host: str, port: int) -> None:
        """Listen at an address, port 0 for any free one; raises OSError where it cannot be had."""
        self.bound = host
        self._thread.start()
        try:
            self._wait(self._open(host, port), START_LIMIT)
        except BaseException as error:
            self._stop()
            if not isinstance(error, OSError):
                raise
            raise advised(cannot_listen(host, port, error)) from None
        self.exchange.ring = self._ring

    @property
    def address(self) -> str:
        """What a browser on this machine is to open."""
        host = {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(self.bound, self.bound)
        return f"http://{f'[{host}]' if ':' in host else host}:{self.port}/{self.token}/"

    def close(self) -> None:
        """Let pages have the last moment, then end all connections."""
        self.exchange.ring = lambda: None
        with contextlib.suppress(TimeoutError):
            self._wait(self._close(), LAST_WORDS + START_LIMIT)
        self._stop()

    # -- the server's thread ----------------------------------------------------------------

    async def _open(self, host: str, port: int) -> None:
        self._listening = await serve(
            self._view,
            host,
            port,
            process_request=self._entrance,
            compression=None,  # memory and time for each viewer; the bytes go through loopback
            max_size=LONGEST_ASK,
            max_queue=16,
            write_limit=FULL,
            ping_interval=20,
            ping_timeout=60,
            close_timeout=1,
            server_header=None,
        )
        self.port = next(iter(self._listening.sockets)).getsockname()[1]

    async def _close(self) -> None:
        self._closing = True
        self._feed()
        until = monotonic() + LAST_WORDS
        await asyncio.gather(*[self._is_done(viewer, until) for viewer in self.viewers])
        await asyncio.gather(*[viewer.leave() for viewer in self.viewers], return_exceptions=True)
        if self._listening is not None:
            self._listening.close()
            await self._listening.wait_closed()

    async def _is_done(self, viewer: Viewer, until: float) -> None:
        """Wait until a viewer has drawn the last moment, or does not answer, or the time is up."""
        while viewer in self.viewers and viewer.answers and monotonic() < until:
            if viewer.moments == self.exchange.moments and not viewer.under_way:
                return
            await asyncio.sleep(0.01)

    def _entrance(self, line: ServerConnection, request: Request) -> Response | None:
        """Answer plain HTTP; None lets a WebSocket through."""
        found = answer(self.token, self.bound, request.path, request.headers)
        if found is None and len(self.viewers) >= MOST_VIEWERS:
            return line.respond(HTTPStatus.SERVICE_UNAVAILABLE, "Enough are watching.\n")
        if found is None:
            return None
        headers = Headers(
            {
                "Content-Type": found.kind,
                "Content-Length": str(len(found.body)),
                "Cache-Control": "no-store",
                "Referrer-Policy": "no-referrer",
                "X-Content-Type-Options": "nosniff",
                "Connection": "close",
            }
        )
        if found.policy:
            headers["Content-Security-Policy"] = found.policy
        return Response(found.status, found.status.phrase, headers, found.body)

    async def _view(self, line: ServerConnection) -> None:
        """One page, from its coming to its going."""
        viewer = Viewer(line)
        self.viewers.add(viewer)
        self._spent = thread_time()  # it has come in: that is paid once, and by no moment
        self._feed(viewer)
        try:
            async for text in line:
                if not viewer.affords():
                    await line.close(POLICY, "too many messages")
                    break
                try:
                    self._obey(viewer, parse_ask(text))
                except Malformed as error:
                    await line.close(POLICY, f"not understood: {error}")
                    break
        except ConnectionClosed:
            pass
        finally:
            self.viewers.discard(viewer)
            for robot in viewer.drives:
                self.exchange.ask(Ask("drive", robot, (0.0, 0.0, 0.0)))
            for robot in viewer.holds:
                self.exchange.ask(Ask("give", robot))
            self._select()
            self._count_hungry()

    def _obey(self, viewer: Viewer, ask: Ask) -> None:
        if ask.do == "seen":
            viewer.under_way = max(0, viewer.under_way - 1)
            viewer.since = monotonic()
            self._feed(viewer)
        elif ask.do == "select":
            viewer.selected = ask.robots
            self._select()
            self.exchange.wake()
        elif self.read_only and ask.do in DOINGS:
            return
        elif ask.do == "world":
            viewer.wants_world = True
            self._feed(viewer)
        else:
            viewer.note(ask)
            self.exchange.ask(ask)

    def _feed(self, *viewers: Viewer) -> None:
        """Send these pages, or all, what is new to them, as far as they can take it."""
        for viewer in viewers or self.viewers:
            if viewer.takes:
                for message in self._news(viewer):
                    broadcast([viewer.line], message)
        self._count_hungry()
        self._count_cost()

    def _news(self, viewer: Viewer) -> Iterator[str | bytes]:
        """What a page is to be told now."""
        exchange = self.exchange
        moments, scenes = exchange.moments, exchange.scenes  # read first: never ahead of what is
        scene, moment = exchange.scene, exchange.moment
        if viewer.scenes != scenes and scene is not None:
            viewer.scenes, viewer.moments, viewer.frame = scenes, -1, None
            yield self._messages.scene(scene)
        if viewer.notices != exchange.notices:
            viewer.notices = exchange.notices
            yield json.dumps({"notices": exchange.said})
        if viewer.wants_world and moment is not None and exchange.world is not None:
            viewer.wants_world = False
            yield json.dumps({"world": exchange.world(moment)})
        fresh = viewer.moments != moments and viewer.scenes == scenes
        if moment is not None and fresh and (viewer.hungry or self._closing):
            if not viewer.under_way:
                viewer.since = monotonic()
            viewer.under_way += 1
            yield self._messages.moment(moments, moment, viewer)

    def _select(self) -> None:
        chosen = [viewer.selected for viewer in self.viewers]
        self.exchange.selected = frozenset(robot for robots in chosen for robot in robots)

    def _count_hungry(self) -> None:
        """A moment is wanted where somebody has drawn the latest, and will take the next."""
        latest, hungry = self.exchange.moments, False
        for viewer in self.viewers:
            hungry |= viewer.hungry and (viewer.moments == latest or self.exchange.moment is None)
        self.exchange.hungry = hungry

    def _count_cost(self) -> None:
        """What this thread has done is to be a small part of all."""
        now = thread_time()
        self.exchange.spend(now - self._spent)
        self._spent = now

    # -- other threads ----------------------------------------------------------------------

    def _ring(self) -> None:
        self._loop.call_soon_threadsafe(self._feed)

    def _wait(self, work: Any, limit: float) -> None:
        asyncio.run_coroutine_threadsafe(work, self._loop).result(limit)

    def _stop(self) -> None:
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(START_LIMIT)
        if not self._thread.is_alive():
            self._loop.close()
