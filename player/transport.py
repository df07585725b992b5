"""Socket options without which small Player messages wait 40 ms for each other."""

from __future__ import annotations

import contextlib
import socket

_QUICKACK: int | None = getattr(socket, "TCP_QUICKACK", None)  # Linux only


def hurry(sock: socket.socket) -> None:
    """Sends small messages at once (NODELAY) and acknowledges at once (QUICKACK)."""
    with contextlib.suppress(OSError):
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    quick_acknowledge(sock)


def quick_acknowledge(sock: socket.socket) -> None:
    """Acknowledges what has come at once; to be called after every recv that nothing is said to.

    Linux takes QUICKACK back by itself. Without it a peer that writes a command and then a
    request, with Nagle's algorithm on as in Player's own library, waits for a delayed ACK.
    """
    if _QUICKACK is not None:
        with contextlib.suppress(OSError):
            sock.setsockopt(socket.IPPROTO_TCP, _QUICKACK, 1)
