"""The command's standard input, output and error: open, fit for any text, never a traceback."""

from __future__ import annotations

import io
import sys
from typing import TYPE_CHECKING, TextIO

from sim.fleet.forkserver import hold_standard_descriptors

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer


class OutputLost(Exception):
    """What a command prints cannot be written: the disk is full, the reader has gone."""


class ReaderGone(OutputLost):
    """Whoever reads what a command prints, `head` say, has enough: no reason to complain."""


class Descriptor(io.FileIO):
    """A standard file that is written to; after its first error it takes everything, silently.

    That first error is raised as OutputLost, unless the file is not `vital`.
    """

    def __init__(self, number: int, vital: bool) -> None:
        super().__init__(number, "w", closefd=False)
        self.vital = vital
        self.lost = False

    def write(self, data: ReadableBuffer) -> int:
        if not self.lost:
            try:
                return super().write(data)
            except OSError as error:
                self.lost = True
                if self.vital and isinstance(error, BrokenPipeError):
                    raise ReaderGone from None
                if self.vital:
                    raise OutputLost(error.strerror or str(error)) from None
        return memoryview(data).nbytes


def prepare_streams() -> None:
    """To be called first: what was closed leads to /dev/null, and no character is too strange.

    Standard error may be lost without a word; where standard output is, OutputLost is raised.
    """
    hold_standard_descriptors()
    if sys.stdin is None:
        sys.stdin = open(0, encoding="utf-8", closefd=False)  # noqa: SIM115 - as long as we live
    sys.stdout = _writer(sys.stdout, 1, vital=True)
    sys.stderr = _writer(sys.stderr, 2, vital=False)


def _writer(known: TextIO | None, number: int, *, vital: bool) -> TextIO:
    """A text file on a descriptor, in the encoding that Python has found."""
    raw = Descriptor(number, vital)
    return io.TextIOWrapper(
        io.BufferedWriter(raw),
        encoding="utf-8" if known is None else known.encoding,
        errors="backslashreplace",
        line_buffering=not vital or raw.isatty(),
    )
