"""What a world file names: models, controllers and their programs, doors and regions."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from sim.worldfile.mistakes import Mistake, listed, suggestion
from sim.worldfile.programs import find_program, is_file_name, programs
from sim.worldfile.schema import Controller
from sim.worldfile.syntax import program_mistakes
from sim.worldfile.valid_part import ValidPart


def reference_mistakes(data: Mapping[str, Any], found: ValidPart, folder: Path) -> list[Mistake]:
    """Names of models, controllers and files in a valid part of a world that lead nowhere."""
    world = found.world
    assert world is not None
    models, controllers = _names(data, "models"), _names(data, "controllers")
    mistakes: list[Mistake] = []
    sound: set[str] = set(controllers)  # a thousand robots often share a program
    for where, entry in _entries(data):
        model, controller = entry.get("model"), entry.get("controller")
        if isinstance(model, str) and model not in models:
            allowed = listed(models) if models else "nothing: there are no models"
            hint = suggestion(model, models)
            mistakes.append(
                Mistake((*where, "model"), f"there is no such model{hint}", model, allowed)
            )
        if isinstance(controller, str) and controller not in sound:
            wrong = _named_program(controller, (*where, "controller"), controllers)
            mistakes += wrong
            if not wrong:
                sound.add(controller)
    for name, controller in world.controllers.items():
        mistakes += _controller_mistakes(controller, ("controllers", name), folder)
    return mistakes


def _entries(data: Mapping[str, Any]) -> Iterator[tuple[tuple[str, int], Mapping[str, Any]]]:
    """Robots and doors as they stand in the file, those with other mistakes too."""
    for part in ("robots", "doors"):
        inside = data.get(part)
        for index, entry in enumerate(inside if isinstance(inside, (list, tuple)) else ()):
            if isinstance(entry, Mapping):
                yield (part, index), entry


def _names(data: Mapping[str, Any], part: str) -> list[str]:
    """The names under `models` or `controllers`, those of broken entries too."""
    inside = data.get(part)
    return [str(name) for name in inside] if isinstance(inside, Mapping) else []


def _named_program(name: str, where: tuple[str | int, ...], named: Iterable[str]) -> list[Mistake]:
    """A controller without an entry: one of Troupe's by that name, or a mistake."""
    if is_file_name(name):
        return [
            Mistake(
                where,
                "a file is named under `controllers`, and here its entry",
                name,
                f"controllers: {{mine: {{program: {name}}}}}",
            )
        ]
    if find_program(name) is not None:
        return []
    known = [*named, *programs()]
    return [
        Mistake(where, f"there is no such controller{suggestion(name, known)}", name, listed(known))
    ]


def _controller_mistakes(
    controller: Controller, where: tuple[str | int, ...], folder: Path
) -> list[Mistake]:
    if controller.program is not None:
        return _program_mistakes(controller.program, (*where, "program"), folder)
    if controller.command is not None:
        return _command_mistakes(controller.command[0], (*where, "command", 0), folder)
    return []


def _program_mistakes(program: str, where: tuple[str | int, ...], folder: Path) -> list[Mistake]:
    if is_file_name(program):
        if not program.endswith(".py") and not os.path.isdir(folder / program):
            beside = f"{program}.py"
            hint = f"; did you mean {beside}?" if os.path.isfile(folder / beside) else ""
            allowed = (
                f"a Python file such as ./mine.py; other programs are a `command: [{program}]`"
            )
            return [Mistake(where, f"has not a name that ends in .py{hint}", program, allowed)]
        return program_mistakes(folder / program, where, program)
    if find_program(program) is not None:
        return []
    known = programs()
    hint = suggestion(program, known)
    if not hint and os.path.isfile(folder / f"{program}.py"):
        hint = f"; did you mean ./{program}.py?"
    allowed = f"{listed(known)}, or a Python file such as ./mine.py"
    return [Mistake(where, f"there is no such program{hint}", program, allowed)]


def _command_mistakes(executable: str, where: tuple[str | int, ...], folder: Path) -> list[Mistake]:
    if "/" not in executable:
        if not executable or shutil.which(executable) is None:
            beside = (
                "; did you mean ./" + executable + "?"
                if os.path.isfile(folder / executable)
                else ""
            )
            return [Mistake(where, f"no such command is found on PATH{beside}", executable)]
        return []
    path = folder / executable
    if not os.path.isfile(path):
        return [
            Mistake(where, "there is no such file", executable, f"an executable, from {folder}")
        ]
    if not os.access(path, os.X_OK):
        return [Mistake(where, "the file is not executable", executable, f"chmod +x {path}")]
    return []
