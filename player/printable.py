"""Text of others (names, keys, lines that programs print) as a terminal may be shown it."""

from __future__ import annotations

import re

_OBEYED = "\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff"
"""What a terminal would obey, or be led astray by, or could not show at all."""

_IN_A_LINE = re.compile(f"[\t\n{_OBEYED}]")
_IN_LINES = re.compile(f"[{_OBEYED}]")


def printable(text: str) -> str:
    """A text as one line, with its control characters written out: `\\x1b[2J`, `\\n`."""
    return _IN_A_LINE.sub(_written, text)


def printable_lines(text: str) -> str:
    """The same where the text's lines and tabs are meant to stay what they are."""
    return _IN_LINES.sub(_written, text)


def _written(match: re.Match[str]) -> str:
    return match[0].encode("unicode_escape").decode("ascii")
