"""Running the command line, and looking for the processes that it has left."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

import psutil

ROOT = Path(__file__).resolve().parent.parent


def marked(mark: str) -> list[psutil.Process]:
    """The living processes that have `mark` in their environment."""
    found = []
    for process in psutil.process_iter():
        try:
            if process.status() != psutil.STATUS_ZOMBIE and mark in process.environ().values():
                found.append(process)
        except psutil.Error:
            continue
    return found


def all_gone(mark: str, within: float = 2.0) -> bool:
    """Whether no process with the mark is left after so many seconds at the most."""
    until = time.monotonic() + within
    while time.monotonic() < until:
        if not marked(mark):
            return True
        time.sleep(0.05)
    return not marked(mark)


def troupe_command(*words: str) -> list[str]:
    """The command line, run by this interpreter."""
    return [sys.executable, "-m", "troupe", *words]


def environment(**more: str) -> dict[str, str]:
    """This process's environment with the packages to be tested on the path."""
    return {**os.environ, "PYTHONPATH": str(ROOT), **more}
