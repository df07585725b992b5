"""Commands for tests whose claim is what a command does, not how its process begins.

A new process of `troupe` loads modules for half a second. One that is forked from a process that
has loaded them has all else of its own: arguments, folder, environment, standard files, signals,
exit code, processes.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from tests.patience import PATIENCE
from tests.processes import ROOT, environment
from tests.started import client
from tests.started.client import Started


@cache
def server() -> str:
    """The socket of the server: the first who asks starts it, and it ends with this process."""
    folder = tempfile.mkdtemp(prefix="troupe-tests-")
    path = os.path.join(folder, "socket")
    ready = subprocess.Popen(
        [sys.executable, "-m", "tests.started.server", path],
        cwd=ROOT, env=environment(OPENBLAS_NUM_THREADS="1"), stdin=-1, stdout=-1,
    )  # fmt: skip
    assert ready.stdout is not None
    assert ready.stdout.readline() == b"ready\n"
    _kept.append(ready)
    return path


_kept: list[subprocess.Popen[bytes]] = []
"""The server: it ends when its standard input does."""


def troupe(
    *words: str | Path, cwd: Path | None = None, program: Path | None = None, **variables: str
) -> subprocess.CompletedProcess[str]:
    """Run `troupe WORDS`, or a program with these words, to its end."""
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        with open(os.devnull) as nothing:
            files = (nothing.fileno(), out.fileno(), err.fileno())
            started = Started(
                server(), [str(word) for word in words], str(cwd or Path.cwd()),
                environment(**variables), files, None if program is None else str(program),
            )  # fmt: skip
        code = started.wait(PATIENCE)
        for file in (out, err):
            file.seek(0)
        return subprocess.CompletedProcess(words, code, out.read(), err.read())


def command() -> list[str]:
    """What a shell calls instead of `troupe`."""
    return [sys.executable, "-I", "-S", client.__file__, server()]


def executable(folder: Path) -> Path:
    """A program `troupe` in a folder, for a shell's search path."""
    path = folder / "troupe"
    words: Sequence[str] = command()
    path.write_text(f'#!/bin/sh\nexec {" ".join(words)} "$@"\n')
    path.chmod(0o755)
    return path
