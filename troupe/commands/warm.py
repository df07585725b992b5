"""`troupe warm`: compile all kernels now, once for this machine."""

from __future__ import annotations

import typer

from troupe.warm import NOT_KEPT, tell, warm_once


def warm() -> None:
    """Compile every kernel now, and keep the machine code, so that no run has to wait for it.

    The first command that computes something does it otherwise. Exit code 1 where nothing can be
    kept.
    """
    folder = warm_once(tell)
    if folder is None:
        tell(NOT_KEPT)
        raise typer.Exit(1)
    print(f"all kernels are compiled, and kept in {folder}")
