"""The names of `player` load on first use, and are those that it promises."""

from __future__ import annotations

import subprocess
import sys

import pytest

import player


def test_every_promised_name_is_there() -> None:
    from player import PlayerClient, Robot, run  # noqa: PLC0415

    assert all(hasattr(player, name) for name in player.__all__)
    assert (player.PlayerClient, player.Robot, player.run) == (PlayerClient, Robot, run)


def test_no_other_name_has_a_home() -> None:
    assert set(player._HOME) == set(player.__all__)
    with pytest.raises(AttributeError, match="Nobody"):
        _ = player.Nobody


def test_words_for_a_terminal_load_no_arrays() -> None:
    program = "import sys, player.printable; print({'numpy', 'player.client'} & {*sys.modules})"
    done = subprocess.run(
        [sys.executable, "-c", program], check=True, capture_output=True, text=True
    )
    assert done.stdout.strip() == "set()"
