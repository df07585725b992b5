"""`troupe examples`: the examples that come with Troupe, and copies of them."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Annotated

import typer

from troupe.usage import UsageError, told


def examples(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="[NAME]",
            help="One of them, by its name or number: tell how it is run.",
            show_default="all",
        ),
    ] = None,
    copy: Annotated[
        Path | None,
        typer.Option(
            "--copy",
            metavar="DIR",
            help="Copy it into this folder, to run it and change it; all of them without a name, "
            "each into a folder of its own there.",
            show_default="nothing is copied",
        ),
    ] = None,
) -> None:
    """List the examples that come with Troupe, a line each; copy one to run it and change it.

    Each is a world file and a few lines of Python. Exit code 2 if there is no such example, or if
    a file would be overwritten.
    """
    from player.printable import printable  # noqa: PLC0415 - `--help` stays quick
    from troupe import examples as shipped  # noqa: PLC0415

    try:
        if name is None:
            chosen = shipped.examples()
            targets = [] if copy is None else [(one, copy / one.name) for one in chosen]
        else:
            chosen = [shipped.find_example(name)]
            targets = [] if copy is None else [(chosen[0], copy)]
        made = shipped.copy_examples(targets)
    except UsageError as error:
        print(printable(str(error)), file=sys.stderr)
        raise typer.Exit(2) from None
    except OSError as error:
        print(printable(told(error)), file=sys.stderr)
        raise typer.Exit(2) from None
    if name is None:
        width = max((len(one.name) for one in chosen), default=0)
        for one in chosen:
            print(f"{one.name:{width}}  {one.summary}")
        if made:
            print(f"\ncopied to {printable(str(copy))}")
        else:
            print("\ncopy one to run it and change it: troupe examples NAME --copy DIR")
        return
    if not made:
        print(f"{chosen[0].name}\n\n{chosen[0].docstring}\n")
        print("files:", *(file.name for file in chosen[0].files))
        print(f"copy it to run it: troupe examples {chosen[0].name} --copy DIR")
        return
    print(f"copied: {', '.join(file.name for file in made)}\n\nrun it:")
    print(f"    cd {printable(shlex.quote(str(copy)))}")
    for command in chosen[0].commands:
        print(f"    {command}")
