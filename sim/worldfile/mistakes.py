"""What is wrong with a world file, and where: one mistake, and the error that carries them all."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from player.printable import printable


@dataclass(frozen=True)
class Mistake:
    """One thing that is wrong in a world file or in a file that it names.

    `where` is the path of keys and list indices, such as `("robots", 0, "model")`; `file`,
    `line` and `column` (both from 1) are None until they are known: whoever finds a mistake
    names `where`, and `load` looks up the place: of the value, or with `at_key` of its key.
    """

    where: tuple[str | int, ...]
    what: str
    given: str | None = None
    allowed: str | None = None
    file: str | None = None
    line: int | None = None
    column: int | None = None
    at_key: bool = False

    def __str__(self) -> str:
        """One line; what the file says in it is shown without anything that a terminal obeys."""
        parts = (self.file or None, self.line, self.column)  # no file: a world from Python
        place = [str(part) for part in parts if part is not None]
        heads = [":".join(place), ".".join(_cut(str(key), 80) for key in self.where)]
        text = ": ".join([head for head in heads if head] + [_cut(self.what, 400)])
        notes = [f"given: {_cut(self.given, 200)}"] if self.given is not None else []
        notes += [f"allowed: {_cut(self.allowed, 600)}"] if self.allowed is not None else []
        return printable(f"{text} ({'; '.join(notes)})" if notes else text)


def _cut(text: str, most: int) -> str:
    """A text without its middle where it is too long for a line."""
    if len(text) <= most:
        return text
    half = most // 2 - 2
    return f"{text[:half]}...{text[-half:]}"


MOST_TOLD = 100
"""Mistakes told one by one: who has more begins with the first ones anyway."""


class WorldError(ValueError):
    """A world that cannot be used; `mistakes` holds all that was found, in the files' order.

    Its text has the first `MOST_TOLD` of them, and says how many more there are.
    """

    def __init__(self, mistakes: Iterable[Mistake]) -> None:
        self.mistakes: list[Mistake] = list(mistakes)
        lines = [str(mistake) for mistake in self.mistakes[:MOST_TOLD]]
        more = len(self.mistakes) - len(lines)
        if more:
            lines.append(f"... and {more} more mistake{'s' if more > 1 else ''}")
        super().__init__("\n".join(lines))


def did_you_mean(word: str, known: Iterable[str]) -> str | None:
    """The known word that `word` most likely stands for, or None if none is near."""
    words = list(known)
    folded = {name.casefold(): name for name in reversed(words)}
    wanted = word.casefold()
    for candidate in (wanted, wanted.replace("-", "_").replace(" ", "_")):
        if candidate in folded:
            return folded[candidate]
    near = difflib.get_close_matches(wanted, folded, n=1, cutoff=0.6)
    return folded[near[0]] if near else None


def suggestion(word: str, known: Iterable[str]) -> str:
    """`; did you mean X?` for a misspelt word, or nothing."""
    meant = did_you_mean(word, known)
    return f"; did you mean {meant}?" if meant is not None else ""


def listed(names: Sequence[str], most: int = 12) -> str:
    """Names in a row for a message, cut off after `most`."""
    shown = ", ".join(names[:most])
    return f"{shown}, ... ({len(names)} in all)" if len(names) > most else shown
