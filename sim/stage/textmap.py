"""Text maps: `#` is wall, `.` is free, `S` is a door; what is wrong is told by line and column."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sim.worldfile.mistakes import Mistake, WorldError
from sim.worldfile.reading import NotRead, read_regular

WHERE = ("map", "file")
SIGNS = "# (wall), . (free) and S (a door)"
MOST_BYTES = 20_000_000
"""Of a text map: 4400 x 4400 characters."""
MOST_MISTAKES = 20
"""A file that is no text map at all is told in so many lines, not in thousands."""


@dataclass(frozen=True)
class TextMap:
    """What a text map says, row 0 at the top, as one reads it.

    walls: (rows, columns) bool. doors: (column, row) of each S in reading order.
    """

    walls: NDArray[np.bool_]
    doors: tuple[tuple[int, int], ...]


def parse_text_map(text: str, file: str) -> TextMap:
    """Read a text map; `file` is its name for messages.

    Raises WorldError with a Mistake per unknown character and per line of another length than
    the first, each with the line and column inside the map file. Empty lines at the end are
    ignored.
    """
    lines = text.removeprefix("\ufeff").split("\n")
    lines = [line.removesuffix("\r") for line in lines]
    while lines and not lines[-1].strip():
        lines.pop()
    if not lines:
        raise WorldError([Mistake(WHERE, "the map is empty", None, SIGNS, file, 1, 1)])
    width = len(lines[0])
    mistakes = list(islice(_mistakes(lines, file), MOST_MISTAKES))
    if mistakes:
        raise WorldError(mistakes)
    signs = np.array(lines).view("U1").reshape(len(lines), width)
    doors = tuple((int(column), int(row)) for row, column in np.argwhere(signs == "S"))
    return TextMap(signs == "#", doors)


def _mistakes(lines: list[str], file: str) -> Iterator[Mistake]:
    width = len(lines[0])
    for number, line in enumerate(lines, start=1):
        if len(line) != width:
            yield Mistake(
                WHERE,
                "all lines of a map must be equally long",
                f"{len(line)} characters",
                f"{width}, as in the first line",
                file,
                number,
                min(len(line), width) + 1,
            )
        if not line.strip("#.S"):
            continue  # none that is unknown
        for column, sign in enumerate(line, start=1):
            if sign not in "#.S":
                what = "unknown character in the map"
                yield Mistake(WHERE, what, repr(sign), SIGNS, file, number, column)


def read_text_map(path: Path) -> TextMap:
    """Read a text map from a file; WorldError where it is missing or not UTF-8 text."""
    try:
        text = read_regular(path, MOST_BYTES).decode("utf-8")
    except UnicodeDecodeError:
        raise WorldError([Mistake(WHERE, "the map is not a text file", str(path))]) from None
    except NotRead as error:
        raise WorldError([Mistake(WHERE, f"the map {error}", str(path))]) from None
    return parse_text_map(text, str(path))
