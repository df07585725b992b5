"""The sensors there are: each file registers one, with its settings and the kind of its reading."""

from __future__ import annotations

import difflib
import hashlib
import importlib
import importlib.util
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from pydantic_core import PydanticCustomError, ValidationError

from sensors.readings import KINDS, Fan, Readings
from sensors.settings import SensorSettings
from sensors.view import View

S = TypeVar("S", bound=SensorSettings)
R = TypeVar("R", bound=Readings)
Sense = Callable[[Any, View, Any], None]

BUILT_IN = (
    "laser",
    "ranger",
    "blobfinder",
    "fiducial",
    "bumper",
)
"""The sensors that come with Troupe: each is the module of that name. A new one is a file in this
folder and its line above."""


@dataclass(frozen=True)
class SensorType:
    """A kind of sensor: its name, what may be set, and how it senses."""

    name: str
    kind: str
    """The kind of its readings: a key of `readings.KINDS`."""
    settings: type[SensorSettings]
    readings: Callable[[Any, int], Readings]
    """readings(settings, n): empty readings for n robots."""
    sense: Sense
    """sense(settings, view, readings): writes the wanted rows of `readings`."""
    fan: Callable[[Any, Any], Fan | None]
    """fan(settings, readings): the rays to be cast for it before it senses, or None."""
    threads: bool
    """Whether parts of a batch may be sensed at the same time: it writes `view.rows` only, and
    most of its work is in compiled code."""
    summary: str
    """What it senses, in a line: the first of the function's docstring."""


class _Sensors(Mapping[str, SensorType]):
    """The registered sensors by name; those that come with Troupe are imported on first use."""

    def __init__(self) -> None:
        self.types: dict[str, SensorType] = {}
        self._loaded = False

    def _load(self) -> dict[str, SensorType]:
        if not self._loaded:
            self._loaded = True
            for name in BUILT_IN:
                importlib.import_module(f"{__package__}.{name}")
            # whichever of them was imported first: they are told in one order
            self.types = {name: self.types.pop(name) for name in BUILT_IN} | self.types
        return self.types

    def __getitem__(self, name: str) -> SensorType:
        return self._load()[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._load())

    def __len__(self) -> int:
        return len(self._load())


_SENSORS = _Sensors()
SENSORS: Mapping[str, SensorType] = _SENSORS
"""Every registered sensor by the name that a world file gives as its `type`."""

_BY_SETTINGS: dict[type[SensorSettings], SensorType] = {}
_FILES: dict[tuple[Path, str], SensorType] = {}
_LOADING: ContextVar[list[SensorType] | None] = ContextVar("_LOADING", default=None)


def sensor(
    name: str,
    *,
    kind: str,
    settings: type[S],
    readings: Callable[[S, int], R],
    fan: Callable[[S, R], Fan | None] = lambda settings, readings: None,
    threads: bool = False,
) -> Callable[[Callable[[S, View, R], None]], Callable[[S, View, R], None]]:
    """Register the decorated function as a sensor.

    Args:
        name: what a world file writes as the sensor's `type`. In a file of a user's own, which
            world files name by its path, the name is for messages only.
        kind: the kind of its readings, a key of `readings.KINDS`.
        settings: a subclass of SensorSettings, a class of this sensor alone.
        readings: makes empty readings for n robots: readings(settings, n).
        fan: fan(settings, readings) tells what rays to cast from the sensor's mount, and where
            to write what they hit, before the function is called. Fans of sensors that look from
            one place are cast together. None where there are none.
        threads: parts of a large batch may be sensed at the same time: the function writes
            `view.rows` of the readings and nothing else.

    The function is called as sense(settings, view, readings) and writes `view.rows` of the
    readings; it must not depend on anything but its arguments.

    Raises:
        ValueError: the name is taken, the kind does not exist, or the settings serve another.
    """
    if kind not in KINDS:
        raise ValueError(f"sensor {name!r}: no kind {kind!r} of readings; there are {list(KINDS)}")

    def register(sense: Callable[[S, View, R], None]) -> Callable[[S, View, R], None]:
        if not issubclass(settings, SensorSettings) or settings in _BY_SETTINGS:
            raise ValueError(f"sensor {name!r}: needs settings of its own, from SensorSettings")
        summary = (sense.__doc__ or "").strip().split("\n")[0]
        new = SensorType(name, kind, settings, readings, sense, fan, threads, summary)
        loading = _LOADING.get()
        if loading is not None:
            loading.append(new)
        elif name in _SENSORS.types:
            raise ValueError(f"there is a sensor {name!r} already")
        else:
            _SENSORS.types[name] = new
        _BY_SETTINGS[settings] = new
        return sense

    return register


