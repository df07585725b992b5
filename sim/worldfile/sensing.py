"""The sensors of models in a world file, checked by the registry of the `sensors` package."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from sim.worldfile.mistakes import Mistake, listed, suggestion
from sim.worldfile.nodes import Path as Where
from sim.worldfile.programs import LARGEST_PROGRAM
from sim.worldfile.reading import NotRead, read_regular
from sim.worldfile.values import LARGEST
from sim.worldfile.wording import mistakes_in, shown


def with_settings(
    data: dict[str, Any], folder: Path
) -> tuple[dict[str, Any], list[Mistake], set[Where]]:
    """The data with every sensor replaced by its settings.

    Returns besides the mistakes, and the places of the sensors that have some.
    """
    mistakes: list[Mistake] = []
    wrong: set[Where] = set()
    models = data.get("models")
    if not isinstance(models, Mapping):
        return data, mistakes, wrong
    done: dict[str, Any] = {}
    for name, model in models.items():
        done[name] = model
        if not isinstance(model, Mapping) or not isinstance(model.get("sensors"), tuple):
            continue
        sensors = []
        for index, sensor in enumerate(model["sensors"]):
            where = ("models", name, "sensors", index)
            found = _settings(sensor, where, folder)
            if isinstance(found, list):
                mistakes += found
                wrong.add(where)
            sensors.append(sensor if isinstance(found, list) else found)
        done[name] = {**model, "sensors": tuple(sensors)}
    return {**data, "models": done}, mistakes, wrong


def _settings(sensor: Any, where: Where, folder: Path) -> Any:
    """The settings of one sensor, or a list of mistakes."""
    # Here, as it imports the compiled kernels, which a world without sensors does not need.
    from sensors.registry import SENSORS, load_file, settings_for  # noqa: PLC0415

    if not isinstance(sensor, Mapping):
        return [Mistake(where, "must be a mapping", shown(sensor), "{type: laser, ...}")]
    kind = sensor.get("type")
    known = sorted(SENSORS)
    if kind is None and "type" not in sensor:
        return [Mistake((*where, "type"), "is missing", None, listed(known))]
    if not isinstance(kind, str) or (kind not in SENSORS and not kind.endswith(".py")):
        hint = suggestion(kind, known) if isinstance(kind, str) else ""
        allowed = f"{listed(known)}, or a Python file such as ./my_sensor.py"
        return [Mistake((*where, "type"), f"unknown sensor{hint}", shown(kind), allowed)]
    try:
        if kind not in SENSORS:
            read_regular(folder / kind, LARGEST_PROGRAM)
        settings = settings_for(sensor, folder)
    except NotRead as error:
        return [Mistake((*where, "type"), f"the sensor file {error}", kind)]
    except ValidationError as error:
        if error.errors(include_url=False)[0]["loc"] == ("type",):
            return [Mistake((*where, "type"), error.errors()[0]["msg"], shown(kind))]
        model = (SENSORS[kind] if kind in SENSORS else load_file(folder / kind)).settings
        return [
            replace(one, where=(*where, *one.where)) for one, _ in mistakes_in(error, sensor, model)
        ]
    beyond = [
        Mistake((*where, *path), "is out of range", shown(number), f"at most {LARGEST:g}")
        for path, number in _numbers(sensor, ())
        if abs(number) > LARGEST and (kind in SENSORS or isinstance(number, float))
    ]
    return beyond or settings


def _numbers(value: Any, where: Where) -> Iterator[tuple[Where, float]]:
    """The numbers in a sensor's settings, and where they stand."""
    if isinstance(value, int | float):
        yield where, value
    elif isinstance(value, Mapping):
        for key, inside in value.items():
            yield from _numbers(inside, (*where, key))
    elif isinstance(value, tuple):
        for index, inside in enumerate(value):
            yield from _numbers(inside, (*where, index))
