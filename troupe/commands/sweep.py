"""`troupe sweep`: run worlds with many settings and seeds into a folder; `collect` its tables."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from player.printable import printable_lines
from sim.interrupts import Interrupts
from troupe.given_options import given_options
from troupe.interrupts import EXIT_CODE, leave
from troupe.usage import UsageError, told

if TYPE_CHECKING:
    from troupe.sweep.plan import Plan
    from troupe.sweep.session import How, Session


def sweep(
    context: typer.Context,
    worlds: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="WORLD...|FILE.py:FUNCTION|SWEEP.yaml|collect DIR...",
            help="World files, names of Troupe's, functions of parameters and a seed (also "
            "MODULE:FUNCTION), or a file that describes a sweep.",
            show_default="those of --table",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", "-o", metavar="DIR", help="The sweep's folder.", show_default="required"
        ),
    ] = None,
    seeds: Annotated[
        str | None,
        typer.Option(
            metavar="FIRST:END", help="0:100 is 0 to 99; also 1,2,5.", show_default="the world's"
        ),
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=V1,V2",
            help="Values of a setting; several settings are multiplied. May be repeated.",
            show_default="no change",
        ),
    ] = None,
    table: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.csv",
            help="Rows of settings instead; columns `world` and `seed` too.",
            show_default="none",
        ),
    ] = None,
    duration: Annotated[
        float | None,
        typer.Option(
            "--duration",
            "--sim-timeout",
            help="Simulated seconds of a run at most.",
            show_default="the world's",
        ),
    ] = None,
    timeout: Annotated[
        float | None,
        typer.Option(help="Wall-clock seconds of a run at most.", show_default="none"),
    ] = None,
    jobs: Annotated[
        int | None, typer.Option(help="Runs at a time.", show_default="as many as cores")
    ] = None,
    shard: Annotated[
        str | None,
        typer.Option(metavar="I/N", help="Part I of N: every N-th run.", show_default="all runs"),
    ] = None,
    dask: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Run on the workers of a dask scheduler.",
            show_default="on this machine",
        ),
    ] = None,
    retry_failed: Annotated[
        bool, typer.Option("--retry-failed", help="Run again what failed, crashed or timed out.")
    ] = False,
    each: Annotated[
        list[str] | None,
        typer.Option(
            metavar="MODULE:FUNCTION",
            help="A function of a result that adds columns. Repeatable.",
            show_default="none",
        ),
    ] = None,
    judge: Annotated[
        list[str] | None,
        typer.Option(
            metavar="MODULE:FUNCTION",
            help="A function of a run's true poses that adds columns. Repeatable.",
            show_default="none",
        ),
    ] = None,
    video_of: Annotated[
        str | None,
        typer.Option(
            metavar="failed|first|N",
            help="Make videos of these runs, in DIR/videos.",
            show_default="of none",
        ),
    ] = None,
    log_of: Annotated[
        str | None,
        typer.Option(
            metavar="failed|first|N",
            help="Keep logs of these runs, in DIR/logs.",
            show_default="of none",
        ),
    ] = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="No progress.")] = False,
) -> None:
    """Run every combination of worlds, settings and seeds that the folder lacks.

    Stopped at any moment, the same command goes on. `troupe sweep collect DIR... [--out DIR]`
    makes the tables of one or several folders. Exit code 0: all runs are there (failures are rows
    of the table); 1: some are missing; 2: bad usage or a mistake in any combination; 130:
    interrupted.
    """
    from troupe.sweep.options import how_of  # noqa: PLC0415
    from troupe.sweep.pool import Broken  # noqa: PLC0415 - `troupe --help` stays quick
    from troupe.sweep.session import Changed  # noqa: PLC0415

    code = 2
    try:
        named = worlds or []
        if named[:1] == ["collect"]:
            for option in given_options(context, {"worlds", "out", "each"}):
                raise UsageError(f"{option}: means nothing to `troupe sweep collect`")
            code = collect(named[1:], out, each or [])
        else:
            mistakes = ["--out: name the sweep's folder, as --out results"] * (out is None)
            how = how_of(jobs, shard, timeout, retry_failed, dask, quiet, mistakes)
            again = {"video": video_of, "log": log_of}
            asked = (named, seeds, set_, table, duration, each, judge, again)
            code = run_sweep(*asked, out or Path(), how, mistakes)
    except UsageError as error:
        tell(str(error))
    except Changed as error:
        tell(f"{error} since the sweep began; run it again")
        code = 1
    except Broken as error:
        tell(f"no worker's process can be started; the last one said:\n{error}")
        code = 1
    except OSError as error:
        tell(told(error))
        code = 1
    raise typer.Exit(code)


def tell(text: str) -> None:
    if text:
        print(printable_lines(text), file=sys.stderr)


def run_sweep(
    worlds: list[str],
    seeds: str | None,
    settings: list[str] | None,
    table: Path | None,
    duration: float | None,
    each: list[str] | None,
    judge: list[str] | None,
    again: Mapping[str, str | None],
    out: Path,
    how: How,
    mistakes: list[str],
) -> int:
    """Plan, run, collect, make videos and logs; the exit code. `mistakes`: those so far."""
    from troupe.sweep.asked import asked_plan  # noqa: PLC0415
    from troupe.sweep.recordings import chosen, record_again  # noqa: PLC0415
    from troupe.sweep.session import sweep as carry_out  # noqa: PLC0415
    from troupe.sweep.versions import versions  # noqa: PLC0415
    from troupe.warm import tell as say  # noqa: PLC0415
    from troupe.warm import warm_once  # noqa: PLC0415

    recorded = {kind: which for kind, which in again.items() if which is not None}
    warm_once(say)
    plan = asked_plan(
        worlds,
        seeds=seeds,
        settings=settings or [],
        table=table,
        duration=duration,
        each=each or [],
        judge=judge or [],
        recorded=recorded,
        about={
            "command": shlex.join(["troupe", *sys.argv[1:]]),
            "folder": str(Path.cwd()),
            "versions": versions(),
        },
        mistakes=mistakes,
    )
    interrupts = Interrupts(again=leave)
    interrupts.hold()
    stopped = lambda: interrupts.noted  # noqa: E731 - asked for by several
    try:
        session = carry_out(plan, out, how, stopped)
        if not interrupts.noted and how.shard == (1, 1):
            finish(out)
        for kind, which in recorded.items():
            if not interrupts.noted:
                runs = chosen(plan, out, kind, which)
                made, failed = record_again(kind, runs, out, how.jobs, how.timeout, stopped)
                print(f"{len(made)} {kind}s are in {out / f'{kind}s'}")
                tell("\n".join(failed))
    finally:
        interrupts.release()
    print(summary(session, plan, out))
    if interrupts.noted:
        tell("interrupted; the same command goes on where this one ended")
        return EXIT_CODE
    return 0 if session.missing == 0 else 1


def finish(out: Path) -> None:
    """Make the tables of a sweep's folder."""
    from troupe.sweep.collect import gather, write_tables  # noqa: PLC0415

    write_tables(gather([out]), out)


