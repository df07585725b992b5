"""A file that a muxer writes to and that never fails in its face."""

from __future__ import annotations

import os
from pathlib import Path


class Sink:
    """A binary file whose first error is kept, while everything after it is swallowed.

    FFmpeg's MP4 muxer can crash the process when it goes on after a failed write (seen with a
    full disk). So it only ever sees success, and whoever drives it looks at `error`.
    """

    def __init__(self, path: Path) -> None:
        """Opens the file for writing, which empties it; raises OSError."""
        self.error: OSError | None = None
        self._file = path.open("wb", buffering=0)
        self._position = 0

    def write(self, data: bytes) -> int:
        """Writes all of `data`, or keeps the error."""
        size = len(data)
        view = memoryview(data)
        try:
            while self.error is None and view:
                view = view[self._file.write(view) or 0 :]
        except OSError as error:
            self.error = error
        self._position += size
        return size

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Moves to a place, or keeps the error; returns where the file now stands."""
        if self.error is None:
            try:
                self._position = self._file.seek(offset, whence)
            except OSError as error:
                self.error = error
        return self._position

    def tell(self) -> int:
        """Bytes from the beginning."""
        return self._position

    def check(self) -> None:
        """Raises the error that was kept."""
        if self.error is not None:
            raise self.error

    def close(self) -> None:
        """Closes the file; errors that only show now are kept as well."""
        try:
            self._file.close()
        except OSError as error:
            self.error = self.error or error
