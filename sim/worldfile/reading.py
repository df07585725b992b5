"""Reads a file that a world names: whole, within a limit, and a regular file only.

A pipe may never end or never begin, a device has no end, and to open some does things.
"""

from __future__ import annotations

import os
import stat
from pathlib import Path
from typing import BinaryIO

_KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}


class NotRead(Exception):
    """Why a file was not read, as the end of a sentence about it: `is a folder, not a file`."""


class NotThere(NotRead):
    """There is no such file."""


def read_regular(path: Path | str, most: int) -> bytes:
    """The bytes of a regular file.

    Raises NotRead for a file that is not there, is none, is larger than `most` bytes, or that
    the system does not give.
    """
    try:
        _check(os.stat(path).st_mode)
        descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK | os.O_NOCTTY)
        with open(descriptor, "rb") as file:
            _check(os.fstat(descriptor).st_mode)  # it may be another by now
            return _within(file, most)
    except FileNotFoundError as error:
        raise NotThere(f"cannot be read: {error.strerror}") from None
    except (OSError, ValueError) as error:
        raise NotRead(f"cannot be read: {getattr(error, 'strerror', None) or error}") from None


def read_stream(path: Path | str, most: int) -> bytes:
    """The bytes of a pipe or device, at its end or after `most` of them; NotRead as above."""
    try:
        with open(path, "rb") as file:
            return _within(file, most)
    except (OSError, ValueError) as error:
        raise NotRead(f"cannot be read: {getattr(error, 'strerror', None) or error}") from None


def is_stream(path: Path | str) -> bool:
    """Whether it is a pipe or a device of characters, such as a terminal: read once, in order."""
    try:
        mode = os.stat(path).st_mode
    except (OSError, ValueError):
        return False
    return stat.S_ISFIFO(mode) or stat.S_ISCHR(mode)


def _within(file: BinaryIO, most: int) -> bytes:
    data = file.read(most + 1)
    if len(data) > most:
        raise NotRead(f"is larger than {most // 1_000_000} MB")
    return data


def _check(mode: int) -> None:
    if not stat.S_ISREG(mode):
        raise NotRead(f"is {_KINDS.get(stat.S_IFMT(mode), 'something else')}, not a file")