def summary(session: Session, plan: Plan, out: Path) -> str:
    """What the command prints in the end."""
    number = session.ran.total()
    there = session.known + session.ran
    failed = sum(count for outcome, count in there.items() if outcome != "completed")
    lines = [
        f"{many(session.asked, 'run')} of {many(len(plan.points), 'combination')}: {number} run "
        f"now, {session.known.total()} were there, {session.missing} are missing"
    ]
    if failed:
        kinds = sorted((o, n) for o, n in there.items() if o != "completed")
        lines.append("not completed: " + ", ".join(f"{n} {o}" for o, n in kinds))
    if session.missing == 0:
        lines.append(f"next: troupe report {shlex.quote(str(out))} -o report.html")
    return "\n".join(lines)


def many(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


def collect(folders: list[str], out: Path | None, each: list[str]) -> int:
    """`troupe sweep collect DIR...`: the exit code."""
    from troupe.sweep.collect import gather, write_tables  # noqa: PLC0415
    from troupe.sweep.results import Each  # noqa: PLC0415

    if not folders:
        raise UsageError("collect: name one or several folders of sweeps")
    if out is None and len(folders) > 1:
        raise UsageError("--out: name a folder for the tables of several sweeps")
    paths = [Path(one) for one in folders]
    tables = gather(paths, [Each(name, str(Path.cwd())) for name in each])
    made = write_tables(tables, paths[0] if out is None else out)
    missing = f", {tables.missing} are missing" if tables.missing else ""
    print(f"{len(tables.results)} runs{missing}: {', '.join(str(path) for path in made)}")
    return 1 if tables.missing else 0
