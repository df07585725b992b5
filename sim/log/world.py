"""The world that ran, kept in its log: resolved into one file, with the files that it needs."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from sim.build import LoadedWorld, load
from sim.log.errors import LogError
from sim.worldfile import WorldError, nodes
from sim.worldfile.files import rebased

WORLD = "world.yaml"
YAML = "application/yaml"
FILES = "application/octet-stream"


def attachments(loaded: LoadedWorld) -> Iterator[tuple[str, str, bytes]]:
    """Name, media type and content of the world and of its map and sensors of its own.

    The world is JSON, which is YAML too: included files and changes from the command line are in
    it, and its files are named by their attachments. Raises LogError for a file that has gone.
    """
    data = unpacked(rebased(nodes.plain(loaded.root), loaded.root, loaded.folder))
    files: dict[str, Path] = {}

    def kept(value: Any, key: str) -> None:
        path = (loaded.folder / value[key]).resolve()
        name = path.name
        while files.get(name, path) != path:
            name = f"_{name}"
        files[name] = path
        value[key] = f"./{name}"

    if isinstance(data.get("map"), dict):
        kept(data["map"], "file")
    for model in (data.get("models") or {}).values():
        for sensor in (model.get("sensors") or []) if isinstance(model, dict) else []:
            if is_own(sensor):
                kept(sensor, "type")
    yield WORLD, YAML, json.dumps(data, ensure_ascii=False, indent=1).encode()
    for name, path in files.items():
        try:
            yield name, FILES, path.read_bytes()
        except OSError as error:
            raise LogError(f"{path}: cannot be read for the log: {error.strerror}") from None


def unpacked(value: Any) -> Any:
    """Tuples as lists, mappings as dicts."""
    if isinstance(value, Mapping):
        return {key: unpacked(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [unpacked(item) for item in value]
    return value


STAND_IN = {"type": "bumper"}
"""In place of sensors of one's own: nobody's code is run because one looks into a log."""


def own_sensors(files: Mapping[str, bytes]) -> dict[str, set[int]]:
    """Which sensors of which models are of somebody's own making."""
    data = json.loads(files[WORLD])
    found = {
        name: {
            number
            for number, sensor in enumerate((model or {}).get("sensors") or [])
            if is_own(sensor)
        }
        for name, model in (data.get("models") or {}).items()
    }
    return {name: numbers for name, numbers in found.items() if numbers}


def is_own(sensor: Any) -> bool:
    """Whether a sensor of a world file is a Python file."""
    return isinstance(sensor, dict) and str(sensor.get("type", "")).endswith(".py")


def loaded_again(files: Mapping[str, bytes], log: Path, title: str | None = None) -> LoadedWorld:
    """The world of a log's attachments, without its programs and with bumpers for sensors of one's
    own; `title`: what it is called if it has no name.

    Raises LogError where it does not hold with this version of Troupe.
    """
    if WORLD not in files:
        raise LogError(f"{log}: there is no world in it")
    try:
        data = json.loads(files[WORLD])
        stripped(data)
    except (ValueError, TypeError, AttributeError) as error:
        raise LogError(f"{log}: its world cannot be read: {error}") from None
    if not data.get("name") and title:
        data["name"] = title
    with TemporaryDirectory(prefix="troupe-log-") as name:
        folder = Path(name)
        for file, content in files.items():
            if file not in (WORLD, "", ".", "..") and file == Path(file).name:
                (folder / file).write_bytes(content)
        path = folder / WORLD
        path.write_text(json.dumps(data, ensure_ascii=False), encoding="utf-8")
        try:
            return load(path)
        except WorldError as error:
            raise LogError(
                f"{log}: its world does not hold with this version of Troupe:\n{error}"
            ) from None


def stripped(data: Any) -> None:
    """Take out of a world all that would run code, and its own log."""
    data["controllers"] = {}
    for part in ("robots", "doors"):
        for entry in data.get(part) or []:
            entry["controller"] = None
    for model in (data.get("models") or {}).values():
        sensors = (model or {}).get("sensors") or []
        sensors[:] = [STAND_IN if is_own(sensor) else sensor for sensor in sensors]
    data.pop("log", None)
