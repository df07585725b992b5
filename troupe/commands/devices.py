"""`troupe devices`: the devices that any Player server has at a port."""

from __future__ import annotations

import sys
from typing import Annotated, Literal

import typer

from player import DEFAULT_PORT, DeviceAddr, PlayerClient, PlayerError, PlayerRefused

ServerArgument = Annotated[
    str, typer.Argument(metavar="HOST:PORT", help="A Player server, such as 127.0.0.1:6665.")
]
TimeoutOption = Annotated[
    float, typer.Option(help="Wall-clock seconds that the server may take for an answer.")
]


def devices(server: ServerArgument, timeout: TimeoutOption = 5.0) -> None:
    """List the devices of a Player server, and the drivers behind them.

    Exit code 2 if nobody listens there, or nobody who speaks Player's protocol.
    """
    try:
        with connect(server, timeout) as client:
            banner, rows = client.banner, device_rows(client)
    except (PlayerError, ValueError) as error:
        print(error, file=sys.stderr)
        raise typer.Exit(2) from None
    print(f"{server}: {banner}")
    width = max((len(str(addr)) for addr, _ in rows), default=0)
    for addr, driver in rows:
        print(f"  {addr!s:<{width}}  {driver}".rstrip())
    if not rows:
        print("  no devices")


def device_rows(client: PlayerClient) -> list[tuple[DeviceAddr, str]]:
    """Every device in the server's order, with the name of its driver; "" if it does not tell."""
    rows = []
    for addr in client.devices():
        try:
            rows.append((addr, client.driver(addr)))
        except PlayerRefused:
            rows.append((addr, ""))
    return rows


def connect(server: str, timeout: float, mode: Literal["pull", "push"] = "pull") -> PlayerClient:
    """A connection to the server named `HOST:PORT`; raises ValueError and PlayerError.

    Newer data does not take the place of older data. The environment, by which controllers find
    their robots, is not looked at.
    """
    host, port = parse_server(server)
    if not 0 < timeout < float("inf"):
        raise ValueError(f"--timeout {timeout:g}: must be above 0")
    return PlayerClient(host, port, timeout=timeout, mode=mode, replace=False, environ={})


def parse_server(text: str) -> tuple[str, int]:
    """`HOST:PORT`, `HOST` or `:PORT` as (host, port); raises ValueError."""
    host, colon, port = text.rpartition(":")
    if not colon:
        host, port = text, str(DEFAULT_PORT)
    host = host.strip("[]") or "127.0.0.1"
    if not (port.isascii() and port.isdecimal() and 0 < int(port) <= 65535) or " " in host:
        raise ValueError(f"{text!r}: a server is HOST:PORT, such as 127.0.0.1:{DEFAULT_PORT}")
    return host, int(port)
