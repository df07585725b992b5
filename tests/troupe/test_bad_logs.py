"""What is no log: every command says which file and what to do, with exit code 2."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest
from mcap.writer import CompressionType, Writer
from typer.testing import CliRunner

import troupe
from sim.log.container import LogFile
from sim.log.errors import LogError
from sim.log.recover import recover
from troupe.app import app

WORLD = {
    "size": [5, 5],
    "duration": 1,
    "models": {"m": {"body": {"shape": "circle", "radius": 0.3}}},
    "robots": [{"name": "a", "model": "m", "pose": [2, 2, 0]}],
}
COMMANDS = {
    "info": ("log", "info"),
    "export": ("log", "export", "-o", "x.csv"),
    "check": ("log", "check"),
    "recover": ("log", "recover", "-o", "x.mcap"),
    "render": ("render", "--picture", "x.svg"),
    "report": ("report", "-o", "x.html"),
    "view": ("view", "--no-open"),
}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A log with a robot whose name would colour the terminal."""
    path = tmp_path_factory.mktemp("bad") / "run.mcap"
    with troupe.Simulation(WORLD, log=path) as sim:
        sim._engine.robots[0].record.name = "\x1b[31mred"  # no world file may have it
        sim.step(3)
    return path


def ours(path: Path, about: dict[str, str], attachments: dict[str, bytes]) -> None:
    """A whole log with nothing in it."""
    file = LogFile(path, "troupe")
    file.note("troupe", about)
    for name, data in attachments.items():
        file.attach(name, "", data)
    file.finish()
    file.close()


def of_another_program(path: Path, whole: Path) -> None:
    with path.open("wb") as file:
        writer = Writer(file, compression=CompressionType.ZSTD)
        writer.start("ros2", "\x1b[31mother 1.0")
        schema = writer.register_schema("std_msgs/msg/String", "ros2msg", b"string data")
        channel = writer.register_channel("/chatter", "cdr", schema)
        writer.add_message(channel, 1, b"\0\1\0\0\1\0\0\0\0", 1)
        writer.finish()


def of_later(path: Path, whole: Path) -> None:
    ours(path, {"format": "99", "version": "\x1b[31m99.0"}, {})


def without_a_seed(path: Path, whole: Path) -> None:
    about = {"format": "1", "seed": "many"}
    ours(path, about, troupe.Log(whole)._reader.attachments())


NO_LOG = "so it is no log of a run: name a file that `troupe run --log FILE.mcap` wrote"
SAVED_NOTHING = "there is nothing in it that could be saved: run the world again"
BAD: dict[str, tuple[Callable[[Path, Path], object], str]] = {
    "missing": (lambda path, whole: None, "No such file"),
    "folder": (lambda path, whole: path.mkdir(), f"it is a folder, {NO_LOG}"),
    "pipe": (lambda path, whole: os.mkfifo(path), f"it is not a file with an end, {NO_LOG}"),
    "empty": (lambda path, whole: path.touch(), f"the file is empty, {NO_LOG}"),
    "text": (lambda path, whole: path.write_text("size: [3, 3]"), f"not an MCAP file, {NO_LOG}"),
    "begun": (lambda path, whole: path.write_bytes(whole.read_bytes()[:30]), "log recover"),
    "cut": (
        lambda path, whole: path.write_bytes(whole.read_bytes()[:-100]),
        "cut off before its end: `troupe log recover` makes a whole one",
    ),
    "foreign": (of_another_program, "not written by Troupe but by \\x1b[31mother 1.0"),
    "later": (of_later, "of a later version of Troupe"),
    "\x1b[31mred": (lambda path, whole: path.touch(), "\\x1b[31mred.mcap: the file is empty"),
}


@pytest.mark.parametrize("command", COMMANDS)
def test_what_is_no_log_is_told_with_what_to_do(
    whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    monkeypatch.chdir(tmp_path)
    for name, (make, words) in BAD.items():
        if (command, name) == ("recover", "cut"):
            continue  # that is what it is for
        path = Path(f"{name}.mcap")
        make(path, whole)
        expected = SAVED_NOTHING if (command, name) == ("recover", "begun") else words
        assert expected in refused(command, path), name
    assert not [path for path in tmp_path.iterdir() if path.name.startswith("x.")]


@pytest.mark.parametrize("command", ["check", "render", "report", "view"])
def test_a_log_whose_run_cannot_be_repeated_is_told(
    whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    monkeypatch.chdir(tmp_path)
    without_a_seed(Path("lame.mcap"), whole)
    told = refused(command, Path("lame.mcap"))
    assert "its seed cannot be read" in told or "no robot has entered" in told


def test_a_damaged_attachment_is_told_and_left_behind(whole: Path, tmp_path: Path) -> None:
    data = whole.read_bytes()
    assert data.count(b'"outcome"') == 1
    broken, saved = tmp_path / "broken.mcap", tmp_path / "saved.mcap"
    broken.write_bytes(data.replace(b'"outcome"', b'"income!"'))
    with pytest.raises(LogError, match="damaged \\(the checksum of an attachment is wrong\\)"):
        troupe.Log(broken).result  # noqa: B018 - it is read now
    assert len(troupe.Log(broken).poses) == 3
    assert recover(broken, saved).lost > len('"outcome"')
    assert troupe.Log(saved).result is None
    assert troupe.Log(saved).poses.tobytes() == troupe.Log(whole).poses.tobytes()


def test_damage_is_told_once(whole: Path, tmp_path: Path) -> None:
    data = bytearray(whole.read_bytes())
    chunk = troupe.Log(whole)._reader.entries("/troupe/state")[0][0]
    (at,) = chunk.places["offset"][:1]
    data[at] = 0  # the opcode of an index
    broken = tmp_path / "broken.mcap"
    broken.write_bytes(data)
    (topic,) = (
        name
        for name, (channel, _) in troupe.Log(whole)._reader.topics.items()
        if channel == chunk.places["channel"][0]
    )
    with pytest.raises(LogError) as told:
        list(troupe.Log(broken)._reader.messages(topic))
    assert str(told.value).count("damaged") == 1


@pytest.mark.parametrize("command", ["check", "render", "report", "view"])
def test_a_log_without_a_tick_is_told(tmp_path: Path, command: str) -> None:
    path = tmp_path / "run.mcap"
    troupe.Simulation(WORLD, log=path).close()
    assert "the run has no tick in it: there is nothing to" in refused(command, path)


def refused(command: str, path: Path) -> str:
    """What a command says of a file that it cannot take, on one line."""
    first, *rest = COMMANDS[command]
    words = [first, rest[0], str(path), *rest[1:]] if first == "log" else [first, str(path), *rest]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 2, (words, done.output)
    assert "\x1b" not in done.output
    assert len(done.stderr.splitlines()) == 1, done.stderr
    assert done.stderr.startswith(str(path).replace("\x1b", "\\x1b")), done.stderr
    return done.stderr


def test_names_of_escape_codes_print_none(
    whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for words in (
        ["render", str(whole), "--picture", "x.svg"],
        ["report", str(whole), "-o", "x.html"],
        ["log", "info", str(whole)],
    ):
        done = CliRunner().invoke(app, words)
        assert done.exit_code == 0, done.output
        assert "\x1b" not in done.output
    for made in ("x.svg", "x.html"):
        assert "\x1b" not in Path(made).read_text()
