"""From a world's controllers to what is run: programs, commands, their options and environment."""

from __future__ import annotations

import os
import zlib
from collections.abc import Mapping
from pathlib import Path

from sim.fleet.driver import Kind
from sim.fleet.fleet import Launch
from sim.worldfile.options import options
from sim.worldfile.schema import Controller


def kind_of(name: str | None, controllers: Mapping[str, Controller]) -> Kind:
    """How a robot with `controller: name` is driven."""
    if name is None:
        return "none"
    controller = controllers.get(name)
    if controller is None or controller.program is not None:
        return "program"
    return "command" if controller.command is not None else "external"


def launch_of(
    name: str,
    controllers: Mapping[str, Controller],
    folder: Path,
    fields: Mapping[str, str],
) -> Launch:
    """What to run for `controller: name`; `fields` fills {port}, {host}, ... in a command.

    A program that ends in `.py` is a file relative to the world's folder; any other is one of
    the modules in `controllers`.
    """
    controller = controllers.get(name, Controller(program=name))
    extra = tuple(options(controller.args))
    if controller.program is not None:
        if controller.program.endswith(".py"):
            path = (folder / controller.program).resolve()
            return Launch("script", str(path), extra, str(folder.resolve()))
        return Launch("module", f"controllers.{controller.program}", extra)
    assert controller.command is not None
    target, *argv = (fill(word, fields) for word in controller.command)
    if "/" in target:
        target = os.path.abspath(folder / target)  # a link stays one: so a virtual environment is
    return Launch("exec", target, (*argv, *extra))


def fill(word: str, fields: Mapping[str, str]) -> str:
    """`{port}` and the like replaced; other braces stay as they are."""
    for key, value in fields.items():
        word = word.replace("{" + key + "}", value)
    return word


def robot_seed(seed: int, name: str) -> int:
    """The seed of one robot's controller: from the run's seed and the robot's name alone."""
    return (seed * 0x9E3779B97F4A7C15 + zlib.crc32(name.encode())) % (1 << 63)


def environment(
    name: str, seed: int, host: str, port: int | None, number: int | None = None
) -> dict[str, str]:
    """The variables by which a client finds its robot and its seed.

    `number` is the robot's place in the order of entry, counted from 1 over the whole world.
    """
    variables = {
        "PLAYER_ROBOT": name,
        "PLAYER_INDEX": "0",
        "PLAYER_SEED": str(robot_seed(seed, name)),
        "TROUPE_SEED": str(seed),
    }
    if number is not None:
        variables["TROUPE_NUMBER"] = str(number)
    if port is not None:
        variables |= {"PLAYER_HOST": host, "PLAYER_PORT": str(port)}
    return variables
