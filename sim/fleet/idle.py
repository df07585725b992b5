"""In place of the fork server, where a run has no process to start."""

from __future__ import annotations

from typing import Any


class NoFleet:
    """A fleet without processes."""

    def __init__(self) -> None:
        self.pids: dict[int, int] = {}
        self.outputs: dict[int, Any] = {}
        self.lost = False

    def attach(self, watch: Any, unwatch: Any) -> None:
        """There are no news."""

    def take_ended(self) -> dict[int, int]:
        """Nobody has ended."""
        return {}

    def kill(self, key: int) -> None:
        """There is nobody to end."""

    def close(self) -> None:
        """There is nothing to end."""
