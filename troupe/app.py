"""All commands of `troupe`, put together."""

from __future__ import annotations

from importlib import import_module
from typing import Annotated, Any

import typer
from typer.core import TyperGroup
from typer.main import get_command, get_group

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

MODULES = {module.rstrip("_"): module for module in COMMANDS}
"""The commands' modules by the commands' names."""

SETTINGS: dict[str, Any] = {"add_completion": False, "pretty_exceptions_enable": False}


class Commands(TyperGroup):
    """The commands, each loaded when it is asked for: who wants one waits for no other."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        names: Any = dict.fromkeys(MODULES)  # close ones are suggested
        self.commands = names

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """The command of a name; None if there is none."""
        if cmd_name in MODULES and self.commands[cmd_name] is None:
            self.commands[cmd_name] = load(cmd_name)
        return self.commands.get(cmd_name)


def load(name: str) -> Any:
    """The command, or the group of commands, of a name, from its module in `troupe.commands`."""
    module = MODULES[name]
    found = getattr(import_module(f"troupe.commands.{module}"), module)
    if isinstance(found, typer.Typer):
        group: Any = get_group(found)
        group.name = name
        return group
    alone = typer.Typer(**SETTINGS)
    alone.command(name, cls=Command)(found)
    return get_command(alone)


app = typer.Typer(
    cls=Commands,
    help="A 2D physics simulator for teams of mobile robots that speaks Player's protocol.",
    no_args_is_help=True,
    **SETTINGS,
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
