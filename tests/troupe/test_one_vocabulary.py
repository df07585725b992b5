"""What is the same in all commands, and all packages, has one name and is found there."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import pytest
import typer

from troupe.app import app


def commands(group: Any, name: str) -> list[tuple[str, Any]]:
    """All commands with their names, those of groups too."""
    if not hasattr(group, "commands"):
        return [(name, group)]
    found = {key: group.get_command(None, key) for key in group.list_commands(None)}
    return [one for key, member in found.items() for one in commands(member, f"{name} {key}")]


def test_where_a_command_writes_is_told_by_out_or_o_everywhere() -> None:
    for name, command in commands(typer.main.get_command(app), "troupe"):
        options = [one.opts for one in command.params if {"out", "output"} & {one.name}]
        for names in options:
            assert {"--out", "-o"} <= set(names), name
    writing = {"troupe sweep", "troupe report", "troupe log export", "troupe log recover"}
    assert writing <= {
        name
        for name, command in commands(typer.main.get_command(app), "troupe")
        if any("-o" in one.opts for one in command.params)
    }


@pytest.mark.parametrize("name", ["troupe", "troupe.testing", "player", "sensors"])
def test_a_package_lists_what_it_has_before_it_is_loaded(name: str) -> None:
    package = import_module(name)
    assert dir(package) == sorted(package.__all__)
    assert all(getattr(package, one) is not None for one in dir(package))
