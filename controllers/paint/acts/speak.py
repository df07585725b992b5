"""What the robot says and reports when something changes."""

from __future__ import annotations

from ..brain import Brain, Command
from ..memory import Phase


def say(brain: Brain, command: Command, text: str) -> None:
    """Say it, unless it was the last thing said."""
    if text != brain.memory.said:
        brain.memory.said = text
        command.say = text


def fail(brain: Brain, command: Command, why: str) -> None:
    """Stop for good, and say why."""
    brain.memory.phase = Phase.FAILED
    command.failure = why
    command.say = why
    command.report["error"] = why
