"""A record as one line of JSON that says itself whether it is whole.

    {"sum": "1c291ca3", "name": "HASH-sSEED", "outcome": "completed", "tries": 1, ...}

`sum` is the CRC-32 of everything behind its own comma and blank. Any reader of JSON reads it.
"""

from __future__ import annotations

import json
import re
import zlib
from collections.abc import Mapping
from typing import Any, NamedTuple

from sim.strictjson import plain

HEAD = re.compile(
    rb'\{"sum": "([0-9a-f]{8})", '
    rb'("name": "([0-9a-f]+-s[0-9]+)", "outcome": "([a-z_]+)", "tries": ([0-9]+).*)\n',
    re.DOTALL,
)


class Line(NamedTuple):
    """A whole line: what is asked most, without reading its JSON."""

    name: str
    outcome: str
    tries: int
    data: bytes

    @property
    def record(self) -> dict[str, Any]:
        found: dict[str, Any] = json.loads(self.data)
        del found["sum"]
        return found


def line_of(record: Mapping[str, Any]) -> bytes:
    """A record, which has a name, an outcome and tries, as its line."""
    first = {key: record[key] for key in ("name", "outcome", "tries")}
    text = json.dumps(plain({**first, **record}), allow_nan=False)
    body = text[1:].encode()
    return b'{"sum": "%08x", %s\n' % (zlib.crc32(body), body)


def read_line(data: bytes) -> Line | None:
    """The line, or None if it is not whole."""
    match = HEAD.fullmatch(data)
    if match is None or int(match[1], 16) != zlib.crc32(match[2]):
        return None
    return Line(match[3].decode(), match[4].decode(), int(match[5]), data)


def better(one: Line, other: Line | None) -> Line:
    """Of two lines about one run the one that counts: completed, or else of more tries."""
    if other is None:
        return one
    return max(one, other, key=lambda line: (line.outcome == "completed", line.tries, line.data))
