"""A world file that comes through a pipe."""

from __future__ import annotations

import os
import subprocess
import threading
from pathlib import Path

import pytest

from tests import started
from tests.patience import PATIENCE
from tests.processes import environment
from troupe.worlds import find_world

WORLD = """\
duration: 0.5
until: duration
map: {file: hall.txt, cell: 1}
models: {r: {body: {shape: circle, radius: 0.3}}}
robots: [{model: r, pose: [1.5, 1.5, 0]}]
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "hall.txt").write_text("####\n#..#\n####\n")
    (tmp_path / "world.yaml").write_text(WORLD)
    return tmp_path


@pytest.mark.parametrize("words", ["/dev/stdin < world.yaml", "- < world.yaml", "<(cat world.yaml)",
                                   "- < <(cat world.yaml)"])  # fmt: skip
@pytest.mark.parametrize("command", ["run", "check"])
def test_a_piped_world_finds_its_map_from_the_current_folder(
    folder: Path, command: str, words: str
) -> None:
    done = subprocess.run(
        ["bash", "-c", f'"$@" {command} {words}', "bash", *started.command()],
        env=environment(),
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE,
    )
    assert done.returncode == 0, done.stderr


def test_a_named_pipe_goes_before_a_name_and_is_read_once(folder: Path) -> None:
    from sim.build import load  # noqa: PLC0415

    pipe = folder / "wander"
    os.mkfifo(pipe)
    writer = threading.Thread(target=pipe.write_text, args=(WORLD.replace("hall", "nix"),))
    writer.start()
    assert find_world(str(pipe)) == pipe
    with pytest.raises(ValueError, match=r"map\.file"):
        load(pipe)
    writer.join()
