"""Which options of a command somebody has written, whatever their values."""

from __future__ import annotations

import typer


def given_options(context: typer.Context, known: set[str]) -> list[str]:
    """The options, as `--seed`, that were given, but for the parameters `known` by name."""
    found = []
    for parameter in context.command.params:
        source = context.get_parameter_source(str(parameter.name))
        if parameter.name not in known and source is not None and source.name == "COMMANDLINE":
            found.append(max(parameter.opts, key=len))
    return found
