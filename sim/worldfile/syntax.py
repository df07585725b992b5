"""Whether a file is a program in Python: compiled, not run."""

from __future__ import annotations

import os
import warnings
from pathlib import Path

from sim.worldfile.mistakes import Mistake
from sim.worldfile.programs import LARGEST_PROGRAM
from sim.worldfile.reading import NotRead, read_regular

Where = tuple[str | int, ...]


def program_mistakes(path: Path, where: Where, program: str) -> list[Mistake]:
    """What keeps the file at `path`, in the world called `program`, from being run, or nothing."""
    if os.path.isdir(path):
        return [Mistake(where, "is a folder, not a Python file", program)]
    if not os.path.lexists(path):
        return [Mistake(where, "there is no such file", program, f"a file, from {path.parent}")]
    try:
        source = read_regular(path, LARGEST_PROGRAM)
    except NotRead as error:
        return [Mistake(where, f"the file {error}", program)]
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of escapes that are none, say: it runs all the same
            compile(source, str(path), "exec", dont_inherit=True)
    except SyntaxError as error:
        line = error.lineno or None
        column = None if line is None else error.offset or None
        kind = type(error).__name__
        return [Mistake(where, f"{kind}: {error.msg}", None, None, str(path), line, column)]
    except (ValueError, OverflowError, RecursionError, MemoryError) as error:
        what = f"is no Python: {error or 'nested too deeply'}"
        return [Mistake(where, what, None, None, str(path))]
    return []
