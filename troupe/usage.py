"""What a user can get wrong on the command line, in the arguments of `troupe.run`, or around it."""

from __future__ import annotations


class UsageError(ValueError):
    """Says which option is at fault, and what would do."""


def told(error: OSError) -> str:
    """An error of the system with the file that it is about, without its number."""
    reason = error.strerror or str(error)
    return reason if error.filename is None else f"{error.filename}: {reason}"
