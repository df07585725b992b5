"""All commands of `troupe`, put together."""

from __future__ import annotations

from typing import Annotated

import typer

from troupe import __version__
from troupe.commands.check import check
from troupe.commands.devices import devices
from troupe.commands.disperse import disperse
from troupe.commands.import_ import import_
from troupe.commands.log import log
from troupe.commands.print_ import print_
from troupe.commands.render import render
from troupe.commands.report import report
from troupe.commands.run import run
from troupe.commands.schema import schema
from troupe.commands.sensors import sensors
from troupe.commands.sweep import sweep
from troupe.commands.view import view
from troupe.commands.warm import warm
from troupe.commands.worlds import worlds
from troupe.view_option import ViewCommand

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


app.command("run", cls=ViewCommand)(run)
app.command("view")(view)
app.command("sweep")(sweep)
app.command("render")(render)
app.command("report")(report)
app.command("worlds")(worlds)
app.command("check")(check)
app.command("schema")(schema)
app.command("sensors")(sensors)
app.add_typer(log, name="log")
app.command("disperse")(disperse)
app.command("devices")(devices)
app.command("print")(print_)
app.command("import")(import_)
app.command("warm")(warm)
