"""What can be wrong with a log."""

from __future__ import annotations


class LogError(ValueError):
    """A log that cannot be written or read; the text names the file and says what to do."""
