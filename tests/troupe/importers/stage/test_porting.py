"""docs/porting.md: its files are those on disk, and its commands print what it says."""

from __future__ import annotations

import json
import os
import re
import shutil
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from player import PlayerClient
from tests.patience import PATIENCE
from tests.processes import ROOT, environment

PAGE = (ROOT / "docs" / "porting.md").read_text(encoding="utf-8")
FILES = ROOT / "docs" / "porting"
BLOCK = re.compile(r"^```([^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
BLOCKS: list[tuple[str, str]] = BLOCK.findall(PAGE)


INSIDE = "troupe run inside.yaml --json"
"""Run beside the run over TCP, with which it is compared."""


def free_ports() -> int:
    """A port that is free, and the next one too."""
    while True:
        with socket.socket() as first, socket.socket() as second:
            first.bind(("127.0.0.1", 0))
            port: int = first.getsockname()[1]
            try:
                second.bind(("127.0.0.1", port + 1))
            except OSError:
                continue
            return port


class Depot:
    """A copy of the files in a folder of its own, on ports of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.ports = {"6665": str(free_ports())}
        self.ports["6666"] = str(int(self.ports["6665"]) + 1)
        for file in FILES.iterdir():
            shutil.copy(file, folder)
        cfg = folder / "depot.cfg"
        cfg.write_text(self.moved(cfg.read_text()))
        commands = folder / "bin"
        commands.mkdir()
        for name, words in {"troupe": "-m troupe", "python": ""}.items():
            (commands / name).write_text(f'#!/bin/sh\nexec "{sys.executable}" {words} "$@"\n')
            (commands / name).chmod(0o755)
        self.environment = environment(PATH=f"{commands}:{os.environ['PATH']}")

    def moved(self, text: str) -> str:
        """The text with our ports in place of the page's."""
        for page, ours in self.ports.items():
            text = text.replace(page, ours)
        return text

    def back(self, text: str) -> str:
        """The text with the page's ports in place of ours."""
        for page, ours in self.ports.items():
            text = text.replace(ours, page)
        return text

    def start(self, command: str) -> subprocess.Popen[str]:
        return subprocess.Popen(
            [
                "sh",
                "-c",
                "exec " + self.moved(command) if "=" not in command else self.moved(command),
            ],
            cwd=self.folder,
            env=self.environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def run(self, command: str) -> str:
        """What a command prints; it must succeed."""
        process = self.start(command)
        out, err = process.communicate(timeout=PATIENCE)
        assert process.returncode == 0, f"{command}\n{out}\n{err}"
        return self.back(out)


@pytest.fixture(scope="module")
def depot(tmp_path_factory: pytest.TempPathFactory) -> Depot:
    made = Depot(tmp_path_factory.mktemp("depot"))
    made.run("troupe import depot.world depot.cfg -o depot.yaml")
    return made


def named_blocks() -> dict[str, str]:
    """Blocks of the page that show a file: the first one after its name in backticks."""
    found = {}
    for match in re.finditer(r"^`([\w.]+)`", PAGE, re.MULTILINE):
        block = BLOCK.search(PAGE, match.end())
        assert block
        found[match[1]] = block[2]
    for name in re.findall(r"`(inside\.yaml)` lays", PAGE):
        block = BLOCK.search(PAGE, PAGE.index(f"`{name}` lays"))
        assert block
        found[name] = block[2]
    return found


def test_every_file_is_shown_as_it_is() -> None:
    shown = named_blocks()
    for file in FILES.iterdir():
        assert shown[file.name] == file.read_text(), file.name


def test_the_imported_world_is_the_one_that_is_shown(depot: Depot) -> None:
    assert depot.back((depot.folder / "depot.yaml").read_text()) == named_blocks()["depot.yaml"]


def plain_commands() -> list[object]:
    """Commands that stand alone, each with the text block that may follow it."""
    found = []
    for (kind, text), (after, printed) in zip(BLOCKS, [*BLOCKS[1:], ("", "")], strict=True):
        if kind == "sh" and text.strip() != INSIDE:
            found.append(
                pytest.param(text.strip(), printed if after == "text" else None, id=text.strip())
            )
    return found


@pytest.mark.parametrize(("command", "printed"), plain_commands())
def test_every_command_works_and_prints_what_is_shown(
    depot: Depot, command: str, printed: str | None
) -> None:
    (depot.folder / "again").mkdir(exist_ok=True)
    if command.startswith("troupe import"):
        (depot.folder / "depot.yaml").unlink()
    out = depot.run(command)
    assert printed is None or out == printed


def test_every_block_is_a_command_a_file_or_what_is_printed() -> None:
    shown = set(named_blocks().values())
    for (kind, text), (before, _) in zip(BLOCKS, [("", ""), *BLOCKS[:-1]], strict=True):
        is_command = kind in ("sh", "sh server", "sh client")
        assert is_command or text in shown or (kind == "text" and before == "sh"), text[:60]


def test_the_twin_drives_over_tcp_and_inside_the_world_to_the_same_digest(depot: Depot) -> None:
    commands = {kind: [t.strip() for k, t in BLOCKS if k == kind] for kind, _ in BLOCKS}
    (server_command,) = commands["sh server"]
    server = depot.start(f"{server_command} --json")
    try:
        assert server.stderr is not None
        waiting = 0
        for line in server.stderr:
            waiting += "waiting for a Player client" in line
            if waiting == 2:
                break
        for port in depot.ports.values():  # kernels may have to be compiled first
            PlayerClient("127.0.0.1", int(port), timeout=PATIENCE, environ={}).close()
        clients = [depot.start(command) for command in commands["sh client"]]
        said = [client.communicate(timeout=PATIENCE) for client in clients]
        assert [client.returncode for client in clients] == [0, 0], said
        out, err = server.communicate(timeout=PATIENCE)
    finally:
        server.kill()
        server.wait()
    over_tcp = json.loads(out)
    assert server.returncode == 0, err
    assert [robot["controller"]["state"] for robot in over_tcp["robots"]] == [
        "finished",
        "finished",
    ]
    assert all(robot["distance"] > 5 for robot in over_tcp["robots"])
    assert all(" after 30.0 s" in text for text, _ in said)
    assert ("sh", f"{INSIDE}\n") in BLOCKS
    inside = json.loads(depot.run(INSIDE))
    assert inside["outcome"] == "completed"
    assert inside["digest"] == over_tcp["digest"]


def test_every_call_of_the_cpp_program_stands_in_the_table_of_calls() -> None:
    table = (ROOT / "docs" / "player.md").read_text(encoding="utf-8")
    variables = {"robot": "PlayerClient", "base": "Position2dProxy", "laser": "LaserProxy",
                 "camera": "BlobfinderProxy"}  # fmt: skip
    calls = re.findall(r"\b(\w+)\.(\w+)\(", (FILES / "patrol.cc").read_text())
    assert len(calls) > 8
    for variable, call in calls:
        named = f"{variables[variable]}::{call}("
        assert named in table or f"ClientProxy::{call}(" in table, named


def test_links_lead_somewhere() -> None:
    for page in ("porting.md", "player.md"):
        text = (ROOT / "docs" / page).read_text(encoding="utf-8")
        for target in re.findall(r"\]\(([^)]+)\)", text):
            path, _, anchor = target.partition("#")
            file = ROOT / "docs" / path if path else ROOT / "docs" / page
            assert file.exists(), f"{page}: {target}"
            if anchor:
                headings = re.findall(r"^#+ (.+)$", file.read_text(encoding="utf-8"), re.MULTILINE)
                assert anchor in {anchor_of(heading) for heading in headings}, f"{page}: {target}"


def anchor_of(heading: str) -> str:
    """The anchor that a heading gets on the usual hosts."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
