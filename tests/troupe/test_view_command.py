"""What `troupe view` says to options that a log cannot have, and to places that are none."""

from __future__ import annotations

import pytest

from tests.started import troupe


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("--seed", "0"), ("--duration", "0"), ("--set", "a=1"), ("--listen", "127.0.0.1:0"),
        ("--patience", "60"), ("--realtime", "2"), ("--json", None),
    ],
)  # fmt: skip
def test_what_only_a_run_has_is_refused_to_a_log(option: str, value: str | None) -> None:
    words = [option] if value is None else [option, value]
    done = troupe("view", "run.mcap", "--no-open", *words)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"{option}: run.mcap is a log of a run that is over\n"


@pytest.mark.parametrize("place", ["t=x", "t=-1", "t=", "5"])
def test_a_place_in_a_log_that_is_none_is_told(place: str) -> None:
    done = troupe("view", f"run.mcap#{place}", "--no-open")
    assert (done.returncode, done.stdout) == (2, "")
    told = f"run.mcap#{place}: no moment of a log; from 12.5 s on is run.mcap#t=12.5\n"
    assert done.stderr == told
