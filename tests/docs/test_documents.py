"""Every command and code block in README.md and the documents about controllers works."""

from __future__ import annotations

import fcntl
import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import troupe
from sim.build import load
from tests import started
from tests.patience import PATIENCE
from tests.processes import ROOT, environment, troupe_command

PAGES = [
    "README.md",
    "docs/running.md",
    "docs/viewing.md",
    "docs/logs.md",
    "docs/controllers.md",
    "docs/python.md",
    "docs/debugging.md",
    "docs/sweeps.md",
    "docs/testing.md",
    "docs/paint.md",
    "docs/architecture.md",
    "docs/performance.md",
    "docs/examples.md",
    "docs/gallery.md",
]
PROGRAMS = os.pathsep.join([os.path.dirname(sys.executable), os.environ.get("PATH", "")])
"""Where the command `troupe` is, as in an environment that is in use."""

BLOCK = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)

STAGE = """\
size: [12, 12]
duration: 6
until: duration
models:
  rover:
    body: {shape: box, size: [1, 1]}
    sensors: [{type: laser}, {type: blobfinder}]
robots: [{name: rover, model: rover, pose: [6, 6, 0], controller: mine}]
controllers: {mine: {program: ./mine.py}}
"""


def blocks(language: str) -> list[object]:
    """The code blocks of one language, named by page and number."""
    found = []
    for page in PAGES:
        path = ROOT / page
        if not path.exists():
            continue
        same = [text for kind, text in BLOCK.findall(path.read_text()) if kind == language]
        found += [pytest.param(text, id=f"{page}-{n}") for n, text in enumerate(same)]
    return found


@pytest.mark.parametrize("text", blocks("python"))
def test_a_python_block_is_a_controller_that_works(text: str, tmp_path: Path) -> None:
    if "import troupe" in text:
        (tmp_path / "block.py").write_text(text)
        done = started.troupe(cwd=tmp_path, program=tmp_path / "block.py", PATH=PROGRAMS)
        assert done.returncode == 0, done.stderr
        assert "completed" in done.stdout
        return
    (tmp_path / "mine.py").write_text(text)
    (tmp_path / "world.yaml").write_text(STAGE)
    result = troupe.run(tmp_path / "world.yaml")
    rover = result.robot("rover")
    assert result.outcome == "completed", rover.error
    assert rover.distance > 0.5


@pytest.mark.parametrize("text", blocks("yaml"))
def test_a_yaml_block_is_a_world_that_works(text: str, tmp_path: Path) -> None:
    (tmp_path / "tour.py").write_text("from player import PlayerClient\n")
    (tmp_path / "world.yaml").write_text(text)
    assert load(tmp_path / "world.yaml").robots


@pytest.fixture
def alone() -> Iterator[None]:
    """Blocks write files of equal names here: one at a time, however many workers pytest has."""
    with (ROOT / "pyproject.toml").open() as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


@pytest.mark.parametrize("text", blocks("sh"))
@pytest.mark.usefixtures("alone")
def test_a_shell_block_works(text: str, request: pytest.FixtureRequest) -> None:
    """Those of the README as they are installed, the others in processes that are forked."""
    new = "README" in request.node.name
    before = set(ROOT.iterdir())
    for line in text.splitlines():
        words = shlex.split(line, comments=True)
        if not words:
            continue
        if words == ["scripts/test"]:
            words += ["--collect-only", "tests/docs"]  # the tests are running already
        if words[0] == "scripts/bench":
            continue  # minutes: its parts have tests of their own
        if words[0] == "troupe" and not new:
            done = started.troupe(*words[1:], cwd=ROOT, PATH=PROGRAMS)
        else:
            done = subprocess.run(
                words, cwd=ROOT, env={**os.environ, "PATH": PROGRAMS}, capture_output=True,
                text=True, check=False,
            )  # fmt: skip
        assert done.returncode == 0, f"{line}\n{done.stdout}\n{done.stderr}"
    for made in set(ROOT.iterdir()) - before:
        if made.suffix in (".mp4", ".svg"):
            assert made.stat().st_size > (10_000 if made.suffix == ".mp4" else 1_000)
        if made.suffix in (".mp4", ".svg", ".mcap", ".csv", ".html"):
            made.unlink()


def test_a_program_started_by_hand_drives_a_robot_of_a_run_that_listens(tmp_path: Path) -> None:
    text = (ROOT / "README.md").read_text()
    program = next(body for kind, body in BLOCK.findall(text) if kind == "python")
    (tmp_path / "mine.py").write_text(program)
    world = STAGE.replace("{program: ./mine.py}", "{external: true}")
    (tmp_path / "world.yaml").write_text(world)
    run = subprocess.Popen(
        troupe_command("run", str(tmp_path / "world.yaml"), "--listen", "127.0.0.1:0", "--json"),
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert run.stderr is not None
        port = next(m[1] for li in run.stderr if (m := re.search(r"127\.0\.0\.1:(\d+)", li)))
        hand = subprocess.run(
            [*troupe_command()[:1], str(tmp_path / "mine.py")],
            env=environment(PLAYER_HOST="127.0.0.1", PLAYER_PORT=port),
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
        )
        out, err = run.communicate(timeout=PATIENCE)
    finally:
        run.kill()
    assert hand.returncode == 0, hand.stderr
    assert '"outcome": "completed"' in out, err


def test_links_lead_somewhere() -> None:
    for page in PAGES:
        path = ROOT / page
        for target in re.findall(r"\]\(([^)#]+)\)", path.read_text()):
            if "://" not in target:
                assert os.path.exists(path.parent / target), f"{page}: {target}"


def test_the_page_about_results_names_every_key() -> None:
    result = troupe.run("wander", duration=0.2).as_json()
    page = (ROOT / "docs" / "running.md").read_text()
    robot = result["robots"][0]
    keys = {*result, *robot, *robot["controller"], *result["floor"], "emitted", "steps"}
    assert sorted(key for key in keys if f"`{key}`" not in page) == []
