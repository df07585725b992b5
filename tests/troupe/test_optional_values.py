"""An option that may stand without a value leaves the command its world."""

from __future__ import annotations

from typing import Any

import pytest
import typer
from typer.testing import CliRunner

from troupe.app import app
from troupe.optional_values import OPTIONAL, Command, with_values

RUN = {"view": None, "realtime": None, "log_sensors": None}


def parsed(words: str) -> dict[str, Any]:
    """What `troupe run WORDS` is told of its world and of these options."""
    command: Any = typer.main.get_command(app)
    run = command.get_command(None, "run")
    assert isinstance(run, Command)
    with run.make_context("run", words.split()) as context:
        return {key: context.params[key] for key in ("world", *RUN)}


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("w", {}),
        ("w --view", {"view": ""}),
        ("--view w", {"view": ""}),
        ("w --view 0.0.0.0:7000", {"view": "0.0.0.0:7000"}),
        ("--view 7000 w", {"view": "7000"}),
        ("--view=[::1]:7 w", {"view": "[::1]:7"}),
        ("--view --json w", {"view": ""}),
        ("w --realtime", {"realtime": 1.0}),
        ("--realtime w", {"realtime": 1.0}),
        ("w --realtime 2.5", {"realtime": 2.5}),
        ("--realtime 2 w", {"realtime": 2.0}),
        ("w --realtime -1", {"realtime": -1.0}),
        ("w --log-sensors --quiet", {"log_sensors": "all"}),
        ("--log-sensors w", {"log_sensors": "all"}),
        ("w --log-sensors laser", {"log_sensors": "laser"}),
        ("--log-sensors laser,blobfinder w", {"log_sensors": "laser,blobfinder"}),
        ("--realtime 2 --log-sensors w --view 7000",
         {"realtime": 2.0, "log_sensors": "all", "view": "7000"}),
        ("--view --log-sensors --realtime -- w",
         {"view": "", "log_sensors": "all", "realtime": 1.0}),
    ],
)  # fmt: skip
def test_the_word_behind_is_a_value_unless_the_world_would_be_missing(
    words: str, told: dict[str, Any]
) -> None:
    assert parsed(words) == {"world": "w", **RUN, **told}


@pytest.mark.parametrize(
    ("words", "error"),
    [
        ("wander --view nowhere", "must be HOST:PORT"),
        ("wander --view a..b:7000", "must be HOST:PORT"),
        ("wander --realtime fast", "valid number"),
        ("wander --log-sensors lazer --log x.mcap", "lazer"),
        ("--view", "Missing argument"),
        ("--realtime 2", "2: no such world"),
    ],
)
def test_a_value_that_is_none_is_named(words: str, error: str) -> None:
    done = CliRunner().invoke(app, ["run", *words.split()])
    assert done.exit_code == 2
    assert error in " ".join(done.stderr.replace("│", " ").split())


def test_what_stands_behind_two_dashes_is_left_as_it_is() -> None:
    assert with_values(["--", "--view", "7000"], OPTIONAL) == (["--", "--view", "7000"], [])
