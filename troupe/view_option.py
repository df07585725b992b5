"""`--view`, behind which an address may stand or not."""

from __future__ import annotations

import itertools
import re
import sys
from collections.abc import Iterable
from typing import Any, cast

import typer
from typer.core import TyperCommand

from player.printable import printable
from troupe.usage import UsageError

ADDRESS = re.compile(r"\[?[\w.:-]*\]?:\d+|\d+")
"""HOST:PORT, :PORT or PORT. A world that is called so is named by its path, as ./7000."""

MISUSED = cast("type[Exception]", typer.BadParameter.__bases__[0])
"""What Click raises for words that a command does not know."""


class ViewCommand(TyperCommand):
    """A command whose option `--view` takes an address or none."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Click's own, after the address has been told apart."""
        try:
            return super().parse_args(ctx, told_apart(args))
        except MISUSED:
            wrong = no_address(args)
            if wrong is None:
                raise
            print(printable(str(wrong)), file=sys.stderr)
            raise typer.Exit(2) from None


def told_apart(args: Iterable[str]) -> list[str]:
    """The arguments with `--view-at ADDRESS` for an address behind `--view`."""
    found: list[str] = []
    for word in args:
        if found and found[-1] == "--view" and ADDRESS.fullmatch(word):
            found += ["--view-at", word]
        elif word.startswith("--view="):
            found += ["--view", "--view-at", word.removeprefix("--view=")]
        else:
            found.append(word)
    return found


def no_address(args: Iterable[str]) -> UsageError | None:
    """What is wrong with the word behind `--view`, of a command that has one word too many."""
    words = list(args)
    for word, behind in itertools.pairwise(words):
        if word == "--view" and not behind.startswith("-") and not ADDRESS.fullmatch(behind):
            try:
                parse_address("view", behind)
            except UsageError as error:
                return error
    return None


def parse_address(option: str, text: str) -> tuple[str, int]:
    """HOST:PORT, or a port alone, as (host, port); raises UsageError."""
    host, _, port = text.rpartition(":")
    number = int(port) if port.isascii() and port.isdecimal() else -1
    if not 0 <= number <= 65535:
        raise UsageError(f"{option} {text!r}: must be HOST:PORT, such as 127.0.0.1:7000")
    return host.strip("[]") or "127.0.0.1", number
