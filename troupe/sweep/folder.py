"""A sweep's folder, which survives being left at any moment.

    manifest.json                    that this is such a folder
    plans/HASH.json                  what was asked for, a file for each different sweep
    runs/HASH-sSEED/result.json      a run's record, one line
    batches/*.jsonl, *.part          records line by line, where a sweep has 10^4 runs or more
    results.csv, timings.csv, ...    made of the others by `collect`

Every file is written aside and renamed, but for a batch, which is only appended to: of it every
line that is whole counts. A run is done when there is a whole record of its name.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import platform
import secrets
import time
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, BinaryIO

from troupe.sweep.lines import Line, better, line_of, read_line
from troupe.sweep.plan import Plan, plan_of_json
from troupe.usage import UsageError, told

MANY = 10_000
"""Runs of a sweep from which on they have no folders of their own."""

SEALED_AFTER = 10_000
"""Lines of a batch."""

FLUSH = 1.0
"""Wall-clock seconds that a record may wait for the disk, and seconds of work that may wait."""

MANIFEST = {"format": 1, "what": "a sweep of troupe; see docs/sweeps.md"}


def open_folder(folder: Path) -> None:
    """Make a sweep's folder, or take one up; raises UsageError for another folder with contents."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise UsageError(f"--out {folder}: is not a folder") from None
    except OSError as error:
        raise UsageError(f"--out {folder}: cannot be made: {told(error)}") from None
    known = folder / "manifest.json"
    if not known.exists():
        if any(one.suffix != ".tmp" for one in folder.iterdir()):
            raise UsageError(f"--out {folder}: has something else in it; name an empty folder")
        write_aside(known, json.dumps(MANIFEST).encode() + b"\n")
    check_folder(folder)


def check_folder(folder: Path) -> None:
    """Raises UsageError unless it is a sweep's folder of a kind that is known here."""
    try:
        found = json.loads((folder / "manifest.json").read_bytes())["format"]
    except (FileNotFoundError, NotADirectoryError):
        raise UsageError(f"{folder}: is not the folder of a sweep (no manifest.json)") from None
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise UsageError(f"{folder}/manifest.json: cannot be read: {error}") from None
    if found != MANIFEST["format"]:
        raise UsageError(f"{folder}: is of format {found}; this is format {MANIFEST['format']}")


def write_aside(path: Path, data: bytes) -> None:
    """Write a file so that under its name there is all of it or nothing, whatever happens.

    Raises OSError that names the file as it was asked for.
    """
    aside = path.with_name(f"{path.name}.{platform.node()}-{os.getpid()}.tmp")
    try:
        with aside.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(aside, path)
    except BaseException as error:
        with contextlib.suppress(OSError):
            aside.unlink()
        if isinstance(error, OSError):
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise
    sync_folder(path.parent)


def sync_folder(folder: Path) -> None:
    """Have the names in a folder kept, not only the files."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def sweep_up(folder: Path) -> None:
    """Remove what processes of this machine that are gone have left half-written."""
    own = [folder / name for name in ("plans", "videos", "logs")]
    places = [folder, *own, *(folder / "runs").glob("*/")]
    for path in (path for place in places for path in place.glob(f"*.{platform.node()}-*.tmp*")):
        number = path.name.partition(".tmp")[0].rpartition("-")[2]
        with contextlib.suppress(OSError, ValueError):
            if not is_alive(int(number)):
                path.unlink()


def is_alive(pid: int) -> bool:
    """Whether there is a process of that number here."""
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True


def save_plan(folder: Path, plan: Plan) -> None:
    """Keep a plan; another sweep's stays."""
    (folder / "plans").mkdir(exist_ok=True)
    text = json.dumps(plan.as_json(), indent=1)
    write_aside(folder / "plans" / f"{plan.name}.json", text.encode() + b"\n")


