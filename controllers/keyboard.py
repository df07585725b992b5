"""Keyboard: drive a robot by hand from a terminal, as a client from outside.

`python -m controllers.keyboard 127.0.0.1:6665`, and `--help` for the keys. The connection is in
push mode: it holds up nobody, and a world that only such clients drive runs in real time.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import select
import signal
import sys
import termios
import tty
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NoReturn

from player import DEFAULT_PORT, PlayerClient, PlayerError, PlayerTimeout, Position2dProxy

KEYS = """
w, up     faster forward            +   larger steps
s, down   slower, then backward     -   smaller steps
a, left   turn to the left          ,   sideways to the left (omnidirectional drives)
d, right  turn to the right         .   sideways to the right
space     stop                      q   stop and quit (Ctrl-C and Ctrl-D too)

A speed stays until a key changes it.
"""

POLL = 0.05
"""Wall-clock seconds between two looks at the keys while no data comes."""

ARROWS = {b"A": "w", b"B": "s", b"C": "d", b"D": "a"}
"""The last byte of an arrow key's escape sequence, as the letter that does the same."""

FINEST, COARSEST = 0.01, 1.0
"""Metres per second and radians per second: limits of the step."""


@dataclass
class Throttle:
    """The speeds that the keys have set: m/s forward and to the left, rad/s counter-clockwise."""

    top: float
    top_turn: float
    step: float = 0.1
    vx: float = 0.0
    vy: float = 0.0
    vyaw: float = 0.0

    def press(self, key: str) -> bool:
        """Obey a key; False if it is the one that quits. Keys without a meaning do nothing."""
        if key in ("q", "\x03", "\x04"):
            return False
        if key == "w":
            self.vx = limited(self.vx + self.step, self.top)
        elif key == "s":
            self.vx = limited(self.vx - self.step, self.top)
        elif key == "a":
            self.vyaw = limited(self.vyaw + self.step, self.top_turn)
        elif key == "d":
            self.vyaw = limited(self.vyaw - self.step, self.top_turn)
        elif key == ",":
            self.vy = limited(self.vy + self.step, self.top)
        elif key == ".":
            self.vy = limited(self.vy - self.step, self.top)
        elif key == " ":
            self.vx = self.vy = self.vyaw = 0.0
        elif key == "+":
            self.step = min(2.0 * self.step, COARSEST)
        elif key == "-":
            self.step = max(0.5 * self.step, FINEST)
        return True


def limited(speed: float, top: float) -> float:
    """A speed within its limits; what rounding leaves of a zero is a zero."""
    speed = max(-top, min(top, speed))
    return 0.0 if abs(speed) < 1e-9 else speed


class Keys:
    """Bytes from a terminal as keys; an arrow's escape sequence may come in pieces."""

    def __init__(self) -> None:
        self._held = b""

    def feed(self, data: bytes) -> list[str]:
        """The keys that these bytes complete; arrows as letters, letters in lower case."""
        data = self._held + data
        self._held = b""
        keys: list[str] = []
        at = 0
        while at < len(data):
            if data[at : at + 1] != b"\x1b":
                keys.append(chr(data[at]).lower())
                at += 1
                continue
            end = at + 2
            if len(data) <= end and data[at + 1 : end] in (b"", b"[", b"O"):
                self._held = data[at:]
                break
            if data[at + 1 : end] not in (b"[", b"O"):
                at += 1  # the escape key itself
                continue
            while end < len(data) and not 0x40 <= data[end] <= 0x7E:
                end += 1  # parameters, as of shift and an arrow
            if end == len(data):
                self._held = data[at:]
                break
            keys += ARROWS.get(data[end : end + 1], "")
            at = end + 1
        return keys


@contextlib.contextmanager
def key_by_key(terminal: int) -> Iterator[None]:
    """Keys come one by one and are not shown; the terminal is as it was whatever ends the block.

    SIGTERM and SIGHUP end it as an exit does. Ctrl-Z is off: it would leave the terminal so.
    """
    before = termios.tcgetattr(terminal)
    handlers: dict[signal.Signals, Any] = {}

    def leave(number: int, frame: object) -> NoReturn:
        raise SystemExit(128 + number)

    try:
        for number in (signal.SIGTERM, signal.SIGHUP):
            handlers[number] = signal.signal(number, leave)
        tty.setcbreak(terminal)
        keys = termios.tcgetattr(terminal)
        keys[6][termios.VSUSP] = b"\0"
        termios.tcsetattr(terminal, termios.TCSANOW, keys)
        yield
    finally:
        with contextlib.suppress(termios.error):  # the terminal itself may be gone
            termios.tcsetattr(terminal, termios.TCSADRAIN, before)
        for number, handler in handlers.items():
            signal.signal(number, handler)


