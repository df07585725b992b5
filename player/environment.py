"""Where a client finds its robot: arguments, then the PLAYER_ variables, then Player's default."""

from __future__ import annotations

import math
import os
import socket
import stat
from collections.abc import Mapping
from typing import NamedTuple

from player.codes import DEFAULT_PORT
from player.errors import PlayerDisconnected

DEFAULT_HOST = "127.0.0.1"

_taken: set[int] = set()


class Place(NamedTuple):
    """A server's address, or a socket that is connected to it already."""

    host: str = DEFAULT_HOST
    port: int = DEFAULT_PORT
    sock: socket.socket | None = None
    index: int = 0  # type: ignore[assignment]  # of a device, not tuple's method
    seed: int = 0


def find_place(host: str | None, port: int | None, environ: Mapping[str, str]) -> Place:
    """The server that arguments and environment name.

    PLAYER_FD (an inherited socket) counts only if neither host nor port is given. Raises
    PlayerDisconnected, which names the variable, where one cannot be used.
    """
    index = _number(environ, "PLAYER_INDEX", 0, 0xFFFF)
    seed = _number(environ, "PLAYER_SEED", 0, None)
    if host is None and port is None and environ.get("PLAYER_FD"):
        sock = _inherited(_number(environ, "PLAYER_FD", 0, None))
        return Place(sock=sock, index=index, seed=seed)
    return Place(
        host=host if host is not None else environ.get("PLAYER_HOST") or DEFAULT_HOST,
        port=port if port is not None else _number(environ, "PLAYER_PORT", DEFAULT_PORT, 0xFFFF),
        index=index,
        seed=seed,
    )


def find_timeout(environ: Mapping[str, str], default: float) -> float | None:
    """Seconds that a server over TCP has for an answer, PLAYER_TIMEOUT; 0 there: for ever (None).

    Raises PlayerDisconnected, which names the variable, where it is no such number.
    """
    text = environ.get("PLAYER_TIMEOUT", "")
    if not text:
        return default
    try:
        seconds = float(text)
    except ValueError:
        seconds = math.nan
    if not 0 <= seconds < math.inf:
        raise PlayerDisconnected(
            f"PLAYER_TIMEOUT={text!r} in the environment is no number of seconds (0: for ever)"
        )
    return seconds or None


def _number(environ: Mapping[str, str], name: str, default: int, top: int | None) -> int:
    text = environ.get(name, "")
    if not text:
        return default
    if not (text.isascii() and text.isdigit()) or (top is not None and int(text) > top):
        limit = "a whole number" if top is None else f"a number from 0 to {top}"
        raise PlayerDisconnected(f"{name}={text!r} in the environment is not {limit}")
    return int(text)


def _inherited(fd: int) -> socket.socket:
    if fd in _taken:
        raise PlayerDisconnected(
            "a PlayerClient of this process has the robot's socket already (PLAYER_FD): "
            "make all proxies on that one"
        )
    try:
        is_socket = stat.S_ISSOCK(os.fstat(fd).st_mode)
    except OSError as error:
        raise PlayerDisconnected(f"PLAYER_FD={fd}: {error.strerror}") from None
    if not is_socket:
        raise PlayerDisconnected(f"PLAYER_FD={fd} is not a socket")
    os.set_inheritable(fd, False)  # what a controller starts does not hold the robot
    _taken.add(fd)
    return socket.socket(fileno=fd)


def release(sock: socket.socket) -> None:
    """Forgets an inherited socket that is about to be closed."""
    _taken.discard(sock.fileno())
