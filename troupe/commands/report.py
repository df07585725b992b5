"""`troupe report`: what came out of a sweep, as one page with tables, plots and pictures."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from player.printable import printable_lines
from troupe.usage import UsageError, told

FORMATS = ("html", "md")


def report(
    folders: Annotated[
        list[Path], typer.Argument(metavar="DIR...", help="Folders that troupe sweep has made.")
    ],
    out: Annotated[
        Path, typer.Option("-o", "--out", metavar="FILE", help="The page to be written.")
    ],
    format_: Annotated[
        str | None,
        typer.Option(
            "--format",
            metavar="html|md",
            help="Markdown has its plots in a folder beside it.",
            show_default="by the file's name",
        ),
    ] = None,
    measure: Annotated[
        list[str] | None,
        typer.Option(
            metavar="COLUMN",
            help="A column to compare runs by. Repeatable.",
            show_default="those that differ",
        ),
    ] = None,
    higher: Annotated[
        list[str] | None,
        typer.Option(
            metavar="COLUMN",
            help="Of this column more is better. Repeatable.",
            show_default="of none",
        ),
    ] = None,
    each: Annotated[
        list[str] | None,
        typer.Option(
            metavar="MODULE:FUNCTION",
            help="A function of a result that adds columns.",
            show_default="none",
        ),
    ] = None,
    title: Annotated[
        str | None, typer.Option(help="The page's title.", show_default="the folder's name")
    ] = None,
    pictures: Annotated[
        bool,
        typer.Option(
            help="Run the best, the median and the worst again for a picture.", show_default=False
        ),
    ] = True,
) -> None:
    """Make a report of a sweep: one file, which needs no network.

    A table per combination (runs, failures, median with its 95 % interval, the worst with its
    seed), plots in which every run is a point, pairs of runs of one seed, failures by reason,
    three runs to look at, and what repeats it all. Exit code 2: bad usage.
    """
    from troupe.report.sweep import contents, write_html, write_markdown  # noqa: PLC0415
    from troupe.sweep.collect import gather  # noqa: PLC0415
    from troupe.sweep.results import Each  # noqa: PLC0415

    try:
        kind = format_ or ("md" if out.suffix == ".md" else "html")
        if kind not in FORMATS:
            raise UsageError(f"--format {kind}: must be html or md")
        if not out.parent.is_dir():
            raise UsageError(f"--out {out}: there is no folder {out.parent}")
        tables = gather(folders, [Each(name, str(Path.cwd())) for name in each or []])
        content = contents(
            tables,
            title=title or folders[0].resolve().name,
            measures=measure or (),
            higher=higher or (),
            pictures=pictures,
        )
        (write_html if kind == "html" else write_markdown)(content, out)
    except UsageError as error:
        print(printable_lines(str(error)), file=sys.stderr)
        raise typer.Exit(2) from None
    except OSError as error:
        print(printable_lines(told(error)), file=sys.stderr)
        raise typer.Exit(2) from None
    print(f"{content['runs']} runs: {out}")
