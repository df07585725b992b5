"""`troupe print`: what a device of any Player server sends, message by message, as it comes."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np
import typer

from player import DeviceAddr, MessageType, PlayerClient, PlayerError, Proxy, XdrError, messages
from player.codes import Interface
from player.printable import printable
from troupe.commands.devices import ServerArgument, TimeoutOption, connect
from troupe.interrupts import raised

Reading = tuple[float, int, bytes]
"""Simulated time in seconds, subtype and payload of one message."""


def print_(
    server: ServerArgument,
    device: Annotated[
        str, typer.Argument(metavar="DEVICE", help="Interface and index, such as laser:0.")
    ],
    count: Annotated[
        int | None,
        typer.Option(min=1, help="End after so many messages.", show_default="never"),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="One JSON object per line, with all fields.")
    ] = False,
    timeout: TimeoutOption = 5.0,
) -> None:
    """Print a device's readings as they come, until Ctrl-C, or the server goes away.

    The connection is in push mode: it holds nobody up. Exit code 2 if nobody listens there, it
    is no Player server, or it has no such device; 130 after Ctrl-C.
    """
    try:
        addr = readable(device)
        with raised(), connect(server, timeout, mode="push") as client:
            follow(client, addr, count, as_json)
            ending = client.ending
    except (PlayerError, ValueError) as error:
        print(error, file=sys.stderr)
        raise typer.Exit(2) from None
    except KeyboardInterrupt:
        raise typer.Exit(130) from None
    if ending:
        print(ending, file=sys.stderr)


def follow(client: PlayerClient, addr: DeviceAddr, count: int | None, as_json: bool) -> None:
    """Print the device's messages, at most `count`, until the server closes the connection."""
    tap = Tap(client, addr)
    printed = 0
    while client.read():
        for time, subtype, payload in tap.take_all():
            line = as_object if as_json else as_text
            print(line(addr, time, subtype, payload), flush=True)
            printed += 1
            if printed == count:
                return


class Tap(Proxy):
    """Keeps every message of a device, whatever its interface."""

    def __init__(self, client: PlayerClient, addr: DeviceAddr) -> None:
        self.interface = addr.interf  # type: ignore[misc, assignment]  # of this one tap
        self._kept: list[Reading] = []
        super().__init__(client, addr.index)

    def take(self, subtype: int, payload: bytes, time: float) -> None:
        """Called by the client for each message of data from the device."""
        self._kept.append((time, subtype, payload))

    def take_all(self) -> list[Reading]:
        """The messages since the last call, in their order."""
        kept, self._kept = self._kept, []
        return kept


def readable(device: str) -> DeviceAddr:
    """The address of a device that sends data; raises ValueError."""
    addr = DeviceAddr.parse(device)
    rows = [spec for spec in messages.specs() if spec.interf == addr.interf]
    if addr.interf == Interface.PLAYER or (
        rows and all(spec.type != MessageType.DATA for spec in rows)
    ):
        raise ValueError(f"{device}: a device of this interface sends no data")
    return addr


def fields(addr: DeviceAddr, subtype: int, payload: bytes) -> tuple[str, dict[str, Any]]:
    """A message's name and its fields as plain values; `undecoded` hexadecimal if it has none."""
    spec = messages.find(addr.interf, MessageType.DATA, subtype)
    if spec is None:
        return f"subtype {subtype}", {"undecoded": payload.hex()}
    try:
        return spec.name, {key: plain(value) for key, value in spec.decode(payload).items()}
    except XdrError as error:
        return spec.name, {"mistake": str(error), "undecoded": payload.hex()}


def as_object(addr: DeviceAddr, time: float, subtype: int, payload: bytes) -> str:
    """One message as a JSON object on one line; what JSON cannot hold (NaN) is null."""
    name, values = fields(addr, subtype, payload)
    entry = {"time": time, "device": str(addr), "message": name, **values}
    return json.dumps(finite(entry), allow_nan=False)


def as_text(addr: DeviceAddr, time: float, subtype: int, payload: bytes) -> str:
    """One message on one line, for people."""
    name, values = fields(addr, subtype, payload)
    parts = [f"{key} {short(value)}" for key, value in values.items()]
    return f"{time:.3f} {addr} {name}: " + "; ".join(parts)


def short(value: Any) -> str:
    """A value as people read it: four digits, the length before a list."""
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, Mapping):
        return " ".join(f"{key}={short(item)}" for key, item in value.items())
    if isinstance(value, list):
        inside = (
            ", ".join(map(short, value))
            if any(isinstance(item, list | dict) for item in value)
            else " ".join(map(short, value))
        )
        return f"({len(value)}) [{inside}]"
    return printable(str(value))


def plain(value: Any) -> Any:
    """A decoded value as dicts, lists, numbers and texts."""
    if isinstance(value, np.ndarray):
        names = value.dtype.names
        if names is not None:
            return [dict(zip(names, row, strict=True)) for row in value.tolist()]
        return value.tolist()
    if isinstance(value, tuple) and hasattr(value, "_asdict"):
        return {key: plain(item) for key, item in value._asdict().items()}
    if isinstance(value, bytes | bytearray | memoryview):
        return list(value)
    if isinstance(value, tuple | list):
        return [plain(item) for item in value]
    return value


def finite(value: Any) -> Any:
    """The value with null for every number that JSON does not know."""
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, dict):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [finite(item) for item in value]
    return value
