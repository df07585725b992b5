"""Regions of a grid: from text maps, from arrays, and whether they are connected and without holes.

In a text map `#` is a wall, `.` is free and `S` is a door; outside of the map everything is wall.
Columns and rows are counted from the map's top left, from 0; in messages about a file, lines and
columns are counted from 1, as editors do.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gridworld.topology import first_hole, first_unreached

Cell = tuple[int, int]
"""(column, row), from the top left, from 0."""

_SYMBOLS = "#.S"
_MOST_MISTAKES = 10
_MOST_CELLS = 10**8  # 3 GB of state


class RegionError(ValueError):
    """A region that cannot be used: the message says where and why."""


@dataclass(frozen=True, eq=False)
class Region:
    """A region of the grid and its doors.

    `free` is a bool array (rows, columns), true where the cell belongs to the region. `source`
    names the text file it was read from, for messages.
    """

    free: NDArray[np.bool_]
    doors: tuple[Cell, ...] = ()
    source: str | None = field(default=None)

    def __post_init__(self) -> None:
        if self.free.ndim != 2 or not self.free.any():
            raise RegionError(f"{self.at((0, 0))}: the region has no free cell")
        for door in self.doors:
            self._check_door(door)
        if len(set(self.doors)) < len(self.doors):
            raise RegionError(f"{self.at(self.doors[-1])}: the same door is given twice")

    @property
    def rows(self) -> int:
        """Height in cells."""
        return int(self.free.shape[0])

    @property
    def columns(self) -> int:
        """Width in cells."""
        return int(self.free.shape[1])

    @property
    def cells(self) -> int:
        """Number of free cells, V in the paper."""
        return int(np.count_nonzero(self.free))

    def at(self, cell: Cell) -> str:
        """`cell` for the head of a message: FILE:LINE:COLUMN, or the column and row."""
        column, row = cell
        if self.source is None:
            return f"cell {column},{row}"
        return f"{self.source}:{row + 1}:{column + 1}"

    def with_doors(self, doors: Sequence[Cell]) -> "Region":
        """The same region with other doors. Raises RegionError for a door that is no free cell."""
        return Region(self.free, tuple(doors), self.source)

    def check(self, holes: bool = False) -> None:
        """Raise RegionError unless the region is connected and simply connected (definition 2.1).

        With `holes` it need only be connected.

        Free cells are connected by their four sides; walls also by their corners, so two walls
        that touch diagonally close a gap.
        """
        start = self.doors[0] if self.doors else None
        cell, reached = first_unreached(self.free, start)
        if cell is not None:
            other = self.cells - reached
            origin = "the door" if self.doors else "the first free cell"
            raise RegionError(
                f"{self.at(cell)}: the region is not connected: {_count(other, 'free cell')} "
                f"cannot be reached from {origin}, the first in column {cell[0]}, row {cell[1]}"
            )
        cell, size = first_hole(self.free)
        if cell is not None and not holes:
            raise RegionError(
                f"{self.at(cell)}: the region is not simply connected: there is a hole of "
                f"{_count(size, 'wall cell')} at column {cell[0]}, row {cell[1]} "
                "(walls that the region surrounds)"
            )

    def to_text(self) -> str:
        """The region as a text map."""
        symbols = np.where(self.free, ".", "#")
        for column, row in self.doors:
            symbols[row, column] = "S"
        return "".join("".join(line) + "\n" for line in symbols)

    def _check_door(self, door: Cell) -> None:
        column, row = door
        if not (0 <= column < self.columns and 0 <= row < self.rows):
            raise RegionError(
                f"{self.source + ': ' if self.source else ''}door {column},{row} lies outside of "
                f"the map (columns 0 to {self.columns - 1}, rows 0 to {self.rows - 1})"
            )
        if not self.free[row, column]:
            raise RegionError(
                f"{self.at(door)}: door {column},{row} is in a wall; give the column and row of a "
                "free cell, counted from the top left, from 0"
            )


def parse(text: str, source: str = "map") -> Region:
    """A region from a text map. Raises RegionError with all mistakes, one a line.

    Every line must be equally long; empty lines at the end do not count. The map may or may not
    be framed by walls. The doors are the `S` cells in reading order.

    >>> parse("#..\\n#S.").doors
    ((1, 1),)
    """
    lines = text.split("\n")
    lines = [line.removesuffix("\r") for line in lines]
    while lines and not lines[-1].strip():
        lines.pop()
    if not lines:
        raise RegionError(f"{source}:1:1: the map is empty")
    mistakes = []
    width = len(lines[0])
    for number, line in enumerate(lines, 1):
        for column, symbol in enumerate(line, 1):
            if symbol not in _SYMBOLS:
                mistakes.append(
                    f"{source}:{number}:{column}: {symbol!r} is not allowed "
                    "(# is a wall, . is free, S is a door)"
                )
        if len(line) != width:
            mistakes.append(
                f"{source}:{number}:{min(len(line), width) + 1}: the map is ragged: this line has "
                f"{_count(len(line), 'cell')}, the first has {width}"
            )
    if mistakes:
        if len(mistakes) > _MOST_MISTAKES:
            more = len(mistakes) - _MOST_MISTAKES
            mistakes[_MOST_MISTAKES:] = [f"{source}: and {_count(more, 'more mistake')}"]
        raise RegionError("\n".join(mistakes))
    symbols = np.array([list(line) for line in lines])
    if not (symbols != "#").any():
        raise RegionError(f"{source}:1:1: the map has no free cell")
    doors = tuple((int(column), int(row)) for row, column in np.argwhere(symbols == "S"))
    return Region(symbols != "#", doors, source)


def load(path: str | Path) -> Region:
    """A region from a text map's file. Raises RegionError; OSError if it cannot be read."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise RegionError(f"{path}:1:1: not a text file ({error.reason})") from None
    return parse(text, str(path))


def rectangle(columns: int, rows: int, doors: Sequence[Cell] = ()) -> Region:
    """A region of `columns` x `rows` free cells.

    >>> rectangle(4, 3, doors=[(0, 2)]).doors
    ((0, 2),)
    """
    if columns < 1 or rows < 1:
        raise RegionError(f"a grid of {columns}x{rows} has no cells")
    if columns * rows > _MOST_CELLS:
        raise RegionError(f"a grid of {columns}x{rows} is too large: at most {_MOST_CELLS} cells")
    return Region(np.ones((rows, columns), np.bool_), tuple(doors))


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"
