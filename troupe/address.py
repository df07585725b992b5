"""An address that a user names: HOST:PORT, or a port of this machine."""

from __future__ import annotations

from troupe.usage import UsageError

Address = str | tuple[str, int]


def parse_address(option: str, given: Address) -> tuple[str, int]:
    """`HOST:PORT`, or a port alone, as (host, port); raises UsageError that names the option."""
    from sim.worldfile.values import is_host  # noqa: PLC0415 - `troupe --help` stays quick

    if isinstance(given, str):
        host, _, port = given.rpartition(":")
        number = int(port) if port.isascii() and port.isdecimal() and len(port) < 6 else -1
    else:
        host, number = pair(given)
    host = host.strip("[]") or "127.0.0.1"
    if not (0 <= number <= 65535 and is_host(host)):
        raise UsageError(f"{option} {given!r}: must be HOST:PORT, such as 127.0.0.1:6665")
    return host, number


def pair(given: object) -> tuple[str, int]:
    """Host and port of what is no text; a port that cannot be where it is no such pair."""
    match given:
        case (str(host), int(port)):
            return host, port
    return "", -1