def load_plans(folder: Path) -> list[Plan]:
    """The plans of a folder, in the order of their names; raises UsageError for damaged ones."""
    check_folder(folder)
    plans = []
    for path in sorted((folder / "plans").glob("*.json")):
        try:
            plans.append(plan_of_json(json.loads(path.read_bytes())))
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise UsageError(f"{path}: is damaged ({error}); run the sweep again") from None
    return plans


def lines(folder: Path) -> Iterator[Line]:
    """All whole lines of a folder, in any order, also several of one run."""
    runs = folder / "runs"
    with contextlib.suppress(FileNotFoundError), os.scandir(runs) as entries:
        for entry in entries:
            line = line_of_run(folder, entry.name)
            if line is not None:
                yield line
    for path in sorted((folder / "batches").glob("*")):
        if path.suffix in (".jsonl", ".part"):
            with contextlib.suppress(FileNotFoundError), path.open("rb") as file:
                for data in file:
                    line = read_line(data)
                    if line is not None:
                        yield line


def line_of_run(folder: Path, name: str) -> Line | None:
    """The line of a run that has a file of its own, if that is whole."""
    try:
        line = read_line((folder / "runs" / name / "result.json").read_bytes())
    except (FileNotFoundError, NotADirectoryError):
        return None
    return line if line is not None and line.name == name else None


def records(folders: Iterable[Path]) -> dict[str, Line]:
    """For every run of which there is a whole record, the one that counts, by its name."""
    found: dict[str, Line] = {}
    for folder in folders:
        for line in lines(folder):
            found[line.name] = better(line, found.get(line.name))
    return found


def done(folder: Path) -> dict[str, tuple[str, int]]:
    """The outcome and the tries of every run of which there is a whole record, by its name."""
    found: dict[str, tuple[str, int]] = {}
    for line in lines(folder):
        known = found.get(line.name, ("", 0))
        if known[0] != "completed" and (line.outcome == "completed" or line.tries >= known[1]):
            found[line.name] = (line.outcome, line.tries)
    return found


class Keeper:
    """Puts records into a folder: in files of their own, or in batches."""

    def __init__(self, folder: Path, *, batches: bool) -> None:
        self.folder = folder
        self.batch: BinaryIO | None = None
        self.path = folder
        self.number = 0
        self.digest = hashlib.sha256()
        self.synced = 0.0
        self.waiting = 0.0  # seconds of work that are not on the disk
        self.batches = batches
        (folder / ("batches" if batches else "runs")).mkdir(exist_ok=True)

    def put(self, record: Mapping[str, Any]) -> None:
        """Keep one run's record; OSError where there is no room for it."""
        data = line_of(record)
        if not self.batches:
            place = self.folder / "runs" / str(record["name"])
            place.mkdir(exist_ok=True)
            write_aside(place / "result.json", data)
            return
        if self.batch is None:
            now = time.strftime("%Y%m%dT%H%M%S", time.gmtime())
            name = f"{now}-{platform.node()}-{os.getpid()}-{secrets.token_hex(4)}.part"
            self.path = self.folder / "batches" / name
            self.batch = self.path.open("xb")
            self.number, self.digest = 0, hashlib.sha256()
            sync_folder(self.path.parent)
        self.batch.write(data)
        self.number += 1
        self.digest.update(data)
        self.waiting += record.get("seconds") or 0.0
        if self.number >= SEALED_AFTER:
            self.close()
        elif self.waiting > FLUSH or time.monotonic() - self.synced > FLUSH:
            self.sync()

    def sync(self) -> None:
        """Everything that was put is on the disk afterwards."""
        if self.batch is not None:
            self.batch.flush()
            os.fsync(self.batch.fileno())
        self.synced, self.waiting = time.monotonic(), 0.0

    def close(self) -> None:
        """Seal the batch: its last line says how many there are before it, and their SHA-256."""
        if self.batch is None:
            return
        seal = {"sealed": self.number, "sha256": self.digest.hexdigest()}
        self.batch.write(json.dumps(seal).encode() + b"\n")
        self.sync()
        self.batch.close()
        self.batch = None
        os.replace(self.path, self.path.with_suffix(".jsonl"))
        sync_folder(self.path.parent)
