"""A user's own modules work in controllers whatever their names; only `player` is ours there."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import troupe
from tests.processes import environment

World = Callable[..., Path]

DRIVES = """
from player import PlayerClient, Position2dProxy
with PlayerClient() as robot:
    base = Position2dProxy(robot)
    while robot.read():
        base.set_speed(SPEED)
"""


@pytest.mark.parametrize("name", ["controllers", "sensors", "sim", "troupe"])
@pytest.mark.parametrize("package", [True, False])
def test_a_folder_with_a_name_of_ours_works_in_a_controller(
    world_with: World, tmp_path: Path, name: str, package: bool
) -> None:
    folder = tmp_path / name
    folder.mkdir()
    (folder / "common.py").write_text("SPEED = 0.25\n")
    if package:
        (folder / "__init__.py").write_text("")
    path = world_with(f"from {name}.common import SPEED\n{DRIVES}")
    result = troupe.run(path, duration=1.0)
    assert result.outcome == "completed", result.robot("one").error
    assert result.robot("one").distance > 0.1
    assert result.robot("two").distance > 0.1  # it wanders under one of ours


def test_programs_in_a_folder_of_that_name_share_modules_with_it(
    world_with: World, tmp_path: Path
) -> None:
    """As `program: ./controllers/mine.py`, which says `from controllers.common import ...`."""
    folder = tmp_path / "controllers"
    folder.mkdir()
    (folder / "common.py").write_text("SPEED = 0.25\n")
    (folder / "mine.py").write_text(f"from controllers.common import SPEED\n{DRIVES}")
    path = world_with("")
    path.write_text(path.read_text().replace("./mine.py", "./controllers/mine.py"))
    result = troupe.run(path, duration=1.0)
    assert result.outcome == "completed", result.robot("one").error
    assert result.robot("one").distance > 0.1


def test_ours_are_there_for_who_asks_for_them_and_has_none(world_with: World) -> None:
    path = world_with(f"from controllers.motion import turn_to\nSPEED = 0.25\n{DRIVES}")
    assert troupe.run(path, duration=0.5).outcome == "completed"


def test_the_worlds_folder_comes_after_everything_else(world_with: World, tmp_path: Path) -> None:
    folder = tmp_path / "programs"
    folder.mkdir()
    (tmp_path / "json.py").write_text("raise RuntimeError('not the library')")
    (folder / "mine.py").write_text(f"import json\nSPEED = json.loads('0.25')\n{DRIVES}")
    path = world_with("")
    path.write_text(path.read_text().replace("./mine.py", "./programs/mine.py"))
    result = troupe.run(path, duration=0.5)
    assert result.outcome == "completed", result.robot("one").error


def python(program: str, folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", program], cwd=folder, env=environment(),
        capture_output=True, text=True, check=False, timeout=600,
    )  # fmt: skip


PACKAGE = "import sensors.mine as mine, sensors as theirs\n"
NAMESPACE = (  # as a folder without __init__.py is where no Troupe is installed
    "import types\ntheirs = types.ModuleType('sensors')\ntheirs.__path__ = ['{folder}/sensors']\n"
    "sys.modules['sensors'] = theirs\n"
)


@pytest.mark.parametrize("imports", [PACKAGE, NAMESPACE])
def test_a_module_that_a_program_has_imported_is_not_taken_away(
    tmp_path: Path, imports: str
) -> None:
    (tmp_path / "sensors").mkdir()
    (tmp_path / "sensors" / "__init__.py").write_text("")
    (tmp_path / "sensors" / "mine.py").write_text("")
    done = python(
        f"import sys\nsys.path.insert(0, '')\n{imports.format(folder=tmp_path)}"
        "try:\n    import troupe\nexcept ImportError as error:\n    print(error)\n"
        "assert sys.modules['sensors'] is theirs\n"
        "assert 'sim' not in sys.modules and 'player' not in sys.modules\n",
        tmp_path,
    )
    assert done.returncode == 0, done.stderr
    assert f"sensors ({tmp_path / 'sensors'}" in done.stdout
    assert "Rename yours" in done.stdout
    assert "'-m', 'troupe', 'run'" in done.stdout