def status(base: Position2dProxy, throttle: Throttle) -> str:
    """The line that is shown: what is commanded, and where the robot says that it is."""
    aside = f"  sideways {throttle.vy:+.2f}" if throttle.vy else ""
    stall = "  STALLED" if base.valid and base.stall else ""
    place = f"  at ({base.x:.2f}, {base.y:.2f}) {base.yaw:+.2f} rad{stall}" if base.valid else ""
    return (
        f"forward {throttle.vx:+.2f} m/s{aside}  turn {throttle.vyaw:+.2f} rad/s  "
        f"step {throttle.step:.2f}{place}"
    )


def drive(client: PlayerClient, base: Position2dProxy, throttle: Throttle, terminal: int) -> bool:
    """Drive until a key quits (True) or the server ends the run (False)."""
    keys = Keys()
    shown = ""
    while True:
        try:
            if not client.read():
                return False
        except PlayerTimeout:
            pass  # no data within POLL: time to look at the keys
        if select.select([terminal], [], [], 0.0)[0]:
            data = os.read(terminal, 1024)
            pressed = keys.feed(data) if data else ["q"]  # the terminal was closed
            if not all(map(throttle.press, pressed)):
                return True
            if pressed:
                base.set_speed(throttle.vx, throttle.vyaw, vy=throttle.vy)
                client.flush()
        line = status(base, throttle)
        if line != shown:
            shown = line
            print(f"\r\x1b[K{line}", end="", file=sys.stderr, flush=True)


def place_of(server: str | None) -> tuple[str | None, int | None]:
    """`HOST:PORT`, `HOST` or `:PORT` in parts; ValueError for anything else."""
    if server is None:
        return None, None
    host, colon, port = server.rpartition(":")
    if not colon:
        host, port = server, str(DEFAULT_PORT)
    if not (port.isascii() and port.isdecimal() and 0 < int(port) <= 65535):
        raise ValueError(f"{server!r}: a server is HOST:PORT, such as 127.0.0.1:{DEFAULT_PORT}")
    return host.strip("[]") or "127.0.0.1", int(port)


def main(arguments: Sequence[str] | None = None) -> int:
    """Drive one robot by hand; the exit code."""
    options = argparse.ArgumentParser(
        prog="keyboard",
        description="Drive a robot by hand from a terminal.",
        epilog=KEYS,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    options.add_argument("server", nargs="?", metavar="HOST:PORT", help="default: as any client")
    options.add_argument("--index", type=int, help="of the position2d device")
    options.add_argument("--max-speed", type=float, default=1.0, help="m/s")
    options.add_argument("--max-turn-rate", type=float, default=1.5, help="rad/s")
    args = options.parse_args(arguments)

    if not sys.stdin.isatty():
        print(
            "keyboard: there is no terminal to read keys from. Let the robot's controller be "
            "`external: true`, and start this in a terminal: "
            "python -m controllers.keyboard HOST:PORT",
            file=sys.stderr,
        )
        return 2
    terminal = sys.stdin.fileno()
    throttle = Throttle(args.max_speed, args.max_turn_rate)
    try:
        host, port = place_of(args.server)
        with PlayerClient(host, port, mode="push", read_timeout=POLL) as client:
            base = Position2dProxy(client, args.index)
            print(KEYS, file=sys.stderr)
            try:
                with key_by_key(terminal):
                    quits = drive(client, base, throttle, terminal)
            except KeyboardInterrupt:
                quits = True
            finally:
                print(file=sys.stderr)
                base.set_speed(0.0)
            if not quits:
                print(f"keyboard: {client.ending or 'the run is over'}", file=sys.stderr)
    except (PlayerError, ValueError) as error:
        print(f"keyboard: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:  # while it was connecting
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
