"""The command's standard input, output and error: open, fit for any text, never a traceback.

Whatever a command prints goes through here, and with it all that others have written: names of
files, keys of worlds, answers of servers. So here it is made safe for a terminal, once for all.
"""

from __future__ import annotations

import io
import sys
from types import TracebackType
from typing import TYPE_CHECKING, Any, TextIO

from player.printable import printable_lines
from sim.fleet.processes import hold_standard_descriptors

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
    sys.excepthook = print_plainly


def print_plainly(
    kind: type[BaseException], error: BaseException, trace: TracebackType | None
) -> None:
    """A traceback without the colours that Python 3.13 and later add."""
    from traceback import print_exception  # noqa: PLC0415 - loaded where something goes wrong

    print_exception(kind, error, trace)


class Writer(io.TextIOWrapper):
    """Text to a descriptor, with signs in place of characters that a terminal would obey.

    rich writes its own codes (colours, the bar) past that: to what it finds as `rich_proxied_file`.
    """

    def __init__(self, raw: Descriptor, encoding: str) -> None:
        line_by_line = not raw.vital or raw.isatty()
        buffer = io.BufferedWriter(raw)
        super().__init__(buffer, encoding, "backslashreplace", line_buffering=line_by_line)
        self.rich_proxied_file = _Unchanged(self)

    def write(self, text: str, /) -> int:
        super().write(printable_lines(text))
        return len(text)

    def write_unchanged(self, text: str) -> int:
        """Write text with its control characters."""
        return super().write(text)


class _Unchanged:
    """A writer as rich sees it: what it writes is written as it is."""

    def __init__(self, writer: Writer) -> None:
        self._writer = writer
        self.write = writer.write_unchanged

    def __getattr__(self, name: str) -> Any:
        return getattr(self._writer, name)


def _writer(known: TextIO | None, number: int, *, vital: bool) -> TextIO:
    """A text file on a descriptor, in the encoding that Python has found."""
    return Writer(Descriptor(number, vital), "utf-8" if known is None else known.encoding)