def type_of(settings: SensorSettings) -> SensorType:
    """The sensor to which these settings belong."""
    return _BY_SETTINGS[type(settings)]


def load_file(path: Path | str) -> SensorType:
    """Import a sensor file of a user's own and return the one sensor that it registers.

    The file becomes a module under a private name, so it gets in nobody's way, whatever it is
    called; a file that was changed since is imported anew.

    Raises:
        ValueError: the file is missing, fails when it is imported, or registers none or several.
    """
    file = Path(path).resolve()
    try:
        digest = hashlib.sha256(file.read_bytes()).hexdigest()[:16]
    except OSError as error:
        raise ValueError(f"cannot read the sensor file {file}: {error.strerror}") from None
    if (file, digest) in _FILES:
        return _FILES[file, digest]
    name = f"_sensor_file_{hashlib.sha256(str(file).encode()).hexdigest()[:16]}_{digest}"
    spec = importlib.util.spec_from_file_location(name, file)
    if spec is None or spec.loader is None:
        raise ValueError(f"a sensor file must end in .py: {file}")
    module = importlib.util.module_from_spec(spec)
    found: list[SensorType] = []
    token = _LOADING.set(found)
    sys.modules[name] = module  # pydantic and dataclasses look annotations up here
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        del sys.modules[name]
        where = _line_of(error, file)
        raise ValueError(f"{where}: {type(error).__name__}: {error}") from error
    finally:
        _LOADING.reset(token)
    if len(found) != 1:
        names = ", ".join(repr(t.name) for t in found) or "none"
        raise ValueError(f"a sensor file registers one sensor, but {file} registers {names}")
    _FILES[file, digest] = found[0]
    return found[0]


def _line_of(error: Exception, file: Path) -> str:
    """FILE:LINE of the last line of `file` on the way to the error."""
    line = error.lineno if isinstance(error, SyntaxError) else None
    trace = error.__traceback__
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == str(file):
            line = trace.tb_lineno
        trace = trace.tb_next
    return f"{file}:{line}" if line else str(file)


def settings_for(spec: Mapping[str, Any], base: Path | None = None) -> SensorSettings:
    """The settings that a world file's mapping `{type: laser, range: 20, ...}` asks for.

    Args:
        spec: the mapping. A `type` that ends in .py is a sensor file of the user's own.
        base: the folder from which such a path goes; the current one unless given.

    Raises:
        pydantic.ValidationError: with the key's name as the error's place.

    >>> settings_for({"type": "laser", "range": 5}).range
    5.0
    """
    if "type" not in spec:
        raise _invalid(spec, "missing", f"a sensor needs a type: {', '.join(SENSORS)}")
    name = spec["type"]
    if not isinstance(name, str):
        raise _invalid(name, "sensor_type", "the type of a sensor is a name or a file")
    if name.endswith(".py"):
        try:
            found = load_file((base or Path()) / name)
        except ValueError as error:
            raise _invalid(name, "sensor_file", str(error)) from error
    elif name in SENSORS:
        found = SENSORS[name]
    else:
        close = difflib.get_close_matches(name, SENSORS, n=1)
        hint = f"did you mean {close[0]}?" if close else f"there are {', '.join(SENSORS)}"
        raise _invalid(name, "sensor_type", f"there is no sensor {name!r}: {hint}")
    return found.settings.model_validate({k: v for k, v in spec.items() if k != "type"})


def _invalid(value: object, kind: str, message: str) -> ValidationError:
    """A ValidationError about the key `type`."""
    escaped = message.replace("{", "(").replace("}", ")")
    error = PydanticCustomError(kind, escaped)
    return ValidationError.from_exception_data(
        "sensor", [{"type": error, "loc": ("type",), "input": value}]
    )


def describe(found: Iterable[SensorType] | None = None) -> list[dict[str, Any]]:
    """Sensors, every registered one unless told, for people: name, kind, summary and settings.

    Each setting has name, type, unit, default (None if it must be given) and description.
    """
    return [
        {
            "name": one.name,
            "kind": one.kind,
            "summary": one.summary,
            "settings": [
                {
                    "name": name,
                    "unit": str(extra.get("unit", "")) if isinstance(extra, dict) else "",
                    "required": info.is_required(),
                    "default": None if info.is_required() else info.get_default(),
                    "description": info.description or "",
                }
                for name, info in one.settings.model_fields.items()
                for extra in (info.json_schema_extra,)
            ],
        }
        for one in (SENSORS.values() if found is None else found)
    ]
