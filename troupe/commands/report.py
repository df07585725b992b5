"""`troupe report`: what came out of a sweep, or of one run, as one page with plots and pictures."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from player.printable import printable_lines
from troupe.usage import UsageError, told

FORMATS = ("html", "md")
PAGES = ("", ".html", ".htm", ".md")
"""Endings of a page's name: whatever else has a name of another kind is not written over."""


def report(
    folders: Annotated[
        list[Path],
        typer.Argument(
            metavar="DIR...|LOG.mcap",
            help="Folders that troupe sweep has made, or a log that troupe run has written.",
        ),
    ],
    out: Annotated[
        Path, typer.Option("--out", "-o", metavar="FILE", help="The page to be written.")
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
    """Make a report of a sweep, or of the run of a log: one file, which needs no network.

    Of a sweep: a table per combination (runs, failures, median with its 95 % interval, the worst
    with its seed), plots in which every run is a point, pairs of runs of one seed, failures by
    reason, three runs to look at, and what repeats it all.

    Of a run: pictures of its start and its end, what happened when, distances, speeds, contacts,
    coverage, how near robots came, what they reported, and how their controllers ended.

    Exit code 2: bad usage, or no log.
    """
    if len(folders) == 1 and (folders[0].suffix.lower() == ".mcap" or folders[0].is_file()):
        of_sweeps = {
            "--format": format_ not in (None, "html"), "--measure": measure, "--higher": higher,
            "--each": each, "--title": title, "--no-pictures": not pictures,
        }  # fmt: skip
        of_log(folders[0], out, [name for name, given in of_sweeps.items() if given])
        return
    from troupe.report.sweep import contents, write_html, write_markdown  # noqa: PLC0415
    from troupe.sweep.collect import gather  # noqa: PLC0415
    from troupe.sweep.results import Each  # noqa: PLC0415

    try:
        kind = format_ or ("md" if out.suffix == ".md" else "html")
        if kind not in FORMATS:
            raise UsageError(f"--format {kind}: must be html or md")
        if format_ is None and out.suffix.lower() not in PAGES:
            raise UsageError(f"--out {out}: a report is a page: name it *.html or *.md")
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


def of_log(log: Path, out: Path, given: list[str]) -> None:
    """Make the report of a log. `given`: options that only a sweep's report can have."""
    from sim.log.errors import LogError  # noqa: PLC0415 - `troupe --help` stays quick
    from troupe.log import Log  # noqa: PLC0415
    from troupe.report.log import check_page, write_report  # noqa: PLC0415

    try:
        if given:
            raise UsageError(f"{given[0]}: {log} is the log of one run, and no sweep")
        check_page(out)
        write_report(Log(log), out)
    except (UsageError, LogError) as error:
        print(printable_lines(str(error)), file=sys.stderr)
        raise typer.Exit(2) from None
    except OSError as error:
        print(printable_lines(told(error)), file=sys.stderr)
        raise typer.Exit(2) from None
    print(printable_lines(f"report: {out}"))
