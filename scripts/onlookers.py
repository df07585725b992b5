"""Pages without a browser that look on at a run, as cheap as can be: they share its cores."""

from __future__ import annotations

import contextlib
import select
import socket

SEEN = b'{"do":"seen"}'
SEEN = bytes([0x81, 0x80 | len(SEEN)]) + bytes(4) + SEEN  # one WebSocket message, masked with zeros


def look_on(address: str, viewers: int) -> None:
    """So many pages that take what comes and say so, in one thread, until the run ends.

    They do without a library: it is the run's cores that they work on.
    """
    place, _, token = address.partition("/")
    host, _, port = place.partition(":")
    hello = (
        f"GET /{token}socket HTTP/1.1\r\nHost: {place}\r\nUpgrade: websocket\r\nConnection: "
        f"Upgrade\r\nSec-WebSocket-Key: {'A' * 22}==\r\nSec-WebSocket-Version: 13\r\n\r\n"
    )
    kept: dict[socket.socket, bytes] = {}
    with contextlib.suppress(OSError):
        for _ in range(viewers):
            page = socket.create_connection((host, int(port)))
            page.sendall(hello.encode())
            while b"\r\n\r\n" not in (data := kept.get(page, b"") + page.recv(4096)):
                kept[page] = data
            kept[page] = data.partition(b"\r\n\r\n")[2]
        while True:
            for page in select.select(kept, (), ())[0]:
                came = page.recv(1 << 20)
                if not came:
                    return
                data = kept[page] + came
                while (end := message_length(data)) <= len(data):
                    if data[0] == 0x82:
                        page.sendall(SEEN)
                    data = data[end:]
                kept[page] = data


def message_length(data: bytes) -> int:
    """Bytes of the WebSocket message that begins so; if its head is not whole, more than these."""
    head = 2 + ({126: 2, 127: 8}.get(data[1], 0) if len(data) > 1 else 0)
    if len(data) < head:
        return head
    return head + (data[1] if head == 2 else int.from_bytes(data[2:head]))
