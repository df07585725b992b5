"""A run that is watched, in a thread of this process; and viewers that are no browsers."""

from __future__ import annotations

import base64
import contextlib
import json
import socket
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from websockets.sync.client import ClientConnection, connect

from sim.interrupts import Interrupts
from sim.result import Result
from sim.view.frames import MOMENT, Message, decode
from tests.patience import PATIENCE
from troupe.live.opening import LiveView
from troupe.running import Run, run_file

STILL = """\
name: Still
size: [10, 8]
duration: 1000
until: duration
boundary: {color: red}
models:
  box:
    body: {shape: box, size: [1, 1], color: green}
    drive: {kind: differential, max_speed: 1.0, max_turn_rate: 90}
    sensors:
      - {type: laser, range: 5, fov: 180, samples: 91}
      - {type: ranger, elements: [[0.5, 0, 0], [0, 0.5, 90]], range: 3, fov: 20}
      - {type: blobfinder, range: 9, fov: 90, image: [90, 60], colors: [green, red]}
      - {type: fiducial, range: 8, fov: 360}
      - {type: bumper, count: 4}
    fiducial: 7
obstacles:
  - {shape: box, size: [1, 4], pose: [5, 4, 0], color: blue}
  - {shape: circle, radius: 0.4, pose: [8, 6, 0], color: orange, movable: true, mass: 2}
robots:
  - {name: anna, model: box, pose: [2, 2, 90]}
  - {name: berta, model: box, pose: [8, 2, 0]}
"""
"""Two robots that nobody drives, a wall between them, and a thing that can be pushed."""


class Watched:
    """A run that goes on in a thread of its own."""

    def __init__(self, world: str | Path, **options: Any) -> None:
        self.lines: list[str] = []
        self.view: LiveView | None = None
        self.done: Run | BaseException | None = None
        self.there = threading.Event()
        self.interrupts = Interrupts()
        paused = options.pop("paused", False)
        stays = options.pop("stays", False)
        read_only = options.pop("read_only", False)

        def window(again: bool) -> LiveView:
            view = LiveView(
                browser=False, paused=paused, stays=stays, read_only=read_only, again=again,
                say=self.lines.append, warn=self.lines.append,
            )  # fmt: skip
            opened = view.server.open

            def open_and_tell(host: str, port: int) -> None:
                opened(host, port)
                self.view = view
                self.there.set()

            view.server.open = open_and_tell  # type: ignore[method-assign]
            return view

        def run() -> None:
            try:
                self.done = run_file(
                    world, say=self.lines.append, view=window, interrupts=self.interrupts, **options
                )
            except BaseException as error:  # told to the test's own thread
                self.done = error
            self.there.set()

        self.thread = threading.Thread(target=run)
        self.thread.start()
        assert self.there.wait(PATIENCE)
        assert self.view is not None, self.done

    @property
    def address(self) -> str:
        assert self.view is not None
        return self.view.server.address

    def stop(self) -> None:
        """End the run as Ctrl-C would, wherever it is."""
        self.interrupts.noted = True
        while self.thread.is_alive():
            assert self.view is not None
            engine = self.view.watch._engine
            if engine is not None:
                engine.crew.interrupted = True
                self.view.exchange.wake()
            self.thread.join(0.05)

    def result(self) -> Result:
        """What came out of it."""
        self.thread.join(PATIENCE)
        assert not self.thread.is_alive()
        assert isinstance(self.done, Run), self.done
        return self.done.result


@contextlib.contextmanager
def watched(world: str | Path, **options: Any) -> Iterator[Watched]:
    """A watched run, which has ended when this is left, and nobody looks on any more."""
    run = Watched(world, **options)
    try:
        yield run
    finally:
        while _viewers:
            _viewers.pop().close()  # or the run's end would wait for them to take their last words
        run.stop()


_viewers: list[Viewer | Deaf] = []


class Viewer:
    """A page without a browser: it takes what comes, and tells that it has."""

    def __init__(self, address: str, **headers: str) -> None:
        parts = urlsplit(address)
        opening = connect(
            f"ws://{parts.netloc}{parts.path}socket",
            max_size=None,
            compression=None,
            additional_headers=headers,
        )
        self.socket: ClientConnection = opening.__enter__()
        _viewers.append(self)

    def ask(self, **what: Any) -> None:
        self.socket.send(json.dumps(what))

    def flood(self) -> None:
        """Ask without end."""
        while True:
            self.ask(do="put", robot=0, pose=[1.0, 1.0, 0.0])

    def message(self) -> Message:
        """The next scene or moment."""
        while isinstance(data := self.socket.recv(PATIENCE), str):
            pass
        found = decode(data)
        self.ask(do="seen")
        return found

    def until(self, wanted: Callable[[Message], bool]) -> Message:
        """The first message of which that holds."""
        while not wanted(found := self.message()):
            pass
        return found

    def notice(self) -> list[str]:
        """The next lines for people."""
        lines: list[str] = self.told("notices")
        return lines

    def told(self, what: str) -> Any:
        """The next text of that name."""
        while True:
            data = self.socket.recv(PATIENCE)
            if not isinstance(data, str):
                self.ask(do="seen")
            elif what in (told := json.loads(data)):
                return told[what]

    def close(self) -> None:
        self.socket.close()


def stepped(viewer: Viewer) -> bool:
    """Whether a viewer is still heard: the run makes a step for it."""
    before = viewer.until(lambda m: m.kind == MOMENT).tick
    viewer.ask(do="step")
    return viewer.until(lambda m: m.tick == before + 1).tick == before + 1


class Deaf:
    """A page on a line that takes next to nothing: it reads only when it is told to."""

    def __init__(self, address: str) -> None:
        parts = urlsplit(address)
        self.socket = socket.socket()
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
        self.socket.settimeout(PATIENCE)
        self.socket.connect((parts.hostname, parts.port))
        key = base64.b64encode(bytes(16)).decode()
        self.socket.sendall(
            f"GET {parts.path}socket HTTP/1.1\r\nHost: {parts.netloc}\r\nUpgrade: websocket\r\n"
            f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\n"
            "Sec-WebSocket-Version: 13\r\n\r\n".encode()
        )
        answer = b""
        while b"\r\n\r\n" not in answer:
            answer += self.socket.recv(1)
        assert b" 101 " in answer
        _viewers.append(self)

    def ask(self, **what: Any) -> None:
        data = json.dumps(what).encode()
        assert len(data) < 126
        self.socket.sendall(bytes([0x81, 0x80 | len(data)]) + bytes(4) + data)

    def bite(self, size: int) -> bytes:
        """The next few bytes; none: the line has ended."""
        return self.socket.recv(size)

    def close(self) -> None:
        self.socket.close()
