"""Running the command line, and looking for the processes that it has left."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

import psutil

from tests.patience import PATIENCE

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


def all_gone(mark: str) -> bool:
    """Whether the processes with the mark end, each by itself, without the test's doing.

    On an idle machine that takes well below the 2 s that are promised.
    """
    until = time.monotonic() + PATIENCE
    while marked(mark) and time.monotonic() < until:
        time.sleep(0.05)
    return not marked(mark)


def troupe_command(*words: str) -> list[str]:
    """The command line, run by this interpreter."""
    return [sys.executable, "-m", "troupe", *words]


def environment(**more: str) -> dict[str, str]:
    """This process's environment with the packages to be tested on the path."""
    return {**os.environ, "PYTHONPATH": str(ROOT), **more}
