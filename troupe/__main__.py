"""The command `troupe`."""

from __future__ import annotations

import gc
import os
import sys

from troupe._packages import ROOT
from troupe.interrupts import all_done, heed_interrupts

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # nothing here multiplies large matrices
heed_interrupts()  # as the package does, where it knows that it is loaded for the command
if sys.path and sys.path[0] in ("", os.getcwd()) and os.getcwd() != str(ROOT):
    # `python -m troupe`: what lies in the current folder must not get in our way
    sys.path.pop(0)


def main() -> None:
    """Run the command line."""
    from troupe.leaving import end_process, nobody_waits  # noqa: PLC0415
    from troupe.streams import prepare_streams  # noqa: PLC0415

    # What is loaded lives to the end: there is nothing to be found in it.
    gc.set_threshold(200_000, 10, 10)
    prepare_streams()
    try:
        run()
    except SystemExit as end:
        if nobody_waits() and (end.code is None or isinstance(end.code, int)):
            end_process(end.code or 0)
        raise


def run() -> None:
    """Run the command line; raises SystemExit."""
    from troupe.app import app  # noqa: PLC0415
    from troupe.streams import OutputLost, ReaderGone  # noqa: PLC0415

    try:
        try:
            app(prog_name="troupe")
        finally:
            sys.stdout.flush()
            all_done()
    except ReaderGone:
        sys.exit(0)
    except OutputLost as error:
        print(f"standard output: {error}", file=sys.stderr)
        sys.exit(1)


if __name__ == "__main__":
    main()
