"""What an import could not carry over, or carries over otherwise, each with file and line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from troupe.importers.stage.tokens import Place

Kind = Literal["lost", "differs", "looks", "unneeded"]

HEADINGS: dict[Kind, str] = {
    "lost": "not carried over, and robots behave otherwise for it",
    "differs": "otherwise than in Stage",
    "looks": "not carried over, and only seen in Stage's window",
    "unneeded": "of no use here",
}
"""What the kinds are called in the list that people read, in that order."""


@dataclass(frozen=True, slots=True)
class Note:
    """One thing, and where it stands in the input."""

    kind: Kind
    place: Place
    what: str

    def __str__(self) -> str:
        return f"{self.place.file}:{self.place.line}: {self.what}"


class Notes:
    """Notes as they are found; each is kept once, however many robots share a macro."""

    def __init__(self) -> None:
        self._found: dict[Note, None] = {}

    def lost(self, place: Place, what: str) -> None:
        """Something that changes what the world does, and is left out."""
        self._found[Note("lost", place, what)] = None

    def differs(self, place: Place, what: str) -> None:
        """Something that is there, but not quite as Stage has it."""
        self._found[Note("differs", place, what)] = None

    def looks(self, place: Place, what: str) -> None:
        """Something that shows in Stage's window, and that no sensor sees."""
        self._found[Note("looks", place, what)] = None

    def unneeded(self, place: Place, what: str) -> None:
        """Something that concerns Stage's window or its insides, and no robot."""
        self._found[Note("unneeded", place, what)] = None

    def listed(self) -> list[Note]:
        """All notes: by kind, then by file in the order of finding, then by line."""
        files = {note.place.file: None for note in self._found}
        order = {name: index for index, name in enumerate(files)}
        kinds = list(HEADINGS)
        return sorted(
            self._found,
            key=lambda note: (kinds.index(note.kind), order[note.place.file], note.place.line),
        )
