"""`troupe.run` takes the options of `troupe run` by their names, as text or as Python's values."""

from __future__ import annotations

import inspect
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import troupe
from sim.video.errors import VideoError
from sim.worldfile import WorldError
from troupe.address import parse_address
from troupe.commands.run import run as command
from troupe.setting import as_text
from troupe.usage import UsageError

SHOWN = {"as_json", "quiet", "view", "no_open", "read_only"}
"""Options about what is printed, and what a browser shows."""


def test_it_has_the_options_of_the_command_by_their_names() -> None:
    options = {name.rstrip("_") for name in inspect.signature(command).parameters}
    assert options - SHOWN <= set(inspect.signature(troupe.run).parameters)


def test_its_docstring_names_every_argument_and_every_exception() -> None:
    told = inspect.getdoc(troupe.run) or ""
    for name in inspect.signature(troupe.run).parameters:
        assert f"{name}:" in told or f"{name}," in told or name.startswith("video_")
    for error in ("WorldError", "VideoError", "ValueError", "OSError", "KeyboardInterrupt"):
        assert f"{error}:" in told


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"clock.interval": 0.05}, ["clock.interval=0.05"]),
        ({"size": (4, 3)}, ["size=[4, 3]"]),
        ({"size": np.array([4.0, 3.0])}, ["size=[4.0, 3.0]"]),
        ({"seed": np.int64(3)}, ["seed=3"]),
        ({"map.file": Path("m.txt")}, ['map.file="m.txt"']),
        ({"boundary": None}, ["boundary=null"]),
        ({"name": "a: b # c"}, ['name="a: b # c"']),
        (["clock.interval=0.05"], ["clock.interval=0.05"]),
    ],
)
def test_settings_are_a_mapping_or_texts(given: Any, text: list[str]) -> None:
    assert as_text(given) == text


def test_a_mapping_changes_the_world() -> None:
    result = troupe.run("wander", duration=0.5, set={"clock.interval": 0.25})
    assert result.ticks == 2
    assert result.digest == troupe.run("wander", duration=0.5, set=["clock.interval=0.25"]).digest


@pytest.mark.parametrize("listen", ["127.0.0.1:0", ("127.0.0.1", 0)])
@pytest.mark.parametrize("size", ["64x96", (64, 96)])
def test_addresses_and_sizes_are_text_or_pairs(tmp_path: Path, listen: Any, size: Any) -> None:
    lines: list[str] = []
    video = tmp_path / "run.mp4"
    troupe.run(
        "wander", duration=0.2, listen=listen, video=str(video), video_size=size, say=lines.append
    )
    assert video.stat().st_size > 0
    assert any("is served at 127.0.0.1:" in line for line in lines)


def test_a_port_alone_is_one_of_this_machine() -> None:
    assert parse_address("listen", "6665") == ("127.0.0.1", 6665)
    assert parse_address("listen", ":6665") == ("127.0.0.1", 6665)
    assert parse_address("listen", "[::1]:6665") == ("::1", 6665)


@pytest.mark.parametrize(
    ("more", "error"),
    [
        ({"duration": -1}, UsageError),
        ({"patience": -1}, UsageError),
        ({"seed": -1}, UsageError),
        ({"listen": "6665x"}, UsageError),
        ({"listen": ("127.0.0.1", 70000)}, UsageError),
        ({"set": "clock.interval=0.05"}, UsageError),
        ({"set": {"name": object()}}, UsageError),
        ({"set": {"clock.intervall": 1}}, WorldError),
        ({"video": "run.avi"}, VideoError),
        ({"video": "run.mp4", "video_size": "big"}, VideoError),
        ({"listen": "192.0.2.1:0"}, OSError),
    ],
)
def test_what_cannot_be_is_one_of_the_exceptions_that_it_names(
    more: dict[str, Any], error: type[Exception], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(error):
        troupe.run("wander", **{"duration": 0.2, **more})
    assert list(tmp_path.iterdir()) == []
