"""Imports of worlds in Stage's format, for the tests in this folder."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import yaml

from sim.build import LoadedWorld, load
from troupe.commands.import_ import write
from troupe.importers.stage import Note, convert

DATA = Path(__file__).parent / "data"


@dataclass
class Import:
    """What came out of an import, as text, as data, and loaded."""

    text: str
    data: dict[str, Any]
    loaded: LoadedWorld
    notes: list[Note]
    path: Path

    def robot(self, name: str) -> dict[str, Any]:
        return next(robot for robot in self.data["robots"] if robot["name"] == name)

    def model(self, name: str) -> dict[str, Any]:
        model: dict[str, Any] = self.data["models"][self.robot(name)["model"]]
        return model

    def noted(self, kind: str, where: str) -> list[str]:
        """What the notes of a kind say about FILE:LINE."""
        return [
            note.what for note in self.notes
            if note.kind == kind and f"{Path(note.place.file).name}:{note.place.line}" == where
        ]  # fmt: skip


def imported(world: Path, cfg: Path | None, folder: Path) -> Import:
    path = folder / "out" / "world.yaml"
    path.parent.mkdir(exist_ok=True)
    converted = convert(str(world), None if cfg is None else str(cfg), path)
    write(converted, path, force=True)
    data = yaml.safe_load(converted.text)
    return Import(converted.text, data, load(path), converted.notes, path)


@pytest.fixture
def world(tmp_path: Path):
    """Imports a world of the data folder, or a text."""

    def make(text: str, cfg: str | None = None) -> Import:
        for file in DATA.iterdir():
            shutil.copy(file, tmp_path)
        path = tmp_path / text if "\n" not in text and text.endswith(".world") else None
        if path is None:
            path = tmp_path / "text.world"
            path.write_text(text)
        if cfg is not None and not cfg.endswith(".cfg"):
            (tmp_path / "text.cfg").write_text(cfg)
            cfg = "text.cfg"
        return imported(path, tmp_path / cfg if cfg else None, tmp_path)

    return make
