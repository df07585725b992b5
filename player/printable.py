"""Names that a server gives, as a terminal may be shown them."""

from __future__ import annotations


def printable(text: str) -> str:
    """A text as one line, with what cannot be printed written out: `\\x1b[2J`, `\\n`."""
    if text.isprintable():
        return text
    return "".join(
        c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text
    )
