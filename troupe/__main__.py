"""The command `troupe`."""

from __future__ import annotations

import os
import sys

from troupe._packages import ROOT

if sys.path and sys.path[0] in ("", os.getcwd()) and os.getcwd() != str(ROOT):
    # `python -m troupe`: what lies in the current folder must not get in our way
    sys.path.pop(0)


def main() -> None:
    """Run the command line."""
    from troupe.app import app  # noqa: PLC0415

    app(prog_name="troupe")


if __name__ == "__main__":
    main()
