"""What pymunk keeps to itself is used in one file, which says so when it has changed."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import sim
from sim.stage import chipmunk


def test_one_file_alone_uses_what_pymunk_keeps_to_itself() -> None:
    private = re.compile(r"pymunk\._|_chipmunk_cffi|\._space\._space|\._(float|int)_arr")
    folder = Path(sim.__file__).parent
    users = [path.name for path in folder.rglob("*.py") if private.search(path.read_text())]
    assert users == ["chipmunk.py"]


def test_the_installed_pymunk_is_inside_as_it_must_be() -> None:
    assert chipmunk.changed_parts() == []


def test_a_function_that_has_gone_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(chipmunk, "FUNCTIONS", ("cpSpaceStep", "cpSpaceLeap"))
    assert chipmunk.changed_parts() == ["cpSpaceLeap"]


def test_a_struct_that_is_laid_out_anew_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(chipmunk.LAYOUT, "pmIntArray", (("arr", "uintptr_t *"), *chipmunk.ARRAY))
    assert chipmunk.changed_parts() == ["pmIntArray"]
