"""A kept result as the object that `troupe.run` gives, and functions that add columns to it."""

from __future__ import annotations

import importlib
import importlib.util
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any, ClassVar

from sim.result import DoorRecord, FloorRecord, Result, RobotRecord
from sim.strictjson import DEEPEST, TOO_DEEP
from sim.worldfile.mistakes import suggestion
from troupe.usage import UsageError


def result_of(record: Mapping[str, Any]) -> Result:
    """The result that a record was made of."""
    return Result(
        world=record["world"],
        seed=record["seed"],
        outcome=record["outcome"],
        sim_time=record["sim_time"],
        wall_time=record["wall_time"],
        ticks=record["ticks"],
        digest=record["digest"],
        robots=[robot_of(one) for one in record["robots"]],
        floor=FloorRecord(**record["floor"]),
        doors=[DoorRecord(**one) for one in record["doors"]],
    )


def robot_of(one: Mapping[str, Any]) -> RobotRecord:
    """One robot's part of a result."""
    x, y, yaw = one["start"]
    end_x, end_y, end_yaw = one["pose"]
    return RobotRecord(
        name=one["name"],
        model=one["model"],
        entered=one["entered"],
        start=(x, y, yaw),
        pose=(end_x, end_y, end_yaw),
        state=one["controller"]["state"],
        distance=one["distance"],
        stalls=one["stalls"],
        contacts=one["contacts"],
        exit_code=one["controller"]["exit_code"],
        error=one["controller"]["error"],
        devices=list(one["devices"]),
        properties=dict(one["properties"]),
        said=[(time, text) for time, text in one["said"]],
    )


@dataclass(frozen=True)
class Each:
    """A function of a result: `module:function` or `FILE.py:function`, and where it was named."""

    name: str
    folder: str
    option: ClassVar[str] = "--each"

    def load(self) -> Callable[..., Any]:
        """The function; raises UsageError where there is none."""
        module_name, colon, function = self.name.rpartition(":")
        if not colon or not function.isidentifier() or not module_name:
            raise UsageError(f"{self}: must be module:function, or FILE.py:function")
        file = Path(self.folder, module_name)
        if module_name.endswith(".py") and not file.is_file():
            raise UsageError(f"{self}: there is no file {module_name}")
        try:
            if module_name.endswith(".py"):
                module = module_of(file)
            else:
                with first_place(self.folder):
                    module = importlib.import_module(module_name)
        except Exception as error:  # a module of the user's raises anything
            raise UsageError(f"{self}: {type(error).__name__}: {error}") from None
        found: Callable[..., Any] | None = getattr(module, function, None)
        if not callable(found):
            known = [name for name, one in vars(module).items() if callable(one)]
            what = f"there is no function {function} in {module_name}"
            raise UsageError(f"{self}: {what}{suggestion(function, known)}")
        return found

    @property
    def source(self) -> Path | None:
        """The file that the function stands in, as far as it is known without loading it."""
        module_name = self.name.rpartition(":")[0]
        if module_name.endswith(".py"):
            return Path(self.folder, module_name)
        with first_place(self.folder):
            try:
                spec = importlib.util.find_spec(module_name)
            except (ImportError, ValueError):
                return None
        return None if spec is None or spec.origin is None else Path(spec.origin)

    def __str__(self) -> str:
        return f"{self.option} {self.name}"


@dataclass(frozen=True)
class Judge(Each):
    """A function of a run's evidence and its result, named in the same way."""

    option: ClassVar[str] = "--judge"


def module_of(path: Path) -> ModuleType:
    """A file as a module, which finds those beside it as a program does; raises what it raises.

    It is compiled as it is now: code that Python keeps passes for that of a file which was changed
    within the same second and is as long as before.
    """
    name = f"_each_{path.stem}"
    loader = AsItIs(name, str(path))
    spec = importlib.util.spec_from_file_location(name, path, loader=loader)
    assert spec is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # dataclasses look for it there
    with first_place(str(path.parent)):
        loader.exec_module(module)
    return module


class AsItIs(SourceFileLoader):
    """Compiles a file whenever it is loaded, and keeps nothing."""

    def get_code(self, fullname: str) -> CodeType:
        code: CodeType = self.source_to_code(self.get_data(self.path), self.path)
        return code


@contextmanager
def first_place(folder: str) -> Iterator[None]:
    """Within, modules are looked for in a folder first; our own have been found before."""
    sys.path.insert(0, folder)
    try:
        yield
    finally:
        sys.path.remove(folder)


def added(each: Each, function: Callable[..., Any], record: Mapping[str, Any]) -> Any:
    """The columns that a function adds to a record's row; raises UsageError.

    It is given the run's result, or the columns of a run that is a function's. A mapping is several
    columns; any other value is one, of the function's name.
    """
    if "robots" not in record and "columns" not in record:
        return {}
    try:
        value = function(result_of(record) if "robots" in record else dict(record["columns"]))
        return columns_of(each, value)
    except Exception as error:
        raise UsageError(
            f"{each}: {type(error).__name__}: {error} (for the run {record['name']})"
        ) from None


def columns_of(each: Each, value: Any) -> dict[str, Any]:
    """What a function gave, as columns; raises ValueError for what is too deep for a table."""
    name = each.name.rpartition(":")[2]
    found = dict(value) if isinstance(value, Mapping) else {name: value}
    return {str(key): plain(one) for key, one in found.items()}


def plain(value: Any, levels: int = DEEPEST) -> Any:
    """A value that a table holds: numpy's numbers as Python's, what is no JSON as its text.

    NaN, infinities and numbers beyond what a double holds are missing.
    """
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, int | float) and not abs(value) <= sys.float_info.max:
        return None
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if not isinstance(value, list | tuple | dict):
        return str(value)
    if levels == 0:
        raise ValueError(TOO_DEEP)
    if isinstance(value, dict):
        return {str(key): plain(one, levels - 1) for key, one in value.items()}
    return [plain(one, levels - 1) for one in value]
