"""The pages of results: a template with the prose, filled from the tables that lie beside the page.

    scripts/pages [NAME ...]

Writes docs/results/NAME.md from scripts/templates/NAME.md.jinja and the tables in docs/results; of
all pages unless some are named. Nothing is run: the scripts that run something write the tables.
"""

from __future__ import annotations

import argparse
import csv
import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import paint_tables
from jinja2 import Environment, FileSystemLoader, StrictUndefined

ROOT = Path(__file__).resolve().parent.parent
TEMPLATES = Path(__file__).resolve().parent / "templates"
RESULTS = ROOT / "docs" / "results"


def names() -> list[str]:
    """The pages that there are."""
    return sorted(path.name.partition(".")[0] for path in TEMPLATES.glob("*.md.jinja"))


def render(name: str, folder: Path = RESULTS) -> str:
    """A page's text, from the tables in a folder; raises jinja2's errors and OSError."""
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
        undefined=StrictUndefined,
        trim_blocks=True,
        autoescape=False,
    )

    def table(which: str) -> str:
        heads, *rows = read(folder / f"{which}.csv")
        return markdown(heads, rows)

    def about(which: str) -> Any:
        return json.loads((folder / which / "about.json").read_text(encoding="utf-8"))

    def paint(which: str, **told: Any) -> str:
        return markdown(*getattr(paint_tables, which)(folder / "paint", **told))

    template = environment.get_template(f"{name}.md.jinja")
    return template.render(table=table, about=about, paint=paint).rstrip() + "\n"


def write(name: str, folder: Path = RESULTS) -> Path:
    """Write a page anew; its file."""
    path = folder / f"{name}.md"
    path.write_text(render(name, folder), encoding="utf-8")
    return path


def markdown(heads: Sequence[object], rows: Iterable[Sequence[object]]) -> str:
    """A table in Markdown, without the end of its last line."""
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)


def read(path: Path) -> list[list[str]]:
    """The lines of a table, its heads first."""
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.reader(file))


def keep(path: Path, heads: Sequence[object], rows: Iterable[Sequence[object]]) -> None:
    """Write a table, aside and renamed: who interrupts this loses nothing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    fresh = path.with_suffix(".tmp")
    with fresh.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([heads, *rows])
    fresh.replace(path)


def keep_about(folder: Path, about: Mapping[str, Any]) -> None:
    """Write what holds for a page's tables as a whole."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "about.json").write_text(json.dumps(about) + "\n", encoding="utf-8")


def main() -> None:
    """Write pages."""
    options = argparse.ArgumentParser(prog="scripts/pages", description=__doc__)
    options.add_argument("names", nargs="*", metavar="NAME", help=", ".join(names()))
    given = options.parse_args()
    if unknown := set(given.names) - set(names()):
        options.error(f"there is no page {min(unknown)}; there are {', '.join(names())}")
    for name in given.names or names():
        print(write(name))


if __name__ == "__main__":
    main()
