"""Names that a server gives, as a terminal may be shown them."""

from __future__ import annotations

import re

_OBEYED = re.compile(
    "[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]"
)
"""What a terminal would obey, or be led astray by, or could not show at all."""


def printable(text: str) -> str:
    """A text as one line, with its control characters written out: `\\x1b[2J`, `\\n`."""
    return _OBEYED.sub(lambda match: match[0].encode("unicode_escape").decode("ascii"), text)
