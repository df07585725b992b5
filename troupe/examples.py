"""The examples that come with Troupe: what each shows, and copies of them to work with.

An example is a folder `NN_name` with a program `name.py`, whose docstring says in its first
paragraph what it shows and in its indented lines how it is run.
"""

from __future__ import annotations

import ast
import os
import shutil
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from sim.worldfile.mistakes import suggestion
from troupe.usage import UsageError

ENDINGS = (".py", ".yaml", ".txt")
"""What belongs to an example: not what its runs leave behind."""


@dataclass(frozen=True)
class Example:
    """One example: its folder, and what its program says of it."""

    folder: Path
    docstring: str

    @property
    def name(self) -> str:
        """Its number and name, such as `01_wander`."""
        return self.folder.name

    @property
    def summary(self) -> str:
        """What it shows, in a line."""
        return " ".join(self.docstring.split("\n\n")[0].split())

    @property
    def commands(self) -> list[str]:
        """How it is run, in its own folder."""
        lines = self.docstring.splitlines()
        return [line.strip() for line in lines if line.startswith("    ")]

    @property
    def files(self) -> list[Path]:
        """Its files, sorted."""
        return sorted(path for path in self.folder.iterdir() if path.suffix in ENDINGS)


def examples_folder() -> Path | None:
    """Where the examples are: inside the installed package; in a checkout, beside the packages."""
    package = Path(__file__).resolve().parent
    for folder in (package / "examples", package.parent / "examples"):
        if folder.is_dir():
            return folder
    return None


def examples() -> list[Example]:
    """The examples that come with Troupe, in their order."""
    root = examples_folder()
    found = []
    for folder in sorted(root.iterdir()) if root is not None else []:
        program = folder / f"{folder.name.partition('_')[2]}.py"
        if program.is_file():
            doc = ast.get_docstring(ast.parse(program.read_text(encoding="utf-8"))) or ""
            found.append(Example(folder, doc))
    return found


def find_example(name: str) -> Example:
    """The example of that name, with or without its number, or of that number alone.

    Raises UsageError where there is none.
    """
    known = {one.name: one for one in examples()}
    known |= {one.name.partition("_")[2]: one for one in known.values()}
    if name in known:
        return known[name]
    for example in known.values():
        if name.rjust(2, "0") == example.name.partition("_")[0]:
            return example
    near = suggestion(name, known)
    raise UsageError(f"there is no example {name!r}{near} (`troupe examples` lists them)")


def copy_examples(chosen: Iterable[tuple[Example, Path]]) -> list[Path]:
    """Copy examples, each into its folder, which is made if need be; the files that were made.

    Raises UsageError, before anything is copied, if a file would be overwritten.
    """
    copies = [(file, folder / file.name) for example, folder in chosen for file in example.files]
    for _, target in copies:
        if target.parent.exists() and not target.parent.is_dir():
            raise UsageError(f"{target.parent}: is not a folder; nothing was copied")
        if os.path.lexists(target):
            raise UsageError(f"{target}: is there already; nothing was copied")
    for file, target in copies:
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(file, target)
    return [target for _, target in copies]
