"""What pymunk keeps to itself is used in one file, which says so when it has changed."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pymunk
import pytest

import sim
from sim.stage import chipmunk
from sim.stage.memory import read_bodies
from sim.stage.records import MOVER


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


def test_a_body_whose_state_lies_elsewhere_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(chipmunk, "WITHIN", 12)
    assert chipmunk.changed_parts() == ["cpBody"]


def test_bodies_are_read_where_chipmunk_keeps_them() -> None:
    body = pymunk.Body(2.0, 3.0)
    body.position, body.angle = (1.5, -2.5), 7.0
    body.velocity, body.angular_velocity = (0.25, -0.5), 0.125
    movers, state = np.zeros(1, MOVER), np.zeros((1, 6))
    movers["body"] = chipmunk.state_of(body)
    read_bodies(state, movers, 1)
    assert state.tolist() == [[1.5, -2.5, 7.0, 0.25, -0.5, 0.125]]
