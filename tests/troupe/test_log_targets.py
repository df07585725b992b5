"""What stands in a file is lost only to what is whole: not to a command that was refused."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

import troupe
from sim.log.container import LogFile
from troupe.app import app

WORLD = """\
size: [5, 5]
duration: 1
models: {m: {body: {shape: circle, radius: 0.3}}}
robots: [{name: a, model: m, pose: [2, 2, 0]}]
"""


@pytest.fixture
def world(tmp_path: Path) -> Path:
    path = tmp_path / "world.yaml"
    path.write_text(WORLD)
    return path


@pytest.fixture
def log(world: Path, tmp_path: Path) -> Path:
    path = tmp_path / "kept.mcap"
    troupe.run(world, log=path)
    return path


@pytest.fixture
def busy() -> Iterator[int]:
    """A port that somebody listens on."""
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        one.listen()
        yield one.getsockname()[1]


@pytest.mark.parametrize("stood", [b"a year's work", None])
def test_a_run_that_cannot_begin_leaves_its_logs_file_as_it_was(
    world: Path, tmp_path: Path, busy: int, stood: bytes | None
) -> None:
    path = tmp_path / "run.mcap"
    if stood is not None:
        path.write_bytes(stood)
    with pytest.raises(OSError, match="cannot listen"):
        troupe.run(world, log=path, listen=f"127.0.0.1:{busy}")
    with pytest.raises(OSError, match="cannot listen"):
        troupe.Simulation(world, log=path, listen=f"127.0.0.1:{busy}")
    assert (path.read_bytes() if path.exists() else None) == stood


def test_a_run_whose_page_cannot_be_shown_leaves_its_logs_file_as_it_was(
    world: Path, tmp_path: Path, busy: int
) -> None:
    path = tmp_path / "run.mcap"
    path.write_bytes(b"a year's work")
    words = ["run", str(world), "--log", str(path), "--view", "--view-port", str(busy)]
    done = CliRunner().invoke(app, [*words, "--no-open"])
    assert done.exit_code == 2, done.output
    assert path.read_bytes() == b"a year's work"


def test_a_logs_file_is_written_once_there_is_a_chunk(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    path.write_bytes(b"a year's work, much longer than the log that is to stand there" * 100)
    before = path.stat().st_size
    file = LogFile(path, "troupe")
    file.note("troupe", {"format": "1"})
    assert path.stat().st_size == before
    file.begin()
    assert path.read_bytes().startswith(b"\x89MCAP0\r\n")
    assert path.stat().st_size == file.at < before
    file.close()


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("run.mp4", ("render", "--video")),
        ("run.png", ("render", "--picture")),
        ("run.svg", ("render", "--picture")),
        ("run.html", ("report", "-o")),
        ("run.csv", ("log", "export", "-o")),
        ("run.parquet", ("log", "export", "-o")),
        ("run.mcap", ("log", "recover", "-o")),
    ],
)
def test_nothing_is_written_over_the_log_that_it_is_made_of(
    log: Path, tmp_path: Path, name: str, words: tuple[str, ...]
) -> None:
    path = log.rename(tmp_path / name)
    data = path.read_bytes()
    link = tmp_path / f"link{path.suffix}"
    link.symlink_to(path)
    for target in (path, link):
        done = CliRunner().invoke(app, [*words[:-1], str(path), words[-1], str(target)])
        assert done.exit_code == 2, done.output
        assert "name another" in done.stderr
        assert path.read_bytes() == data


@pytest.mark.parametrize(
    "words",
    [
        ("run", "WORLD", "--log", "FILE.mcap"),
        ("log", "export", "LOG", "-o", "FILE.csv"),
        ("log", "export", "LOG", "-o", "FILE.parquet"),
        ("log", "recover", "LOG", "-o", "FILE.mcap"),
        ("report", "LOG", "-o", "FILE.html"),
        ("render", "LOG", "--picture", "FILE.svg"),
    ],
)
def test_a_place_that_cannot_be_written_is_told_with_what_to_do(
    world: Path, log: Path, tmp_path: Path, words: tuple[str, ...]
) -> None:
    ending = next(word for word in words if word.startswith("FILE"))[4:]
    (tmp_path / f"folder{ending}").mkdir()
    for file, told in (
        (tmp_path / "none" / f"x{ending}", "there is no folder"),
        (tmp_path / f"folder{ending}", ""),
        (Path(f"/proc/x{ending}"), "cannot be written"),
    ):
        names = {"WORLD": str(world), "LOG": str(log), f"FILE{ending}": str(file)}
        done = CliRunner().invoke(app, [names.get(word, word) for word in words])
        assert done.exit_code == 2, done.output
        assert len(done.stderr.splitlines()) == 1, done.stderr
        assert str(file) in done.stderr
        assert told in done.stderr


@pytest.mark.parametrize("ending", [".csv", ".parquet"])
def test_a_table_takes_the_place_of_another_when_it_is_whole(
    world: Path, tmp_path: Path, ending: str
) -> None:
    path, table = tmp_path / "run.mcap", tmp_path / f"poses{ending}"
    troupe.run(world, log=path)
    data = bytearray(path.read_bytes())
    for chunk in troupe.Log(path)._reader.chunks:
        data[chunk.at + 60 : chunk.at + 70] = bytes(10)
    path.write_bytes(data)
    table.write_bytes(b"a year's work")
    done = CliRunner().invoke(app, ["log", "export", str(path), "-o", str(table)])
    assert done.exit_code == 2, done.output
    assert "damaged" in done.stderr
    assert table.read_bytes() == b"a year's work"
    assert sorted(one.name for one in tmp_path.iterdir()) == [
        table.name, "run.mcap", "world.yaml",
    ]  # fmt: skip
