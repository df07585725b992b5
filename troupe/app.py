"""All commands of `troupe`, put together."""

from __future__ import annotations

from importlib import import_module
from typing import Annotated

import typer

from troupe import __version__
from troupe.optional_values import Command

COMMANDS = (
    "run",
    "view",
    "sweep",
    "render",
    "report",
    "worlds",
    "examples",
    "check",
    "schema",
    "sensors",
    "log",
    "disperse",
    "devices",
    "print_",
    "import_",
    "warm",
)
"""The commands in the order of `troupe --help`: each is the function, or the group of commands, of
that name in the module of that name in `troupe/commands`. A new one is a file there and its line
above. Where Python has a word for itself a `_` stands behind it."""

app = typer.Typer(
    help="A 2D physics simulator for teams of mobile robots that speaks Player's protocol.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


def show_version(wanted: bool) -> None:
    if wanted:
        print(f"troupe {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=show_version, is_eager=True, help="Show it.")
    ] = False,
) -> None:
    """What every command has in common."""


def add(module: str) -> None:
    """Add the command of a module of `troupe.commands`."""
    found = getattr(import_module(f"troupe.commands.{module}"), module)
    name = module.rstrip("_")
    if isinstance(found, typer.Typer):
        app.add_typer(found, name=name)
    else:
        app.command(name, cls=Command)(found)


for _module in COMMANDS:
    add(_module)
