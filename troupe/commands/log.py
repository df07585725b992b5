"""`troupe log`: what is in a log, tables of it, the run again, and whole logs of broken ones."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from player.printable import printable
from troupe.usage import UsageError, told

log = typer.Typer(
    help="Look into logs that `troupe run --log` wrote.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)
File = Annotated[Path, typer.Argument(metavar="LOG.mcap", help="A log.", show_default=False)]


def carried_out(what: Callable[[], int]) -> None:
    """Exit with what a command returns; mistakes are told on standard error, exit code 2."""
    from sim.log.errors import LogError  # noqa: PLC0415 - `troupe --help` stays quick

    try:
        code = what()
    except (LogError, UsageError) as error:
        print("\n".join(map(printable, str(error).splitlines())), file=sys.stderr)
        code = 2
    except OSError as error:
        print(printable(told(error)), file=sys.stderr)
        code = 2
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        code = 130
    raise typer.Exit(code)


@log.command("info")
def info(path: File) -> None:
    """Tell what is in a log: what ran, how it ended, who was in it, what is kept of it."""

    def tell() -> int:
        from troupe.log_info import described  # noqa: PLC0415

        for line in described(path):
            print(printable(line))
        return 0

    carried_out(tell)


@log.command("export")
def export(
    path: File,
    output: Annotated[
        Path,
        typer.Option("--out", "--output", "-o", metavar="FILE.parquet|.csv", help="Where it goes."),
    ],
    table: Annotated[
        str, typer.Option(help="poses, commands, scans (of --log-sensors) or events.")
    ] = "poses",
    start: Annotated[
        float | None, typer.Option("--from", metavar="T", help="From this simulated second on.")
    ] = None,
    until: Annotated[
        float | None, typer.Option("--until", metavar="T", help="Before this simulated second.")
    ] = None,
) -> None:
    """Write a table of a log, for spreadsheets and data frames."""

    def write() -> int:
        from troupe.log import Log  # noqa: PLC0415
        from troupe.tables import export as export_table  # noqa: PLC0415

        if start is not None and until is not None and until <= start:
            raise UsageError(f"--until {until:g}: must be later than --from {start:g}")
        rows = export_table(Log(path)[start:until], table, output)
        print(printable(f"{output}: {rows} rows of {table}"), file=sys.stderr)
        return 0

    carried_out(write)


@log.command("check")
def check(path: File) -> None:
    """Run the world of a log again and say whether every pose of every tick is the same.

    Bodies are moved by the commands that the log holds; no program is started. Exit code 0:
    equal; 1: not, and where first.
    """

    def compare() -> int:
        from sim.log.replay import check as run_again  # noqa: PLC0415
        from troupe.log import Log  # noqa: PLC0415

        kept = Log(path)
        told_digest = None if kept.result is None else kept.result["digest"]
        verdict = run_again(kept._reader, told_digest)
        if verdict.equal:
            print(f"equal: {verdict.ticks} ticks, {verdict.digest}")
            return 0
        if verdict.tick is None:
            print(f"the poses are equal, but the log tells another digest: {verdict.told_digest}")
            return 1
        x, y, yaw = verdict.difference
        when = f"tick {verdict.tick} ({verdict.tick * kept.interval:g} s)"
        where = "where it starts" if verdict.tick == 0 else when
        print(
            printable(
                f"not equal: first {verdict.who} at {where}: "
                f"off by {x:.3g} m, {y:.3g} m, {yaw:.3g} rad"
            )
        )
        return 1

    carried_out(compare)


@log.command("recover")
def recover(
    path: File,
    output: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "--output",
            "-o",
            metavar="FILE.mcap",
            help="Default: NAME-recovered.mcap beside it.",
        ),
    ] = None,
) -> None:
    """Make a whole log of one that was cut off or is damaged: all that can be read of it."""

    def save() -> int:
        from sim.log.recover import recover as save_log  # noqa: PLC0415

        target = output or path.with_name(f"{path.stem}-recovered.mcap")
        saved = save_log(path, target)
        more = f"; {saved.lost} bytes were damaged" if saved.lost else ""
        print(printable(f"{target}: {saved.messages} messages up to {saved.until:.1f} s{more}"))
        return 0

    carried_out(save)
