"""A run whose address somebody else has: it does not begin, and what was kept before stays."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

import troupe as library
from tests.started import troupe


@pytest.fixture
def taken() -> Iterator[int]:
    """A port at which somebody else listens."""
    with socket.create_server(("127.0.0.1", 0)) as other:
        yield other.getsockname()[1]


@pytest.fixture
def kept(tmp_path: Path) -> dict[str, Path]:
    """What earlier runs have left, by the option that would write it anew."""
    found = {"--video": tmp_path / "run.mp4", "--log": tmp_path / "run.mcap"}
    for path in found.values():
        path.write_text("of an earlier run")
    return found


@pytest.mark.parametrize("option", ["--listen", "--view"])
def test_no_file_is_lost_for_a_run_that_cannot_begin(
    option: str, taken: int, kept: dict[str, Path]
) -> None:
    files = [word for name, path in kept.items() for word in (name, path)]
    words = ("--duration", "0.1", option, f"127.0.0.1:{taken}")
    done = troupe("run", "wander", *words, *files)
    assert (done.returncode, done.stdout) == (2, "")
    assert f"cannot listen on 127.0.0.1:{taken}" in done.stderr
    assert {path.read_text() for path in kept.values()} == {"of an earlier run"}


def test_no_log_is_lost_for_a_simulation_that_cannot_begin(
    taken: int, kept: dict[str, Path]
) -> None:
    with pytest.raises(OSError, match=f"cannot listen on 127.0.0.1:{taken}"):
        library.Simulation(
            "wander", controllers=False, listen=f"127.0.0.1:{taken}", log=kept["--log"]
        )
    assert kept["--log"].read_text() == "of an earlier run"
